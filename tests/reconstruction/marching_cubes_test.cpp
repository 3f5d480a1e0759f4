// The table, and cells that are cut: what two cells draw on the face between them must agree, always.
#include "reconstruction/marching_cubes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "reconstruction/cut_cells.h"
#include "support/random.h"

namespace oilskin::reconstruction {
namespace {

using Line = std::pair<int, int>;  // from vertex, to vertex

/// Directed edges of the triangles that are not passed both ways: the border of a cell's patches.
std::vector<Line> border(const std::vector<std::array<int, 3>>& triangles) {
  std::multiset<Line> lines;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) lines.insert({t[k], t[(k + 1) % 3]});
  std::vector<Line> left;
  for (const Line& l : lines)
    if (lines.count({l.second, l.first}) == 0) left.push_back(l);
  return left;
}

std::vector<std::array<int, 3>> triangles_of(int mask) {
  const CellCase& c = marching_cubes_table()[std::size_t(mask)];
  std::vector<std::array<int, 3>> out;
  for (std::size_t t = 0; t < c.count; ++t)
    out.push_back({c.triangles[t][0], c.triangles[t][1], c.triangles[t][2]});
  return out;
}

bool in_face(int edge, int face) {
  const int bit = 1 << face / 2, want = face % 2 ? bit : 0;
  const CellEdge& e = cell_edges[std::size_t(edge)];
  return (e.low & bit) == want && (e.high & bit) == want;
}

TEST(MarchingCubes, every_edge_with_ends_of_different_sign_has_a_vertex_and_no_other) {
  for (int mask = 0; mask < 256; ++mask) {
    std::set<int> used, wanted;
    for (const auto& t : triangles_of(mask)) used.insert(t.begin(), t.end());
    for (int e = 0; e < 12; ++e)
      if ((mask >> cell_edges[std::size_t(e)].low ^ mask >> cell_edges[std::size_t(e)].high) & 1)
        wanted.insert(e);
    EXPECT_EQ(used, wanted) << mask;
  }
}

TEST(MarchingCubes, borders_lie_in_faces_and_no_diagonal_does) {
  for (int mask = 0; mask < 256; ++mask) {
    const auto triangles = triangles_of(mask);
    const std::vector<Line> lines = border(triangles);
    for (const Line& l : lines) EXPECT_TRUE(share_a_face(l.first, l.second)) << mask;
    for (const auto& t : triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const Line l{t[k], t[(k + 1) % 3]};
        if (std::find(lines.begin(), lines.end(), l) == lines.end()) {
          EXPECT_FALSE(share_a_face(l.first, l.second)) << mask;
        }
      }
  }
}

TEST(MarchingCubes, one_inside_corner_has_a_triangle_that_looks_away_from_it) {
  for (int corner = 0; corner < 8; ++corner) {
    const auto triangles = triangles_of(1 << corner);
    ASSERT_EQ(triangles.size(), 1u);
    Vec3 p[3];
    const auto at = [](int c) { return Vec3(c & 1, c >> 1 & 1, c >> 2 & 1); };
    for (std::size_t k = 0; k < 3; ++k) {
      const CellEdge& e = cell_edges[std::size_t(triangles[0][k])];
      p[k] = 0.5 * (at(e.low) + at(e.high));
    }
    EXPECT_GT((p[1] - p[0]).cross(p[2] - p[0]).dot(p[0] - at(corner)), 0) << corner;
  }
}

/// The edge of the cell on the other side of a face that is the same edge of the grid.
int mirrored(int edge, int axis) {
  const CellEdge& e = cell_edges[std::size_t(edge)];
  return edge_between(e.low ^ 1 << axis, e.high ^ 1 << axis);
}

TEST(MarchingCubes, all_pairs_of_cells_draw_the_same_lines_on_the_face_they_share) {
  std::size_t pairs = 0, lines_seen = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int a = 0; a < 256; ++a)
      for (int b = 0; b < 256; ++b) {
        bool fits = true;  // corners on the high face of a are those on the low face of b
        for (int c = 0; c < 8; ++c)
          if (!(c >> axis & 1)) fits &= (a >> (c | 1 << axis) & 1) == (b >> c & 1);
        if (!fits) continue;
        ++pairs;
        std::set<Line> of_a, of_b;
        for (const Line& l : border(triangles_of(a)))
          if (in_face(l.first, 2 * axis + 1) && in_face(l.second, 2 * axis + 1))
            of_a.insert({mirrored(l.first, axis), mirrored(l.second, axis)});
        for (const Line& l : border(triangles_of(b)))
          if (in_face(l.first, 2 * axis) && in_face(l.second, 2 * axis)) of_b.insert({l.second, l.first});
        EXPECT_EQ(of_a, of_b) << a << " " << b << " along " << axis;
        lines_seen += of_a.size();
      }
  EXPECT_EQ(pairs, 3u * 256u * 16u);
  EXPECT_GT(lines_seen, pairs / 2);
}

