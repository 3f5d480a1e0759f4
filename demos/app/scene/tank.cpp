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

bool is_open(const TankShape& tank, const Face& f) {
  return tank.open[f.axis] * f.side > 0;
}

/// Of the middle of the inside and of what turns with it.
struct Frame {
  explicit Frame(const TankShape& tank)
      : turn(tank.rotate[3], tank.rotate[0], tank.rotate[1], tank.rotate[2]),
        middle(0.5 * (tank.inside.min + tank.inside.max)),
        half(0.5 * (tank.inside.max - tank.inside.min)) {}

  Eigen::Quaterniond turn;
  Vec3 middle, half;
};

}  // namespace

Mesh tank_mesh(const TankShape& tank) {
  const Frame frame(tank);
  Mesh mesh;
  for (int c = 0; c < 8; ++c) {
    const Vec3 sign((c & 1) ? 1 : -1, (c & 2) ? 1 : -1, (c & 4) ? 1 : -1);
    mesh.vertices.push_back(frame.middle + frame.turn * Vec3(sign.cwiseProduct(frame.half)));
  }
  for (const Face& f : faces) {
    if (is_open(tank, f)) continue;
    mesh.triangles.push_back({f.corners[0], f.corners[1], f.corners[2]});
    mesh.triangles.push_back({f.corners[0], f.corners[2], f.corners[3]});
  }
  return mesh;
}

std::vector<BoxShape> tank_walls(const TankShape& tank, double thickness) {
  const Frame frame(tank);
  Vec3 min = -frame.half, max = frame.half;  // with the walls
  for (const Face& f : faces)
    if (!is_open(tank, f)) (f.side < 0 ? min : max)[f.axis] += f.side * thickness;
  std::vector<BoxShape> walls;
  for (const Face& f : faces) {
    if (is_open(tank, f)) continue;
    Box wall{min, max};
    (f.side < 0 ? wall.max : wall.min)[f.axis] = f.side * frame.half[f.axis];
    walls.push_back({frame.middle + frame.turn * Vec3(0.5 * (wall.min + wall.max)),
                     0.5 * (wall.max - wall.min), tank.rotate});
  }
  return walls;
}

}  // namespace oilskin::demo
