/// Parts of parallel loops.
#pragma once

#include "core/parallel.h"

namespace oilskin {

/// Items per chunk of a loop whose result does not depend on chunks: enough chunks for the threads of one
/// machine, few enough that starting them costs little beside `smallest` items.
inline std::size_t even_chunk(std::size_t items, std::size_t smallest, std::size_t most_chunks = 32) {
  return std::max(smallest, (items + most_chunks - 1) / most_chunks);
}

/// Calls f(i) for every i in [0, n), in even chunks of at least `smallest` items.
template <class F>
void for_each_evenly(const Workers& workers, std::size_t n, std::size_t smallest, const F& f) {
  workers.for_each(n, even_chunk(n, smallest), f);
}

/// For Workers::ordered_sum(): the largest of numbers that are not negative.
struct Largest {
  double value = 0;
  void operator+=(const Largest& o) { value = std::max(value, o.value); }
};

}  // namespace oilskin
