#include "core/sort_by_key.h"

#include <gtest/gtest.h>

#include <utility>

namespace oilskin {
namespace {

/// Of item i: one value for each of its divisors among 1 … keys − 1, so that keys have many values, few or
/// none.
template <class F>
void for_divisors(std::size_t begin, std::size_t end, std::uint32_t keys, const F& f) {
  for (std::size_t i = begin; i < end; ++i)
    for (std::uint32_t key = 1; key < keys; ++key)
      if (i % key == 0) f(key, static_cast<int>(i));
}

class SortByKey : public testing::TestWithParam<std::pair<std::size_t, std::size_t>> {};
INSTANTIATE_TEST_SUITE_P(of, SortByKey,
                         testing::Values(std::pair(0, 1), std::pair(1, 1), std::pair(5, 2),
                                         std::pair(1000, 7), std::pair(1000, 400), std::pair(4096, 128)),
                         [](const auto& test) {
                           return std::to_string(test.param.first) + "_items_by_" +
                                  std::to_string(test.param.second);
                         });

TEST_P(SortByKey, keeps_the_order_of_items_on_any_number_of_threads) {
  constexpr std::uint32_t keys = 9;
  const auto [items, smallest_chunk] = GetParam();
  for (const int threads : {1, 2, 3}) {
    KeyedLists<int> lists;
    lists.list = {3, 1};  // what was there before does not matter
    sort_by_key(
        items, smallest_chunk, keys,
        [&](std::size_t begin, std::size_t end, const auto& f) { for_divisors(begin, end, keys, f); },
        Workers(threads), lists);
    ASSERT_EQ(lists.begin.size(), keys + 1);
    EXPECT_EQ(lists.begin.back(), lists.list.size());
    EXPECT_TRUE(lists.of(0).empty());
    for (std::uint32_t key = 1; key < keys; ++key) {
      std::vector<int> expected;
      for (std::size_t i = 0; i < items; i += key) expected.push_back(static_cast<int>(i));
      const Span<const int> found = lists.of(key);
      EXPECT_EQ(std::vector<int>(found.begin(), found.end()), expected) << "key " << key;
    }
  }
}

}  // namespace
}  // namespace oilskin
