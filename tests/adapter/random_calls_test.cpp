// Games of random calls: nothing crosses, all numbers are finite, momentum is accounted for, and the end does
// not depend on the number of threads. OILSKIN_RANDOM_GAMES sets their number.
#include <gtest/gtest.h>

#include <cstdlib>

#include "random_game.h"
#include "support/record.h"

namespace oilskin::bullet {
namespace {

using test::RandomGame;

void add(RandomGame::Seen& sum, const RandomGame::Seen& seen) {
  sum.accepted += seen.accepted, sum.refused += seen.refused, sum.heard += seen.heard;
  sum.steps += seen.steps, sum.steps_of_several += seen.steps_of_several,
      sum.particle_steps += seen.particle_steps;
}

TEST(RandomCalls, nothing_crosses_and_threads_do_not_matter) {
  const char* asked = std::getenv("OILSKIN_RANDOM_GAMES");
  const int games = asked ? std::atoi(asked) : 12, steps = asked ? 200 : 60;
  RandomGame::Seen sum;
  for (int number = 1; number <= games; ++number) {
    std::uint64_t hash[2];
    for (int threads : {1, 2}) {
      RandomGame game(static_cast<std::uint64_t>(number), threads);
      game.play(steps);
      const RandomGame::Seen& seen = game.seen();
      EXPECT_EQ(seen.crossings, 0u) << "game " << number;
      EXPECT_TRUE(seen.is_finite) << "game " << number;
      EXPECT_EQ(seen.steps_without_residual, seen.steps) << "game " << number;
      hash[threads - 1] = game.state_hash();
      if (threads == 1) add(sum, seen);
    }
    EXPECT_EQ(hash[0], hash[1]) << "game " << number;
  }
  oilskin::test::record("calls accepted", static_cast<double>(sum.accepted));
  oilskin::test::record("calls refused", static_cast<double>(sum.refused));
  oilskin::test::record("steps of several fluids", static_cast<double>(sum.steps_of_several));
  // The games do what they are for.
  const auto count = static_cast<std::uint64_t>(games);
  EXPECT_GT(sum.accepted, 30 * count);
  EXPECT_GT(sum.refused, 5 * count);
  EXPECT_GT(sum.heard, 10 * count);
  EXPECT_GT(sum.particle_steps, 1000 * count);
  EXPECT_GT(sum.steps_of_several, count);
}

}  // namespace
}  // namespace oilskin::bullet