/// Two cells side by side along an axis, with random signs and random cuts.
struct CellPair {
  std::uint8_t inside[2];
  std::uint16_t cuts[2];
};

/// A vertex: the edge as the second cell numbers it, and its end inside.
std::set<Line> face_lines(const CellPair& p, int cell, int axis) {
  std::set<Line> out;
  const int face = 2 * axis + (cell == 0 ? 1 : 0);
  for_parts(p.inside[cell], p.cuts[cell], [&](std::uint8_t part) {
    const auto vertex = [&](int edge) {
      const CellEdge& e = cell_edges[std::size_t(edge)];
      const bool high = !(part >> e.low & 1);
      return 2 * (cell == 0 ? mirrored(edge, axis) : edge) + high;
    };
    for (const Line& l : border(triangles_of(part))) {
      if (!in_face(l.first, face) || !in_face(l.second, face)) continue;
      const int from = vertex(l.first), to = vertex(l.second);
      out.insert(cell == 0 ? Line{from, to} : Line{to, from});
    }
  });
  return out;
}

/// The rule of clear_joined_edges(), for a pair: bits of corners of the second cell's low face are shared.
bool clear_joined(CellPair& p, int axis) {
  bool changed = false;
  for (int cell = 0; cell < 2; ++cell)
    for (unsigned e = 0; e < 12; ++e) {
      const CellEdge& edge = cell_edges[e];
      const std::uint8_t in = p.inside[cell];
      if (!(p.cuts[cell] >> e & 1) || !(in >> edge.low & 1) || !(in >> edge.high & 1)) continue;
      if (!(part_of(edge.low, p.cuts[cell]) >> edge.high & 1)) continue;
      p.inside[cell] = static_cast<std::uint8_t>(p.inside[cell] & ~(1u << edge.low));
      changed = true;
      const int other_face = cell == 0 ? 1 : 0;
      if ((edge.low >> axis & 1) == other_face)
        p.inside[1 - cell] = static_cast<std::uint8_t>(p.inside[1 - cell] & ~(1u << (edge.low ^ 1 << axis)));
    }
  return changed;
}

TEST(CutCells, cells_cut_at_random_draw_the_same_lines_on_the_face_they_share) {
  test::Random random(7);
  std::size_t with_two_parts = 0;
  for (int round = 0; round < 200000; ++round) {
    const int axis = int(random.below(3));
    const double share = random.uniform(0.05, 0.7);
    CellPair p{{std::uint8_t(random.bits()), std::uint8_t(random.bits())}, {0, 0}};
    for (int cell = 0; cell < 2; ++cell)
      for (unsigned e = 0; e < 12; ++e)
        if (random.uniform() < share) p.cuts[cell] = static_cast<std::uint16_t>(p.cuts[cell] | 1u << e);
    for (int c = 0; c < 8; ++c)  // the second cell takes the first one's high face
      if (!(c >> axis & 1)) {
        const unsigned bit = p.inside[0] >> (c | 1 << axis) & 1u;
        p.inside[1] = static_cast<std::uint8_t>((p.inside[1] & ~(1u << c)) | bit << c);
      }
    for (int e = 0; e < 12; ++e)
      if (in_face(e, 2 * axis)) {
        const unsigned bit = p.cuts[0] >> mirrored(e, axis) & 1u;
        p.cuts[1] = static_cast<std::uint16_t>((p.cuts[1] & ~(1u << e)) | bit << e);
      }
    while (clear_joined(p, axis)) {
    }
    ASSERT_EQ(face_lines(p, 0, axis), face_lines(p, 1, axis)) << round;
    int parts = 0;
    for_parts(p.inside[0], p.cuts[0], [&](std::uint8_t) { ++parts; });
    with_two_parts += parts > 1;
  }
  EXPECT_GT(with_two_parts, 10000u);
}

}  // namespace
}  // namespace oilskin::reconstruction
