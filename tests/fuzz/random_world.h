/// A world drawn from a seed: settings, surfaces, emitters, and what happens on the way. After every step it
/// is judged by the outside auditor and by its own ledgers.
#pragma once

#include <string>
#include <vector>

#include "oilskin/types.h"

namespace oilskin::test {

struct WorldVerdict {
  std::string what;                   ///< the seed and what was drawn, in one line
  std::vector<std::string> faults;    ///< empty: everything held
  std::vector<std::uint64_t> hashes;  ///< of the state after each step
  bool promised = true;               ///< contact's promise covers the run

  // What the run had in it, over all steps
  std::uint64_t steps = 0, particles = 0, pairs = 0, impacts = 0, zone_steps = 0, max_zone_rounds = 0;
  std::uint64_t stalled = 0, carried_along = 0, removed = 0, allowed = 0, relocated = 0, removed_invalid = 0,
                blocked = 0, drained = 0, aged = 0;
  std::uint64_t forced = 0;        ///< steps in which force fields gave momentum
  std::uint64_t false_alarms = 0;  ///< steps in which verify found more than were allowed to pass
  std::uint64_t not_judged = 0;    ///< steps whose momentum residual may be rounding of removed particles
  double worst_momentum = 0;       ///< residual over Σ|p|, where it is judged
};

/// `large` worlds have more particles than one task of a parallel loop takes.
WorldVerdict run_random_world(std::uint64_t seed, bool large, int threads);

}  // namespace oilskin::test
