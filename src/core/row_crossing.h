/// Where a row, a line along x at (y, z), passes through triangles. Rows through edges and nodes are decided
/// in one way for all triangles, so that a closed mesh is entered as often as it is left.
#pragma once

#include "oilskin/types.h"

namespace oilskin {

/// 0 where the row does not pass the triangle, else the sign of the x component of its normal.
int row_sign(const Vec3& a, const Vec3& b, const Vec3& c, double y, double z);

/// x at which the row intersects a triangle that it passes.
double row_x(const Vec3& a, const Vec3& b, const Vec3& c, double y, double z);

/// How many times a closed mesh winds round x: the crossings of the row in front of it. Not 0 = inside.
int crossing_number(Span<const Triangle> triangles, Span<const Vec3> nodes, const Vec3& x);

}  // namespace oilskin
