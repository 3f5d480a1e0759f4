/// A stable counting sort on several threads.
#pragma once

#include <vector>

#include "core/chunks.h"
#include "oilskin/types.h"

namespace oilskin {

/// Lists of values by key, one after the other.
template <class T>
struct KeyedLists {
  std::vector<std::uint32_t> begin;  ///< keys + 1
  std::vector<T> list;

  Span<const T> of(std::size_t key) const { return {list.data() + begin[key], begin[key + 1] - begin[key]}; }
};

/// Sorts the values of [0, items) into lists of their keys, which are below `keys`. In a list values have the
/// order of their items. for_values(begin, end, f) calls f(key, value) for all values of these items, the
/// same ones each time: it is called twice, by several threads, for at least smallest_chunk items at once.
template <class T, class ForValues>
void sort_by_key(std::size_t items, std::size_t smallest_chunk, std::size_t keys, const ForValues& for_values,
                 const Workers& workers, KeyedLists<T>& lists) {
  // Each chunk counts its values of each key: more chunks would count more than they sort.
  constexpr std::size_t most_chunks = 8;
  const std::size_t chunk = even_chunk(items, smallest_chunk, most_chunks);
  const std::size_t chunks = (items + chunk - 1) / chunk;
  std::vector<std::vector<std::uint32_t>> place(chunks);
  workers.for_chunks(items, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    place[c].assign(keys, 0);
    for_values(begin, end, [&](std::uint32_t key, const T&) { ++place[c][key]; });
  });
  lists.begin.resize(keys + 1);
  std::uint32_t next = 0;
  for (std::size_t key = 0; key < keys; ++key) {
    lists.begin[key] = next;
    for (std::vector<std::uint32_t>& of_chunk : place) {
      const std::uint32_t count = of_chunk[key];
      of_chunk[key] = next;
      next += count;
    }
  }
  lists.begin[keys] = next;
  lists.list.resize(next);
  workers.for_chunks(items, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    for_values(begin, end, [&](std::uint32_t key, const T& value) { lists.list[place[c][key]++] = value; });
  });
}

}  // namespace oilskin
