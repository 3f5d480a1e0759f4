/// Candidates: pairs whose swept boxes overlap. They are kept through the iterations of an interval, and
/// queried again for particles whose boxes have grown.
#pragma once

#include "contact/context.h"
#include "core/assert.h"

namespace oilskin::contact {

struct CandidatePair {
  std::uint32_t triangle = 0;
  /// Epoch of the last test that found no violation; 0 = none.
  std::uint32_t tested = 0;
  /// Distance at the end [m]; infinity where it was not computed.
  double end_distance = std::numeric_limits<double>::infinity();
};

class CandidateSet {
 public:
  /// Queries every particle: the box of x_t0 ∪ x_t1, inflated by thickness + prediction_margin(), or by the
  /// first layer of a viscous wall if that is wider.
  void collect(Context& context);

  /// Covers the present x_t1 up to a margin. A particle is queried again if its swept box, inflated by
  /// max(2 δ, `margin` × h) and by what triangles may have left their boxes in the tree, is not within the
  /// box of its last query, or if a triangle that has left its box in the tree has come to overlap that box.
  /// Returns the particles whose candidates may have changed, ascending.
  std::vector<std::uint32_t> refresh(Context& context, double margin = 0);

  /// The largest change of an end, per axis, after which refresh(…, 1) does not query again while no triangle
  /// has moved [m].
  static double prediction_margin(const Liquid& liquid);

  /// The surfaces that may have candidates of the particle, ascending.
  Span<const std::uint32_t> surfaces_near(std::uint32_t particle) const {
    const std::size_t group = particle / group_size;
    OILSKIN_ASSERT(group + 1 < near_begin_.size());
    return {near_surface_.data() + near_begin_[group], near_begin_[group + 1] - near_begin_[group]};
  }
  /// The candidates of the particle on one of surfaces_near().
  Span<CandidatePair> of(std::uint32_t surface, std::uint32_t particle) {
    OILSKIN_ASSERT(surface < surfaces_.size());
    Surface& s = surfaces_[surface];
    const std::size_t at = s.place(particle);
    OILSKIN_ASSERT(at < s.count.size() && s.begin[at] + s.count[at] <= s.pool.size());
    return {s.pool.data() + s.begin[at], s.count[at]};
  }
  Span<const CandidatePair> of(std::uint32_t surface, std::uint32_t particle) const {
    OILSKIN_ASSERT(surface < surfaces_.size());
    const Surface& s = surfaces_[surface];
    const std::size_t at = s.place(particle);
    OILSKIN_ASSERT(at < s.count.size() && s.begin[at] + s.count[at] <= s.pool.size());
    return {s.pool.data() + s.begin[at], s.count[at]};
  }
  /// The epoch in which an end of the triangle last changed, up to the last refresh(); 0 = none has.
  std::uint32_t last_move(std::uint32_t surface, std::uint32_t triangle) const {
    const std::vector<std::uint32_t>& stamp = surfaces_[surface].triangle_stamp;
    return stamp.empty() ? 0 : stamp[triangle];
  }
  std::uint64_t size() const;
  /// Minimum over particles in play and pairs that end within the thickness; infinity if there are none [m].
  double min_end_distance(const Context& context) const;

 private:
  /// Consecutive particles, which lie in a few cells. A surface far from a group has nothing to do with its
  /// particles: in a level with many bodies each is near a few groups.
  static constexpr std::size_t group_size = 32;
  static constexpr std::uint32_t none = UINT32_MAX;

  struct Surface {
    std::vector<double> reach;        // of the queries, of each liquid [m]; negative: it does not collide
    Box clear;                        // that no triangle overlaps; empty unless all groups are far
    std::vector<std::uint32_t> slot;  // per group: where it is in `box`, in groups; none = it is far;
                                      // nothing until one has come near
    std::vector<Box> clear_of_group;  // per group that is far: the same; nothing while `clear` is known
    // Per particle of groups that are near
    std::vector<Box> box;  // of the last query
    std::vector<std::uint32_t> begin, count;
    std::vector<CandidatePair> pool;
    std::size_t pool_of_all = 0;  // its size after the last query of all particles
    // Node stamps below `read_epoch` are in the stamps of triangles, those below `tree_epoch` in the tree,
    // too.
    std::vector<std::uint32_t> triangle_stamp;  // the youngest of its nodes; empty while no node has one
    std::uint32_t read_epoch = 0, tree_epoch = 0;
    double drift = 0;        // triangles lie within their boxes in the tree, inflated by this [m]
    std::vector<Box> moved;  // of triangles that have moved since the last query, in the tree
    proximity::Candidates scratch;

    /// The tree has changed, or the boxes of groups are out of date.
    void forget_clear() {
      clear = Box();
      clear_of_group.clear();
    }
    Box box_of_query(const Context& context, std::uint32_t particle) const;
    std::size_t place(std::uint32_t particle) const {
      OILSKIN_ASSERT(slot[particle / group_size] != none);
      return slot[particle / group_size] * group_size + particle % group_size;
    }
  };
  void measure_groups(const Context& context);
  template <class IsSmall, class F>
  void for_surfaces(const Workers& workers, const IsSmall& is_small, const F& f) const;
  template <class Prepare, class Query>
  void for_near_surfaces(const Context& context, const Prepare& prepare, const Query& query);
  bool find_near_groups(const Context& context, std::uint32_t surface, double reach, const Workers& workers);
  bool is_clear_of_all(const Context& context, std::uint32_t surface, double reach);
  bool read_node_stamps(const Context& context, std::uint32_t surface);
  bool follow_triangles(const Context& context, std::uint32_t surface, const Workers& workers);
  std::vector<std::uint32_t> find_stale(const Context& context, std::uint32_t surface, bool all, double reach,
                                        const Workers& workers);
  void query(const Context& context, std::uint32_t surface, const std::vector<std::uint32_t>& particles,
             const Workers& workers);
  void list_near_surfaces();

  std::vector<Surface> surfaces_;
  std::vector<Box> swept_;  // per group: of its particles in play
  Box swept_by_all_;
  std::vector<std::uint32_t> near_begin_, near_surface_;
};

}  // namespace oilskin::contact
