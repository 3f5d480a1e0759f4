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
  /// max(2 δ, `margin` × h), is not within the box of its last query; all are if nodes of the surface moved
  /// since its tree was fitted. Returns the particles that were queried, ascending.
  std::vector<std::uint32_t> refresh(Context& context, double margin = 0);

  /// The largest change of an end, per axis, after which refresh(…, 1) does not query again [m].
  static double prediction_margin(const Liquid& liquid);

  Span<CandidatePair> of(std::uint32_t surface, std::uint32_t particle) {
    OILSKIN_ASSERT(surface < surfaces_.size());
    Surface& s = surfaces_[surface];
    OILSKIN_ASSERT(particle < s.count.size() && s.begin[particle] + s.count[particle] <= s.pool.size());
    return {s.pool.data() + s.begin[particle], s.count[particle]};
  }
  Span<const CandidatePair> of(std::uint32_t surface, std::uint32_t particle) const {
    OILSKIN_ASSERT(surface < surfaces_.size());
    const Surface& s = surfaces_[surface];
    OILSKIN_ASSERT(particle < s.count.size());
    return {s.pool.data() + s.begin[particle], s.count[particle]};
  }
  std::uint64_t size() const;
  /// Minimum over particles in play and pairs that end within the thickness; infinity if there are none [m].
  double min_end_distance(const Context& context) const;

 private:
  struct Surface {
    std::vector<Box> box;  // of each particle's last query
    std::vector<std::uint32_t> begin, count;
    std::vector<CandidatePair> pool;
    std::uint32_t tree_epoch = 0;
    proximity::Candidates scratch;
  };
  static std::vector<std::uint32_t> find_stale(const Context& context, Surface& set, bool all, double reach);
  void query(Context& context, std::uint32_t surface, const std::vector<std::uint32_t>& particles);

  std::vector<Surface> surfaces_;
  std::vector<Box> boxes_;
};

}  // namespace oilskin::contact
