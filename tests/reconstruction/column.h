/// Where a line is in the water of a mesh.
#pragma once

#include "reconstruction/promise.h"

namespace oilskin::test {

/// The parts of a line through a point that are in the water, as distances from the point [m].
struct Column {
  double low = INFINITY, high = -INFINITY, length = 0;
  bool is_wet() const { return high > low; }
};

/// `direction`: unit. Triangles whose first corner is farther than `reach` along x or y are left out.
inline Column column_over(const WaterMesh& mesh, const Vec3& base, const Vec3& direction, double reach) {
  Column column;
  for (const Triangle& t : mesh.triangles) {
    if (std::abs(double(mesh.positions[t[0]][0]) - base.x()) > reach ||
        std::abs(double(mesh.positions[t[0]][1]) - base.y()) > reach)
      continue;
    const Vec3 a = position(mesh, t[0]) - base, b = position(mesh, t[1]) - base,
               c = position(mesh, t[2]) - base;
    const double u = direction.dot(b.cross(c)), v = direction.dot(c.cross(a)), w = direction.dot(a.cross(b));
    if (!((u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0))) continue;
    const double at = a.dot(b.cross(c)) / (u + v + w);
    column.low = std::min(column.low, at);
    column.high = std::max(column.high, at);
    column.length += u > 0 ? at : -at;
  }
  return column;
}

}  // namespace oilskin::test
