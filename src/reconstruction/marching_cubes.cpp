#include "reconstruction/marching_cubes.h"

#include <vector>

#include "core/assert.h"

namespace oilskin::reconstruction {

namespace {

using Polygon = std::vector<std::uint8_t>;

/// next[e]: the edge at which the line ends that starts at edge e. Each cut edge starts a line in one of its
/// two faces and ends one in the other.
std::array<std::int8_t, 12> lines_of(int mask) {
  std::array<std::int8_t, 12> next;
  next.fill(-1);
  for (int face = 0; face < 6; ++face) {
    const FaceCorners c = face_corners(face);
    const auto inside = [&](int i) { return mask >> c[std::size_t(i & 3)] & 1; };
    const auto edge = [&](int i) { return edge_between(c[std::size_t(i & 3)], c[std::size_t((i + 1) & 3)]); };
    for (int i = 0; i < 4; ++i) {
      if (inside(i) || !inside(i + 1)) continue;  // a run of inside corners begins behind edge i
      int last = i + 1;
      while (inside(last + 1)) ++last;
      next[std::size_t(edge(i))] = static_cast<std::int8_t>(edge(last));
    }
  }
  return next;
}

std::vector<Polygon> polygons_of(int mask) {
  const auto next = lines_of(mask);
  std::array<bool, 12> done{};
  std::vector<Polygon> polygons;
  for (std::size_t start = 0; start < 12; ++start) {
    if (next[start] < 0 || done[start]) continue;
    Polygon polygon;
    for (std::size_t e = start; !done[e]; e = static_cast<std::uint8_t>(next[e])) {
      OILSKIN_ASSERT(next[e] >= 0);
      done[e] = true;
      polygon.push_back(static_cast<std::uint8_t>(e));
    }
    polygons.push_back(polygon);
  }
  return polygons;
}

/// May a triangulation of the polygon have the edge from corner i to corner j?
bool allowed(const Polygon& p, std::size_t i, std::size_t j) {
  return j == i + 1 || (i == 0 && j + 1 == p.size()) || !share_a_face(p[i], p[j]);
}

/// Triangulates corners i … j below the edge i–j with the first triangulation that is allowed.
bool triangulate(const Polygon& p, std::size_t i, std::size_t j, CellCase& out) {
  if (j == i + 1) return true;
  for (std::size_t m = i + 1; m < j; ++m) {
    if (!allowed(p, i, m) || !allowed(p, m, j)) continue;
    const std::uint8_t before = out.count;
    OILSKIN_ASSERT(before < out.triangles.size());
    out.triangles[out.count++] = {p[i], p[m], p[j]};
    if (triangulate(p, i, m, out) && triangulate(p, m, j, out)) return true;
    out.count = before;
  }
  return false;
}

std::array<CellCase, 256> make_table() {
  std::array<CellCase, 256> table{};
  for (int mask = 0; mask < 256; ++mask)
    for (const Polygon& polygon : polygons_of(mask)) {
      [[maybe_unused]] const bool ok =
          triangulate(polygon, 0, polygon.size() - 1, table[static_cast<std::size_t>(mask)]);
      OILSKIN_ASSERT(ok);
    }
  return table;
}

}  // namespace

FaceCorners face_corners(int face) {
  const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const int base = face % 2 << axis, du = 1 << u, dv = 1 << v;
  const auto corner = [](int c) { return static_cast<std::uint8_t>(c); };
  if (face % 2) return {corner(base), corner(base + du), corner(base + du + dv), corner(base + dv)};
  return {corner(base), corner(base + dv), corner(base + du + dv), corner(base + du)};
}

int edge_between(int corner, int other) {
  for (int e = 0; e < 12; ++e) {
    const CellEdge& c = cell_edges[std::size_t(e)];
    if ((c.low == corner && c.high == other) || (c.low == other && c.high == corner)) return e;
  }
  OILSKIN_ASSERT(!"no such edge");
  return -1;
}

bool share_a_face(int edge, int other) {
  const CellEdge &a = cell_edges[std::size_t(edge)], &b = cell_edges[std::size_t(other)];
  const int all = 7, zeros = ~(a.low | a.high | b.low | b.high) & all, ones = a.low & a.high & b.low & b.high;
  return zeros != 0 || ones != 0;
}

const std::array<CellCase, 256>& marching_cubes_table() {
  static const std::array<CellCase, 256> table = make_table();
  return table;
}

}  // namespace oilskin::reconstruction
