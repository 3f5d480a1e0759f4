// Worlds drawn at random from fixed seeds. Whatever they do: every number stays finite, nobody crosses, mass
// and momentum are accounted for, the work of a step is bounded, and threads do not matter. A world that
// fails prints its seed; OILSKIN_WORLDS_FIRST=<seed> OILSKIN_WORLDS_COUNT=1 runs it again.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "core/assert.h"
#include "fuzz/random_world.h"
#include "support/record.h"

namespace oilskin::test {
namespace {

/// Every so many worlds one is large, and run with one and with two threads.
constexpr std::uint64_t large_every = 10;

std::uint64_t from_environment(const char* name, std::uint64_t value) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : value;
}

std::uint64_t current_seed = 0;

[[noreturn]] void name_the_world(const char* expression, const char* file, int line) {
  std::cerr << "seed " << current_seed << ": assertion failed: " << expression << " (" << file << ":" << line
            << ")\n";
  std::abort();
}

TEST(RandomWorlds, keep_every_invariant) {
  set_assert_handler(name_the_world);
  const std::uint64_t first = from_environment("OILSKIN_WORLDS_FIRST", 1);
  const std::uint64_t count = from_environment("OILSKIN_WORLDS_COUNT", 600);
  WorldVerdict sum;
  std::uint64_t promised = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const bool large = seed % large_every == 0;
    current_seed = seed;
    const WorldVerdict v = run_random_world(seed, large, 1);
    for (const std::string& fault : v.faults) ADD_FAILURE() << v.what << "\n  " << fault;
    if (large) {
      EXPECT_EQ(run_random_world(seed, large, 2).hashes, v.hashes) << v.what;
    }
    promised += v.promised;
    sum.steps += v.steps;
    sum.particles += v.particles;
    sum.pairs += v.pairs;
    sum.impacts += v.impacts;
    sum.zone_steps += v.zone_steps;
    sum.max_zone_rounds = std::max(sum.max_zone_rounds, v.max_zone_rounds);
    sum.stalled += v.stalled;
    sum.carried_along += v.carried_along;
    sum.removed += v.removed;
    sum.allowed += v.allowed;
    sum.relocated += v.relocated;
    sum.removed_invalid += v.removed_invalid;
    sum.blocked += v.blocked;
    sum.drained += v.drained;
    sum.aged += v.aged;
    sum.forced += v.forced;
    sum.false_alarms += v.false_alarms;
    sum.not_judged += v.not_judged;
    sum.worst_momentum = std::max(sum.worst_momentum, v.worst_momentum);
  }
  record("worlds with the promise", promised);
  record("steps", sum.steps);
  record("particles a step", sum.particles / std::max<std::uint64_t>(sum.steps, 1));
  record("pairs audited", sum.pairs);
  record("impacts", sum.impacts);
  record("steps with zones", sum.zone_steps);
  record("most zone rounds", sum.max_zone_rounds);
  record("stalled", sum.stalled);
  record("carried along", sum.carried_along);
  record("removed", sum.removed);
  record("allowed", sum.allowed);
  record("relocated", sum.relocated);
  record("removed as invalid", sum.removed_invalid);
  record("blocked", sum.blocked);
  record("ended in sinks", sum.drained);
  record("ended by age", sum.aged);
  record("steps with force fields", sum.forced);
  record("false alarms of verify", sum.false_alarms);
  record("worst momentum residual", sum.worst_momentum);
  record("steps not judged", sum.not_judged);
  EXPECT_LE(sum.false_alarms, 1 + count / 1000) << "verify errs on the safe side, but hardly ever";
  EXPECT_LE(sum.not_judged, 1 + count / 10000);
  if (count < 500) return;
  EXPECT_GT(sum.impacts, 0u);
  EXPECT_GT(sum.zone_steps, 0u);
  EXPECT_GT(sum.stalled, 0u);
  EXPECT_GT(sum.carried_along, 0u);
  EXPECT_GT(sum.removed, 0u);
  EXPECT_GT(sum.allowed, 0u);
  EXPECT_GT(sum.relocated, 0u);
  EXPECT_GT(sum.removed_invalid, 0u);
  EXPECT_GT(sum.blocked, 0u);
  EXPECT_GT(sum.drained, 0u);
  EXPECT_GT(sum.aged, 0u);
  EXPECT_GT(sum.forced, 0u);
}

}  // namespace
}  // namespace oilskin::test
