/// Pairs whose swept boxes meet, kept through the rounds of an interval and collected anew where boxes grew.
#pragma once

#include "contact/context.h"
#include "core/assert.h"

namespace oilskin::contact {

struct CandidatePair {
  std::uint32_t triangle = 0;
  std::uint32_t tested = 0;  ///< epoch of the last test that found it good; 0 = never, or bad
  double end_distance = std::numeric_limits<double>::infinity();  ///< where it was computed
};

class CandidateSet {
 public:
  /// Queries every particle: box of x_t0 ∪ x_t1 inflated by thickness + slack, or by the first layer of a
  /// viscous wall.
  void collect(Context& context);

  /// Makes the set cover the present x_t1 up to a margin: particles whose swept box, inflated by max(2 δ,
  /// `margin` × h), left the box that they were queried with are queried again; all are where nodes of the
  /// surface moved since its tree was fitted. Returns those that were, ascending.
  std::vector<std::uint32_t> refresh(Context& context, double margin = 0);

  /// How far an end may wander from the prediction, per axis, before refresh(…, 1) queries again [m].
  static double prediction_margin(const ParticleMotion& particles);

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
  /// Over live particles and pairs that end within the thickness; infinity where there are none.
  double min_end_distance(const Context& context) const;

 private:
  struct Surface {
    std::vector<Box> box;  // that the particle was queried with
    std::vector<std::uint32_t> begin, count;
    std::vector<CandidatePair> pool;
    std::uint32_t tree_epoch = 0;
    proximity::Candidates scratch;
  };
  void query(Context& context, std::uint32_t surface, const std::vector<std::uint32_t>& particles);

  std::vector<Surface> surfaces_;
  std::vector<Box> boxes_;
};

}  // namespace oilskin::contact
