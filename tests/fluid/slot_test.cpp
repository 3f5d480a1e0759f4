/// Water that rises under a wall into a slot as narrow as a particle, and comes to rest as high as the tank.
#include <gtest/gtest.h>

#include <algorithm>

#include "oilskin/world.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin {
namespace {

constexpr double dx = 0.005, depth = 12 * dx, breadth = 4 * dx;  // [m]
constexpr double tank = 12 * dx, wall = 2 * dx, opening = 4 * dx;

/// A tank, a wall that ends above the floor, and a slot behind it, which is empty at the start.
class Slot {
 public:
  explicit Slot(double width) : world_(test::under_gravity(), test::of_spacing(dx)) {
    const double end = tank + wall + width, top = 0.25;
    const Vec3 y(0, top, 0), z(0, 0, breadth), raised(0, opening, 0);
    walls_.add_rectangle({0, 0, 0}, z, {end, 0, 0});
    for (const double at : {0.0, breadth}) walls_.add_rectangle({0, 0, at}, {end, 0, 0}, y);
    for (const double at : {0.0, end}) walls_.add_rectangle({at, 0, 0}, z, y);
    for (const double at : {tank, tank + wall}) walls_.add_rectangle(Vec3(at, 0, 0) + raised, z, y - raised);
    walls_.add_rectangle(Vec3(tank, 0, 0) + raised, z, {wall, 0, 0});
    SurfaceSettings surface;
    surface.thickness = 0.2 * dx;
    EXPECT_TRUE(world_.attach(walls_, surface, nullptr).ok());
    BoxEmitter water;
    water.box = {Vec3::Zero(), Vec3(tank, depth, breadth)};
    EXPECT_TRUE(world_.add_emitter(water).ok());
  }

  /// The slot's level over the tank's [m], mean of 0.4 s at rest.
  double rise() {
    while (world_.time() < 1) step();
    double sum = 0;
    int steps = 0;
    for (; world_.time() < 1.4; ++steps) {
      step();
      sum += level(tank + wall, 1) - level(0, tank);
    }
    return sum / steps;
  }

 private:
  void step() {
    const StepReport& report = world_.step(1e-3);
    ASSERT_TRUE(report.status.ok()) << report.status.message;
  }
  /// 98 % quantile of the centres with x in between, and half a spacing [m].
  double level(double from, double to) const {
    std::vector<double> heights;
    for (const Vec3& x : world_.positions())
      if (x.x() > from && x.x() < to) heights.push_back(x.y());
    std::sort(heights.begin(), heights.end());
    EXPECT_FALSE(heights.empty());
    return heights.empty() ? 0 : heights[heights.size() * 98 / 100] + dx / 2;
  }

  test::StaticMesh walls_;
  World world_;
};

TEST(Slot, stands_as_high_as_the_tank) {
  for (const double width : {1.0, 1.5}) {
    const double rise = Slot(width * dx).rise() / dx;
    EXPECT_LE(std::abs(rise), 1) << width << " spacings wide";
    RecordProperty("rise_at_" + std::to_string(static_cast<int>(10 * width)) + "_tenths",
                   std::to_string(rise));
  }
}

}  // namespace
}  // namespace oilskin
