#include "view/nozzle_mesh.h"

#include <Eigen/Geometry>
#include <cmath>

namespace oilskin::demo {

Mesh nozzle_mesh(const Vec3& center, const Vec3& direction, double radius) {
  constexpr std::uint32_t sides = 40;
  constexpr double pi = 3.14159265358979323846, wider = 1.12, length = 2;
  const Vec3 u = direction.unitOrthogonal(), v = direction.cross(u);
  Mesh tube;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2 * pi * i / sides;
    const Vec3 rim = center + wider * radius * (std::cos(angle) * u + std::sin(angle) * v);
    tube.vertices.push_back(rim);
    tube.vertices.push_back(rim - length * radius * direction);
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % sides);
    tube.triangles.push_back({a, a + 1, b});
    tube.triangles.push_back({b, a + 1, b + 1});
  }
  return tube;
}

}  // namespace oilskin::demo
