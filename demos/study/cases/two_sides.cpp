#include "study/cases/two_sides.h"

#include "study/cases/measures.h"
#include "study/cases/parts.h"
#include "study/cases/shapes.h"

namespace oilskin::demo {
namespace {

constexpr double length = 0.04, breadth = 0.04, height = 0.1;  // of each side [m]
constexpr double beyond = 0.01;                                // the sheet goes on behind floor and walls [m]

Cloth dividing_sheet(bool free_inside) {
  Cloth cloth;
  // Few triangles: the cost of walls grows with their number within the support radius.
  cloth.grid = free_inside ? std::array<int, 2>{5, 8} : std::array<int, 2>{3, 4};
  cloth.size = {breadth + 2 * beyond, height + beyond};
  cloth.center = Vec3(0, 0.5 * (height - beyond), 0.5 * breadth);
  cloth.normal = Vec3(1, 0, 0);
  cloth.u_axis = Vec3(0, 0, 1);
  if (free_inside)
    cloth.pins.kind = PinKind::border;
  else
    pin(cloth, {Vec3::Constant(-1), Vec3::Constant(1)});
  return cloth;
}

}  // namespace

Scene two_sides_scene(const TwoSides& sides, double spacing) {
  Scene scene = empty_scene(spacing, 1);
  scene.emitters = {water_box(Vec3(-length, 0, 0), Vec3(0, sides.left, breadth)),
                    water_box(Vec3::Zero(), Vec3(length, sides.right, breadth))};
  scene.bodies = {tank_body(Vec3(-length, 0, 0), Vec3(length, height, breadth))};
  scene.cloth = {dividing_sheet(sides.free_inside)};
  return scene;
}

void SheetForce::after_step(const Moment& now) {
  if (in_last(0.5 * now.scene.duration, now))
    force_.add(impulse_on(now.simulation.cloth(0)).x() / now.dt, now.dt);
}

double SheetForce::one_sided(const Moment& end, int side) {
  const World& world = end.simulation.world();
  Box half = {Vec3::Constant(-1), Vec3::Constant(1)};
  (side < 0 ? half.max : half.min).x() = 0;
  const double h = depth_of(world, mass_within(world, half), length * breadth);
  return 0.5 * water_density * earth * breadth * h * h;
}

}  // namespace oilskin::demo
