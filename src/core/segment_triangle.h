/// Does a segment touch a triangle? Watertight over shared edges and vertices. Internal to the library.
#pragma once

#include <array>

#include "oilskin/types.h"

namespace oilskin {

/// Does the closed segment p–q touch the closed triangle? `normal` is that of the corners in their order, not
/// normalised and not zero, and `side_p`, `side_q` its dot products with p − corner[0] and q − corner[0].
///
/// No line passes between triangles that share an edge: the sign of an edge is the same for both (its ends
/// are taken by ascending `nodes`, their numbers in the mesh). No line passes through a shared vertex: an
/// edge that the line touches within rounding counts for both sides. Symmetric in p and q up to rounding;
/// callers fix the order.
bool segment_touches(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& corner, const Triangle& nodes,
                     const Vec3& normal, double side_p, double side_q);

}  // namespace oilskin
