// The loops of the library on a task scheduler of Bullet.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "game.h"
#include "oilskin/bullet_jobs.h"
#include "support/mock_jobs.h"

namespace oilskin::bullet::test {
namespace {

using oilskin::test::JobsInUse;

/// A scheduler of the user's. It respects the grain size, and its threads take the last range first.
class Scheduler : public btITaskScheduler {
 public:
  explicit Scheduler(int threads) : btITaskScheduler("test"), m_threads(threads) {}
  int getMaxNumThreads() const override { return 64; }
  int getNumThreads() const override { return m_threads; }
  void setNumThreads(int threads) override { m_threads = threads; }
  void parallelFor(int begin, int end, int grain, const btIParallelForBody& body) override {
    ++loops;
    std::atomic<int> left{(end - begin + grain - 1) / grain};
    std::vector<std::thread> crew;
    for (int t = 0; t < m_threads; ++t)
      crew.emplace_back([&] {
        for (int i; (i = --left) >= 0;)
          body.forLoop(begin + i * grain, std::min(end, begin + (i + 1) * grain));
      });
    for (std::thread& t : crew) t.join();
  }
  btScalar parallelSum(int begin, int end, int, const btIParallelSumBody& body) override {
    return body.sumLoop(begin, end);
  }

  int loops = 0;

 private:
  int m_threads;
};

/// Water on a cloth.
std::uint64_t hash_of_run(int threads) {
  FluidSettings fluid = coarse_fluid(PressureSolver::dfsph);
  fluid.spacing = 0.01;
  Game game(threads, fluid);
  EXPECT_TRUE(game.solver.addCloth(game.bullet.patch(12, 0.4, 0, 15), bt(0.002)).ok());
  EXPECT_TRUE(game.pour(0.01).ok());
  game.run(20);
  EXPECT_GT(game.water.getNumParticles(), 1500);
  return game.water.getWorld().state_hash();
}

TEST(BulletJobs, a_scheduler_of_any_number_of_threads_gives_the_same_bits) {
  const std::uint64_t serial = hash_of_run(1);
  for (int threads : {2, 5}) {
    Scheduler scheduler(threads);
    btFluidJobSystem jobs(&scheduler);
    const JobsInUse use(jobs);
    ASSERT_TRUE(use.accepted);
    EXPECT_EQ(jobs.threads(), threads);
    EXPECT_EQ(hash_of_run(0), serial);
    EXPECT_GT(scheduler.loops, 200);
  }
}

TEST(BulletJobs, the_sequential_scheduler_runs_loops_on_the_callers_thread) {
  btFluidJobSystem jobs(btGetSequentialTaskScheduler());
  const JobsInUse use(jobs);
  EXPECT_EQ(jobs.threads(), 1);
  EXPECT_EQ(hash_of_run(0), hash_of_run(1));
}

TEST(BulletJobs, without_a_scheduler_bullets_present_one_is_asked_at_each_loop) {
  btITaskScheduler* const before = btGetTaskScheduler();
  btFluidJobSystem jobs;
  EXPECT_GE(jobs.threads(), 1);
  Scheduler scheduler(3);
  btSetTaskScheduler(&scheduler);
  if (btGetTaskScheduler() == &scheduler) {  // not in a Bullet without BT_THREADSAFE
    EXPECT_EQ(jobs.threads(), 3);
    const JobsInUse use(jobs);
    hash_of_run(0);
    EXPECT_GT(scheduler.loops, 200);
  } else {
    int done = 0;
    jobs.run(7,
             LoopTasks([](void* sum, int begin, int end) { *static_cast<int*>(sum) += end - begin; }, &done));
    EXPECT_EQ(done, 7);
  }
  if (before != nullptr) btSetTaskScheduler(before);
}

}  // namespace
}  // namespace oilskin::bullet::test
