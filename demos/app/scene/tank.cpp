#include "scene/tank.h"

namespace oilskin::demo {
namespace {

/// Corner c of a box has its bit k set on the far side of axis k. Seen from inside, each face runs
/// counterclockwise.
struct Face {
  int axis;
  double side;
  std::uint32_t corners[4];
};
constexpr Face faces[] = {{0, -1, {0, 2, 6, 4}}, {0, 1, {1, 5, 7, 3}},  {1, -1, {0, 4, 5, 1}},
                          {1, 1, {2, 3, 7, 6}},  {2, -1, {0, 1, 3, 2}}, {2, 1, {4, 6, 7, 5}}};

}  // namespace

Mesh tank_mesh(const TankShape& tank) {
  const Eigen::Quaterniond turn(tank.rotate[3], tank.rotate[0], tank.rotate[1], tank.rotate[2]);
  const Vec3 middle = 0.5 * (tank.inside.min + tank.inside.max),
             half = 0.5 * (tank.inside.max - tank.inside.min);
  Mesh mesh;
  for (int c = 0; c < 8; ++c) {
    const Vec3 sign((c & 1) ? 1 : -1, (c & 2) ? 1 : -1, (c & 4) ? 1 : -1);
    mesh.vertices.push_back(middle + turn * Vec3(sign.cwiseProduct(half)));
  }
  for (const Face& f : faces) {
    if (tank.open[f.axis] * f.side > 0) continue;
    mesh.triangles.push_back({f.corners[0], f.corners[1], f.corners[2]});
    mesh.triangles.push_back({f.corners[0], f.corners[2], f.corners[3]});
  }
  return mesh;
}

}  // namespace oilskin::demo
