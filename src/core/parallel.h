/// Parallel loops whose results do not depend on the number of threads: the caller fixes the size of chunks,
/// one thread computes a chunk, and results of chunks are combined in their order. Wraps oneTBB and
/// the job system of a host.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "core/assert.h"

namespace oilskin {

class Workers {
 public:
  /// 0 = one per hardware thread. Other than 1: on the job system of the host, if there is one.
  explicit Workers(int threads = 0);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int threads() const;

  /// Calls f(begin, end, chunk) for every chunk of [0, n), concurrently and in any order.
  template <class F>
  void for_chunks(std::size_t n, std::size_t chunk_size, const F& f) const {
    OILSKIN_ASSERT(chunk_size > 0);
    if (n == 0) return;
    const std::size_t chunks = (n + chunk_size - 1) / chunk_size;
    auto run = [&](std::size_t c) { f(c * chunk_size, std::min(n, (c + 1) * chunk_size), c); };
    if (chunks == 1) {
      run(0);
      return;
    }
    run_tasks(
        chunks, [](const void* context, std::size_t c) { (*static_cast<const decltype(run)*>(context))(c); },
        &run);
  }

  /// Calls f(i) for every i in [0, n).
  template <class F>
  void for_each(std::size_t n, std::size_t chunk_size, const F& f) const {
    for_chunks(n, chunk_size, [&](std::size_t begin, std::size_t end, std::size_t) {
      for (std::size_t i = begin; i < end; ++i) f(i);
    });
  }

  /// Σ f(begin, end) over chunks, added in the order of chunks. T needs +=.
  template <class T, class F>
  T ordered_sum(std::size_t n, std::size_t chunk_size, T zero, const F& f) const {
    OILSKIN_ASSERT(chunk_size > 0);
    std::vector<T> partial((n + chunk_size - 1) / chunk_size, zero);
    for_chunks(n, chunk_size,
               [&](std::size_t begin, std::size_t end, std::size_t c) { partial[c] = f(begin, end); });
    T sum = zero;
    for (const T& p : partial) sum += p;
    return sum;
  }

 private:
  void run_tasks(std::size_t chunks, void (*task)(const void*, std::size_t), const void* context) const;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oilskin
