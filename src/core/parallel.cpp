#include "core/parallel.h"

#include <thread>

#if OILSKIN_TBB
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

namespace oilskin {

struct Workers::Impl {
  int threads = 1;
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
          threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency())))) {}
Workers::~Workers() = default;

int Workers::threads() const {
  return impl_->threads;
}

void Workers::run_tasks(std::size_t chunks, void (*task)(const void*, std::size_t),
                        const void* context) const {
#if OILSKIN_TBB
  if (impl_->threads > 1) {
    impl_->arena.execute([&] {
      tbb::parallel_for(
          std::size_t{0}, chunks, [&](std::size_t c) { task(context, c); }, tbb::simple_partitioner{});
    });
    return;
  }
#endif
  for (std::size_t c = 0; c < chunks; ++c) task(context, c);
}

}  // namespace oilskin
