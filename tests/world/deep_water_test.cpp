// Deep water at rest: its pressure does not swing, whatever the step (F.82), (F.35).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "support/averager.h"
#include "support/record.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin {
namespace {

struct Scatter {
  double force = 0;   // standard deviation of the force on the floor over its mean
  double weight = 0;  // mean of that force over the weight
  double depth = 0;   // over that of the mass
};

/// A column in a tank of 12 particles across, which is let go on the lattice: the start makes it swing. The
/// force is that of the steps after 0.3 s.
Scatter force_on_floor(double spacing, int layers, double dt, double end) {
  constexpr int across = 12;
  FluidSettings fluid;
  fluid.spacing = spacing;
  WorldSettings settings;
  settings.kill_box = {Vec3::Constant(-1), Vec3::Constant(1)};
  World w(settings, fluid);
  const double width = across * spacing, height = 1.5 * layers * spacing;
  const auto cells = static_cast<std::uint32_t>(std::ceil(height / 0.02));
  test::StaticMesh floor, sides;
  floor.add_rectangle(Vec3::Zero(), Vec3(width, 0, 0), Vec3(0, 0, width), 3, 3);
  for (const double at : {0.0, width}) {
    sides.add_rectangle(Vec3(at, 0, 0), Vec3(0, height, 0), Vec3(0, 0, width), cells, 3);
    sides.add_rectangle(Vec3(0, 0, at), Vec3(width, 0, 0), Vec3(0, height, 0), 3, cells);
  }
  SurfaceId floor_id, sides_id;
  EXPECT_TRUE(w.attach(floor, test::sheet_settings(), &floor_id).ok());
  EXPECT_TRUE(w.attach(sides, test::sheet_settings(), &sides_id).ok());
  std::vector<Vec3> x;
  for (int j = 0; j < layers; ++j)
    for (int i = 0; i < across; ++i)
      for (int k = 0; k < across; ++k) x.push_back(spacing * Vec3(i + 0.5, j + 0.5, k + 0.5));
  EXPECT_TRUE(w.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())).ok());
  test::Averager force, squared, depth;
  while (w.time() < end) {
    EXPECT_TRUE(w.step(dt).status.ok());
    if (w.time() < 0.3) continue;
    double f = 0, h = 0;  // [N], [m]
    for (const Vec3& j : w.surface(floor_id)->impulse) f -= j.y() / dt;
    for (const Vec3& p : w.positions()) h += 2 * p.y() / static_cast<double>(x.size());
    force.add(f, dt);
    squared.add(f * f, dt);
    depth.add(h, dt);
  }
  EXPECT_EQ(w.particle_count(), x.size());
  const double variance = squared.mean() - force.mean() * force.mean();
  return {std::sqrt(std::max(0.0, variance)) / force.mean(), force.mean() / (w.fluid_mass() * 9.81),
          depth.mean() * 1000 * width * width / w.fluid_mass()};
}

void expect_calm(double spacing, int layers, double dt, double end) {
  const Scatter s = force_on_floor(spacing, layers, dt, end);
  const std::string of = std::to_string(layers) + " layers of " + std::to_string(spacing) + " m";
  test::record("scatter of the force, " + of, s.force);
  test::record("depth, " + of, s.depth);
  EXPECT_LT(s.force, 0.05) << of;
  EXPECT_NEAR(s.weight, 1, 0.01) << of;
  EXPECT_NEAR(s.depth, 1, 0.012) << of;
}

TEST(DeepWater, presses_evenly_on_the_floor) {
  expect_calm(0.005, 20, 0.001, 0.6);
}

// 80 layers with two steps each: in one the loops need 10 iterations, in the other 25.
TEST(LongDeepWater, presses_evenly_on_the_floor) {
  for (const double dt : {0.0005, 0.001}) {
    expect_calm(0.0025, 40, dt, 0.8);
    expect_calm(0.0025, 80, dt, 0.8);
    expect_calm(0.005, 40, dt, 0.8);
  }
  expect_calm(0.01, 20, 0.002, 0.8);
}

}  // namespace
}  // namespace oilskin
