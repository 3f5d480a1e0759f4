// Union–find: sets and representatives, for any order of unions.
#include "core/disjoint_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "support/random.h"

namespace oilskin {
namespace {

TEST(DisjointSets, the_smallest_member_represents_its_set_for_any_order_of_unions) {
  constexpr std::uint32_t n = 40;
  test::Random random(5);
  for (int round = 0; round < 50; ++round) {
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (int k = 0; k < 25; ++k) edges.push_back({random.below(n), random.below(n)});
    // Reference: the smallest reachable number, by relaxation.
    std::vector<std::uint32_t> smallest(n);
    for (std::uint32_t i = 0; i < n; ++i) smallest[i] = i;
    for (std::uint32_t pass = 0; pass < n; ++pass)
      for (const auto& e : edges) smallest[e[0]] = smallest[e[1]] = std::min(smallest[e[0]], smallest[e[1]]);
    for (int order = 0; order < 3; ++order) {
      DisjointSets sets(n);
      for (const auto& e : edges) {
        const std::uint32_t root = sets.unite(e[order % 2], e[1 - order % 2]);
        EXPECT_EQ(root, sets.find(e[0]));
        EXPECT_EQ(root, sets.find(e[1]));
      }
      for (std::uint32_t i = 0; i < n; ++i) EXPECT_EQ(sets.find(i), smallest[i]);
      std::reverse(edges.begin(), edges.end());
    }
  }
}

}  // namespace
}  // namespace oilskin
