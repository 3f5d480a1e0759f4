/// The 256 cases of marching cubes [Lorensen1987], made by a rule instead of copied: on every face
/// each run of inside corners is cut off by itself, so two inside corners on a diagonal are parted. The two
/// cells at a face see the same corners, hence the same lines, and nothing cracks.
///
/// Corner c of a cell lies at (c & 1, c >> 1 & 1, c >> 2 & 1). Edge e runs along axis e / 4.
#pragma once

#include <array>
#include <cstdint>

namespace oilskin::reconstruction {

struct CellEdge {
  std::uint8_t axis, low, high;  ///< corners at its ends
};

/// Edges 4 axis + i, by the lower of the two other axes first.
constexpr std::array<CellEdge, 12> cell_edges = {{{0, 0, 1},
                                                  {0, 2, 3},
                                                  {0, 4, 5},
                                                  {0, 6, 7},
                                                  {1, 0, 2},
                                                  {1, 1, 3},
                                                  {1, 4, 6},
                                                  {1, 5, 7},
                                                  {2, 0, 4},
                                                  {2, 1, 5},
                                                  {2, 2, 6},
                                                  {2, 3, 7}}};

/// The corners of a face, counter-clockwise seen from outside. Face 2 a is the low one of axis a, 2 a + 1 the
/// high.
using FaceCorners = std::array<std::uint8_t, 4>;
FaceCorners face_corners(int face);

/// The edge between two corners.
int edge_between(int corner, int other);

/// Do two edges lie in one face?
bool share_a_face(int edge, int other);

struct CellCase {
  std::uint8_t count = 0;                                  ///< triangles
  std::array<std::array<std::uint8_t, 3>, 6> triangles{};  ///< edges; outward from the inside corners
};

/// By the mask of inside corners. No diagonal of a polygon lies in a face, where a neighbour could draw it,
/// too: every edge of the mesh has two triangles.
const std::array<CellCase, 256>& marching_cubes_table();

}  // namespace oilskin::reconstruction
