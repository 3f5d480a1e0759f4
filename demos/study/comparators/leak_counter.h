/// Counts particles that pass through surfaces, from outside: the same for every method, and with none of the
/// code by which any of them prevents it.
#pragma once

#include <map>

#include "oilskin/trace.h"
#include "study/comparators/box_tree.h"

namespace oilskin::study {

/// A particle passes through a triangle at the time t, 0 … 1, of an interval in which both move straight.
struct Passage {
  std::size_t particle = 0;  ///< index into Interval::id
  std::size_t surface = 0;   ///< index into Interval::surfaces
  double t = 0;
  int direction = 0;  ///< +1 towards the front, −1 towards the back
};

/// The passages of one interval, by particle and time. A passage through an edge or a vertex that triangles
/// share counts once. Motions within the plane of a triangle are no passage.
std::vector<Passage> count_leaks(const Interval& interval);

/// What a run has leaked.
struct LeakCount {
  std::uint64_t passages = 0;   ///< all of them
  std::uint64_t particles = 0;  ///< that passed at least once
  std::uint64_t beyond = 0;     ///< of these: which have not come back the way they went
};

/// Watches a run.
class LeakCounter : public IntervalObserver {
 public:
  void on_interval(const Interval& interval) override;
  LeakCount count() const;

 private:
  std::uint64_t passages_ = 0;
  std::map<std::pair<std::uint64_t, std::uint64_t>, int> net_;  // of (particle, surface): Σ direction
};

}  // namespace oilskin::study
