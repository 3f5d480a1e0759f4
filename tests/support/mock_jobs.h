/// Job systems of hosts, well-behaved and not.
#pragma once

#include <atomic>
#include <functional>
#include <random>
#include <thread>
#include <vector>

#include "oilskin/job_system.h"

namespace oilskin::test {

/// Counts its loops; `how` says how it runs one.
class MockJobs : public JobSystem {
 public:
  using How = std::function<void(int count, const LoopTasks& tasks)>;
  explicit MockJobs(How how, int threads = 4) : how_(std::move(how)), threads_(threads) {}

  int threads() const override { return threads_; }
  void run(int count, const LoopTasks& tasks) override {
    ++loops;
    if (++running > most_at_once) most_at_once = running.load();
    how_(count, tasks);
    --running;
  }

  std::atomic<int> loops{0}, most_at_once{0};

 private:
  How how_;
  int threads_;
  std::atomic<int> running{0};
};

inline MockJobs::How in_reverse() {
  return [](int count, const LoopTasks& tasks) {
    for (int i = count; i-- > 0;) tasks(i, i + 1);
  };
}

inline MockJobs::How shuffled() {
  return [random = std::mt19937()](int count, const LoopTasks& tasks) mutable {
    std::vector<int> order;
    for (int i = 0; i < count; ++i) order.insert(order.begin() + random() % static_cast<unsigned>(i + 1), i);
    for (int i : order) tasks(i, i + 1);
  };
}

/// Threads that take one task after the other; the caller's is not among them.
inline MockJobs::How on_threads(int threads) {
  return [threads](int count, const LoopTasks& tasks) {
    std::atomic<int> next{0};
    std::vector<std::thread> crew;
    for (int t = 0; t < threads; ++t)
      crew.emplace_back([&] {
        for (int i; (i = next++) < count;) tasks(i, i + 1);
      });
    for (std::thread& t : crew) t.join();
  };
}

/// In two ranges, the later one first, and an empty one.
inline MockJobs::How in_halves() {
  return [](int count, const LoopTasks& tasks) {
    tasks(count / 2, count);
    tasks(count, count);
    tasks(0, count / 2);
  };
}

/// Sets the job system while it lives.
class JobsInUse {
 public:
  explicit JobsInUse(JobSystem& jobs) : accepted(set_job_system(&jobs).ok()) {}
  ~JobsInUse() { static_cast<void>(set_job_system(nullptr)); }
  JobsInUse(const JobsInUse&) = delete;
  JobsInUse& operator=(const JobsInUse&) = delete;
  const bool accepted;
};

}  // namespace oilskin::test
