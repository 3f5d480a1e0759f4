/// MeshTopology against definitions written out as loops over all pairs of triangles.
#include "core/mesh_topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support/random.h"

namespace oilskin {
namespace {

using Triangles = std::vector<Triangle>;

std::multiset<std::uint32_t> nodes_of(const Triangle& t) {
  return {t.begin(), t.end()};
}

std::uint32_t first_equal(const Triangles& triangles, std::uint32_t triangle) {
  for (std::uint32_t t = 0; t < triangle; ++t)
    if (nodes_of(triangles[t]) == nodes_of(triangles[triangle])) return t;
  return triangle;
}

// How many triangles without a predecessor have the edge, counted once for each of their sides that is it.
int count_sides(const Triangles& triangles, std::uint32_t u, std::uint32_t v) {
  int count = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3 && first_equal(triangles, t) == t; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      count += (a == u && b == v) || (a == v && b == u);
    }
  return count;
}

bool is_border_node(const Triangles& triangles, std::uint32_t node) {
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if ((t[k] == node || t[(k + 1) % 3] == node) && count_sides(triangles, t[k], t[(k + 1) % 3]) != 2)
        return true;
  return false;
}

void expect_same(const Triangles& triangles, std::size_t node_count) {
  const MeshTopology topology(triangles, node_count);
  ASSERT_EQ(topology.triangle_count(), triangles.size());
  ASSERT_EQ(topology.node_count(), node_count);
  std::vector<bool> border;
  for (std::uint32_t node = 0; node < node_count; ++node) {
    border.push_back(is_border_node(triangles, node));
    std::vector<std::uint32_t> expected;
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      expected.insert(expected.end(), nodes_of(triangles[t]).count(node), t);
    const Span<const std::uint32_t> found = topology.triangles_of(node);
    EXPECT_EQ(std::vector<std::uint32_t>(found.begin(), found.end()), expected) << "node " << node;
  }
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    EXPECT_EQ(topology.first_equal(t), first_equal(triangles, t)) << "triangle " << t;
    EXPECT_EQ(topology.is_duplicate(t), first_equal(triangles, t) != t) << "triangle " << t;
    const bool at_border = std::any_of(triangles[t].begin(), triangles[t].end(),
                                       [&](std::uint32_t node) { return border[node]; });
    EXPECT_EQ(topology.is_at_border(t), at_border) << "triangle " << t;
  }
}

Triangles grid(std::uint32_t columns, std::uint32_t rows) {
  Triangles triangles;
  for (std::uint32_t j = 0; j + 1 < rows; ++j)
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = j * columns + i, b = a + 1, c = a + columns, d = c + 1;
      triangles.push_back({a, b, d});
      triangles.push_back({a, d, c});
    }
  return triangles;
}

TEST(MeshTopology, no_triangles) {
  expect_same({}, 0);
  expect_same({}, 3);
  EXPECT_EQ(MeshTopology().triangle_count(), 0u);
  EXPECT_EQ(MeshTopology().node_count(), 0u);
}

TEST(MeshTopology, a_sheet_has_a_border_and_a_closed_body_has_none) {
  const Triangles sheet = grid(6, 5), tetrahedron{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  expect_same(sheet, 30);
  expect_same(tetrahedron, 4);
  const MeshTopology open(sheet, 30), closed(tetrahedron, 4);
  std::size_t inner = 0;
  for (std::uint32_t t = 0; t < sheet.size(); ++t) inner += !open.is_at_border(t);
  EXPECT_EQ(inner, 2u * 3 * 2);  // the cells that have no node on the border
  for (std::uint32_t t = 0; t < 4; ++t) EXPECT_FALSE(closed.is_at_border(t));
}

TEST(MeshTopology, neighbours_and_parts_follow_edges_of_two_triangles) {
  Triangles two = grid(3, 2);
  for (const Triangle& t : grid(2, 2)) two.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  std::swap(two[1][1], two[1][2]);  // turned over
  const MeshTopology topology(two, 10);
  EXPECT_EQ(topology.neighbour(0, 2), 1u) << "over the diagonal";
  EXPECT_EQ(topology.neighbour(0, 0), MeshTopology::none) << "the border";
  EXPECT_EQ(topology.neighbour(0, 1), 3u);
  EXPECT_TRUE(topology.is_oriented_like(0, 1));
  EXPECT_FALSE(topology.is_oriented_like(0, 2));
  for (std::uint32_t t = 0; t < 4; ++t) EXPECT_EQ(topology.part(t), 0u);
  for (std::uint32_t t = 4; t < 6; ++t) EXPECT_EQ(topology.part(t), 4u);
}

TEST(MeshTopology, duplicates_of_either_winding_leave_the_border_where_it_is) {
  Triangles tetrahedron{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  tetrahedron.push_back({1, 2, 0});
  tetrahedron.push_back({3, 2, 1});
  expect_same(tetrahedron, 4);
  const MeshTopology topology(tetrahedron, 4);
  EXPECT_EQ(topology.first_equal(4), 0u);
  EXPECT_EQ(topology.first_equal(5), 2u);
  EXPECT_FALSE(topology.is_at_border(4));
}

TEST(MeshTopology, an_edge_of_three_triangles_is_a_border) {
  Triangles closed{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  closed.push_back({0, 1, 4});  // a fin
  expect_same(closed, 5);
  EXPECT_TRUE(MeshTopology(closed, 5).is_at_border(0));
}

// Few nodes, so that equal triangles, degenerate ones and edges of many triangles are frequent.
TEST(MeshTopology, random_meshes_match_the_definitions) {
  test::Random random(20);
  int duplicates = 0, degenerate = 0;
  for (int mesh = 0; mesh < 300; ++mesh) {
    const std::uint32_t nodes = 1 + random.below(9);
    const auto node = [&] { return random.below(nodes); };
    Triangles triangles(random.below(25));
    for (Triangle& t : triangles) t = {node(), node(), node()};
    expect_same(triangles, nodes);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      duplicates += first_equal(triangles, t) != t;
      degenerate += std::set<std::uint32_t>(triangles[t].begin(), triangles[t].end()).size() < 3;
    }
  }
  EXPECT_GT(duplicates, 100);
  EXPECT_GT(degenerate, 100);
}

TEST(MeshTopology, knows_which_parts_are_closed_and_oriented) {
  const Triangles tetrahedron = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  const auto closed = [](const Triangles& triangles) {
    const MeshTopology topology(triangles, 8);
    std::vector<bool> all;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) all.push_back(topology.is_closed(t));
    return all;
  };
  EXPECT_EQ(closed(tetrahedron), std::vector<bool>(4, true));
  EXPECT_EQ(closed({tetrahedron.begin(), tetrahedron.begin() + 3}), std::vector<bool>(3, false)) << "open";
  Triangles turned = tetrahedron;
  std::swap(turned[2][0], turned[2][1]);
  EXPECT_EQ(closed(turned), std::vector<bool>(4, false));
  Triangles two = tetrahedron;  // a second part, open
  two.push_back({4, 5, 6});
  EXPECT_EQ(closed(two), (std::vector<bool>{true, true, true, true, false}));
  Triangles fin = tetrahedron;  // at an edge that has three triangles then
  fin.push_back({0, 1, 7});
  EXPECT_EQ(closed(fin), std::vector<bool>(5, false));
}

}  // namespace
}  // namespace oilskin
