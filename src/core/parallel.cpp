#include "core/parallel.h"

#include <thread>

#include "core/host_loop.h"

#if OILSKIN_TBB
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif
#if OILSKIN_TSAN
#include <sanitizer/tsan_interface.h>
#endif

namespace oilskin {

namespace {

/// Reports the synchronisation of oneTBB to ThreadSanitizer, which cannot see it because the library is
/// compiled without instrumentation: chunks start after the fork and end before the join. Nothing is reported
/// between chunks, so races between them are found. This file is compiled without instrumentation
/// (CMakeLists.txt); otherwise ThreadSanitizer would watch the templates of oneTBB.
class ForkJoin {
 public:
#if OILSKIN_TSAN
  void fork() {
    __tsan_release(&fork_);
  }
  void begin() {
    __tsan_acquire(&fork_);
  }
  void end() {
    __tsan_release(&join_);
  }
  void join() {
    __tsan_acquire(&join_);
  }

 private:
  char fork_ = 0, join_ = 0;
#else
  void fork() {}
  void begin() {}
  void end() {}
  void join() {}
#endif
};

}  // namespace

struct Workers::Impl {
  int threads = 1;
  JobSystem* jobs = nullptr;  // null = oneTBB
#if OILSKIN_TBB
  mutable tbb::task_arena arena;
  // More slots than the machine has threads would only make oneTBB print a warning.
  explicit Impl(int n) : threads(n), arena(std::min(n, tbb::this_task_arena::max_concurrency())) {}
#else
  explicit Impl(int) {}
#endif
};

Workers::Workers(int threads)
    : impl_(std::make_unique<Impl>(
          threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency())))) {
  if (threads != 1) impl_->jobs = job_system();
}
Workers::~Workers() = default;

int Workers::threads() const {
  return impl_->jobs ? impl_->jobs->threads() : impl_->threads;
}

void Workers::run_tasks(std::size_t chunks, void (*task)(const void*, std::size_t),
                        const void* context) const {
  if (impl_->jobs != nullptr && impl_->jobs->threads() > 1)
    return run_on_host(*impl_->jobs, chunks, task, context);
#if OILSKIN_TBB
  if (impl_->jobs == nullptr && impl_->threads > 1) {
    ForkJoin order;
    order.fork();
    impl_->arena.execute([&] {
      tbb::parallel_for(
          std::size_t{0}, chunks,
          [&](std::size_t c) {
            order.begin();
            task(context, c);
            order.end();
          },
          tbb::simple_partitioner{});
    });
    order.join();
    return;
  }
#endif
  for (std::size_t c = 0; c < chunks; ++c) task(context, c);
}

}  // namespace oilskin
