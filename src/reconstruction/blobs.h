/// Stray pieces of water that are too small to be shown.
#pragma once

#include "reconstruction/polygonise.h"

namespace oilskin::reconstruction {

/// Takes out of the mesh the pieces of water (nodes joined by edges of the grid that are not cut) that
/// enclose less than `least` [m³], bubbles in them included. The mesh needs its inside_nodes. Returns how
/// many pieces.
std::size_t remove_blobs(const Grid& grid, double minimum, RawMesh& mesh);

/// Six times the volume over a triangle [m³].
double six_volumes(const RawMesh& mesh, const Triangle& t, const std::array<float, 3>& origin);

}  // namespace oilskin::reconstruction
