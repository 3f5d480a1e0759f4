// Loops on the threads of a host: each task once, whatever the order; mistakes of the host in words.
#include <gtest/gtest.h>

#include <stdexcept>

#include "core/parallel.h"
#include "support/mock_jobs.h"

namespace oilskin {
namespace {

using test::JobsInUse;
using test::MockJobs;

/// What a loop of seven tasks throws, as text; empty = nothing.
std::string thrown_by_loop(const MockJobs::How& how, const std::vector<int>& failing = {}) {
  MockJobs jobs(how);
  const JobsInUse use(jobs);
  const Workers workers(0);
  try {
    workers.for_chunks(70, 10, [&](std::size_t, std::size_t, std::size_t c) {
      for (int f : failing)
        if (c == static_cast<std::size_t>(f)) throw std::out_of_range("task " + std::to_string(c));
    });
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

TEST(HostLoop, every_task_is_done_once_in_any_order) {
  for (const auto& how : {test::in_reverse(), test::shuffled(), test::on_threads(3), test::in_halves()}) {
    MockJobs jobs(how);
    const JobsInUse use(jobs);
    const Workers workers(0);
    EXPECT_EQ(workers.threads(), 4);
    std::vector<int> hits(1003);
    workers.for_each(hits.size(), 10, [&](std::size_t i) { ++hits[i]; });
    for (int h : hits) EXPECT_EQ(h, 1);
    EXPECT_EQ(jobs.loops, 1);
    workers.for_each(5, 10, [&](std::size_t i) { ++hits[i]; });
    EXPECT_EQ(jobs.loops, 1) << "one task is no loop";
  }
}

TEST(HostLoop, sums_have_the_same_bits) {
  const auto sum = [](const Workers& workers) {
    return workers.ordered_sum(100003, 100, 0.0, [](std::size_t begin, std::size_t end) {
      double s = 0;
      for (std::size_t i = begin; i < end; ++i) s += 1. / (1 + static_cast<double>(i));
      return s;
    });
  };
  const double serial = sum(Workers(1));
  for (const auto& how : {test::in_reverse(), test::shuffled(), test::on_threads(3), test::in_halves()}) {
    MockJobs jobs(how);
    const JobsInUse use(jobs);
    EXPECT_EQ(sum(Workers(0)), serial);
  }
}

TEST(HostLoop, one_thread_is_the_callers) {
  MockJobs jobs(test::in_reverse());
  MockJobs alone(test::in_reverse(), 1);
  std::vector<std::size_t> order;
  const auto run = [&](const Workers& workers) {
    workers.for_chunks(4, 1, [&](std::size_t, std::size_t, std::size_t c) { order.push_back(c); });
  };
  {
    const JobsInUse use(jobs);
    run(Workers(1));
  }
  {
    const JobsInUse use(alone);
    run(Workers(0));
  }
  EXPECT_EQ(order, (std::vector<std::size_t>{0, 1, 2, 3, 0, 1, 2, 3}));
  EXPECT_EQ(jobs.loops + alone.loops, 0);
}

TEST(HostLoop, what_the_first_failing_task_throws_is_thrown_when_all_are_done) {
  for (const auto& how : {test::in_reverse(), test::shuffled(), test::on_threads(3), test::in_halves()})
    EXPECT_EQ(thrown_by_loop(how, {5, 2, 6}), "task 2");
}

TEST(HostLoop, mistakes_of_the_host_are_named) {
  EXPECT_EQ(thrown_by_loop([](int, const LoopTasks&) {}), "JobSystem::run() did 0 of 7 tasks");
  EXPECT_EQ(thrown_by_loop([](int count, const LoopTasks& tasks) { tasks(1, count); }),
            "JobSystem::run() did 6 of 7 tasks");
  EXPECT_EQ(thrown_by_loop([](int count, const LoopTasks& tasks) {
              tasks(0, count);
              tasks(3, 4);
            }),
            "JobSystem::run() did 8 of 7 tasks");
  for (const auto& [begin, end] : {std::pair(-1, 3), std::pair(3, 2), std::pair(0, 8)})
    EXPECT_EQ(thrown_by_loop([b = begin, e = end](int, const LoopTasks& tasks) { tasks(b, e); }),
              "JobSystem::run() asked for the tasks " + std::to_string(begin) + " to " + std::to_string(end) +
                  " (excluded) of 7");
  EXPECT_EQ(thrown_by_loop([](int, const LoopTasks&) { throw std::runtime_error("no threads"); }),
            "no threads");
}

TEST(JobSystem, of_no_thread_is_refused_and_null_is_the_librarys_own) {
  MockJobs jobs(test::in_reverse()), none(test::in_reverse(), 0), negative(test::in_reverse(), -3);
  ASSERT_TRUE(set_job_system(&jobs).ok());
  EXPECT_EQ(set_job_system(&none).message, "threads() is 0; it must be ≥ 1");
  EXPECT_EQ(set_job_system(&negative).message, "threads() is -3; it must be ≥ 1");
  EXPECT_EQ(job_system(), &jobs);
  const Workers before(0);
  ASSERT_TRUE(set_job_system(nullptr).ok());
  EXPECT_EQ(job_system(), nullptr);
  Workers(0).for_each(100, 10, [](std::size_t) {});
  EXPECT_EQ(jobs.loops, 0);
  before.for_each(100, 10, [](std::size_t) {});
  EXPECT_EQ(jobs.loops, 1) << "those that were made before keep theirs";
}

}  // namespace
}  // namespace oilskin
