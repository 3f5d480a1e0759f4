/// Removes pieces of water that are too small.
#pragma once

#include "reconstruction/polygonise.h"

namespace oilskin::reconstruction {

/// Removes pieces of water that enclose less than `min_volume` [m³] without their bubbles; a piece is a set
/// of nodes joined by uncut grid edges. The mesh needs its inside_nodes. Returns the number of pieces.
/// `water_near` [m³], per vertex: what the piece there holds, if that is known and larger than what it
/// encloses; empty: what it encloses counts.
std::size_t remove_blobs(const Grid& grid, double min_volume, const std::vector<double>& water_near,
                         RawMesh& mesh);

/// Removes the vertices with `removed` != 0, and their triangles. All vertices of a triangle are removed, or
/// none.
void remove_vertices(const std::vector<std::uint8_t>& removed, RawMesh& mesh);

/// Six times the signed volume of the tetrahedron of a triangle and `origin` [m³].
double six_volumes(const std::vector<std::array<float, 3>>& positions, const Triangle& t,
                   const std::array<float, 3>& origin);

}  // namespace oilskin::reconstruction
