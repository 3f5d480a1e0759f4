#include "core/host_loop.h"

#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <sstream>
#include <stdexcept>

#include "core/assert.h"
#include "core/refuse.h"

namespace oilskin {

namespace {

std::atomic<JobSystem*> current_jobs{nullptr};

template <class... Parts>
std::exception_ptr fault(const Parts&... parts) {
  return std::make_exception_ptr(std::runtime_error(refuse(parts...).message));
}

/// No exception passes through the threads of the host: it is kept here.
class HostLoop {
 public:
  HostLoop(std::size_t count, void (*task)(const void*, std::size_t), const void* context)
      : count_(static_cast<int>(count)), task_(task), context_(context) {
    OILSKIN_ASSERT(count <= static_cast<std::size_t>(std::numeric_limits<int>::max()));
  }

  void run_on(JobSystem& jobs) {
    jobs.run(count_, LoopTasks(&HostLoop::run_range, this));
    if (error_) std::rethrow_exception(error_);
    if (done_ != count_)
      std::rethrow_exception(fault("JobSystem::run() did ", done_.load(), " of ", count_, " tasks"));
  }

 private:
  static void run_range(void* loop, int begin, int end) {
    auto& self = *static_cast<HostLoop*>(loop);
    if (begin < 0 || end < begin || end > self.count_) {
      self.keep(-1, fault("JobSystem::run() asked for the tasks ", begin, " to ", end, " (excluded) of ",
                          self.count_));
      return;
    }
    for (int i = begin; i < end; ++i) self.run_task(i);
    self.done_ += end - begin;
  }

  void run_task(int i) {
    try {
      task_(context_, static_cast<std::size_t>(i));
    } catch (...) {
      keep(i, std::current_exception());
    }
  }

  void keep(int i, std::exception_ptr error) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (error_ && failed_ <= i) return;
    error_ = std::move(error);
    failed_ = i;
  }

  int count_;
  void (*task_)(const void*, std::size_t);
  const void* context_;
  std::atomic<int> done_{0};
  std::mutex mutex_;
  int failed_ = 0;  // the task of error_
  std::exception_ptr error_;
};

}  // namespace

void run_on_host(JobSystem& jobs, std::size_t count, void (*task)(const void*, std::size_t),
                 const void* context) {
  HostLoop(count, task, context).run_on(jobs);
}

Status set_job_system(JobSystem* jobs) {
  if (jobs != nullptr && jobs->threads() < 1) return refuse_value("threads()", jobs->threads(), "≥ 1");
  current_jobs = jobs;
  return {};
}

JobSystem* job_system() {
  return current_jobs;
}

}  // namespace oilskin
