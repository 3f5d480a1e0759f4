// Water in the air keeps its shape: jets of any radius, boxes and meshes.
#include <gtest/gtest.h>

#include <cmath>

#include "support/random.h"
#include "support/record.h"
#include "support/world_helpers.h"

namespace oilskin::test {
namespace {

WorldSettings weightless() {
  WorldSettings w;
  w.gravity.setZero();
  w.kill_box = {Vec3::Constant(-1), Vec3::Constant(1)};
  w.threads = 1;
  return w;
}

Vec3 across(const Vec3& x, const Vec3& axis) {
  return x - x.dot(axis) * axis;
}

/// The root mean square distance from the axis between 30 and 70 mm from the nozzle, over that of a layer as
/// it is emitted.
double spread(const FluidSettings& fluid, const DiscEmitter& jet, double dt) {
  World first(weightless(), fluid), w(weightless(), fluid);
  EXPECT_TRUE(first.add_emitter(jet).ok() && w.add_emitter(jet).ok());
  const Vec3 axis = jet.direction.normalized();
  first.step(1e-9);
  double layer = 0, below = 0;
  for (const Vec3& x : first.positions()) layer += across(x, axis).squaredNorm();
  while (w.time() < 0.08 / jet.speed) w.step(dt);
  std::size_t count = 0;
  for (const Vec3& x : w.positions()) {
    if (x.dot(axis) < 0.03 || x.dot(axis) > 0.07) continue;
    below += across(x, axis).squaredNorm();
    ++count;
  }
  EXPECT_GT(count, 0u);
  return std::sqrt(below / static_cast<double>(count) * static_cast<double>(first.particle_count()) / layer);
}

struct Case {
  PressureSolver solver;
  BoundaryModel boundary;
};
constexpr Case cases[] = {{PressureSolver::pcisph, BoundaryModel::contact_only},
                          {PressureSolver::pcisph, BoundaryModel::mirrored},
                          {PressureSolver::dfsph, BoundaryModel::contact_only},
                          {PressureSolver::dfsph, BoundaryModel::mirrored},
                          {PressureSolver::mcg03, BoundaryModel::contact_only}};

double pick(Random& random, std::initializer_list<double> values) {
  return values.begin()[random.below(static_cast<std::uint32_t>(values.size()))];
}

/// `count` jets of random radius (in spacings), solver, boundary model, spacing, support radius, step, speed
/// and direction.
void expect_cylinders(int count, double max_radius, std::uint64_t seed) {
  Random random(seed);
  double worst = 0;
  for (int k = 0; k < count; ++k) {
    const Case& c = cases[random.below(5)];
    FluidSettings fluid;
    fluid.solver = c.solver;
    fluid.boundary = c.boundary;
    fluid.spacing = pick(random, {0.0025, 0.005, 0.01});
    fluid.support_ratio = pick(random, {1.6, 2, 2, 2.5});
    DiscEmitter jet;
    jet.radius = random.uniform(1, max_radius) * fluid.spacing;
    jet.speed = random.uniform(1, 10);
    jet.direction = random.direction();
    const double dt = pick(random, {1e-4, 5e-4, 1e-3, 2e-3});
    const double ratio = spread(fluid, jet, dt);
    EXPECT_NEAR(ratio, 1, 0.05) << "radius " << jet.radius / fluid.spacing << " spacings of " << fluid.spacing
                                << ", speed " << jet.speed << ", dt " << dt << ", solver "
                                << static_cast<int>(c.solver);
    worst = std::max(worst, ratio);
  }
  record("worst_spread", worst);
}

TEST(FreeJet, stays_a_cylinder_at_every_radius) {
  expect_cylinders(45, 5, 1);
}

TEST(LongFreeJet, stays_a_cylinder_at_every_radius) {
  expect_cylinders(400, 12, 2);
}

/// Of all particles, after 0.1 s without gravity [m/s].
double fastest_after(World& w, double dt) {
  while (w.time() < 0.1) w.step(dt);
  return test::fastest(w);
}

TEST(FreeFill, boxes_and_meshes_stay_where_they_are) {
  for (const Case& c : cases)
    for (const double ratio : {1.6, 2.0, 2.5}) {
      FluidSettings fluid;
      fluid.solver = c.solver;
      fluid.boundary = c.boundary;
      fluid.support_ratio = ratio;
      World w(weightless(), fluid);
      BoxEmitter box;
      box.box = {Vec3::Zero(), Vec3(0.0375, 0.041, 0.03)};
      MeshEmitter octahedron;
      for (int k = 0; k < 3; ++k)
        for (const double sign : {-1.0, 1.0})
          octahedron.vertices.push_back(Vec3::Constant(0.2) + 0.0287 * sign * Vec3::Unit(k));
      octahedron.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                              {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
      ASSERT_TRUE(w.add_emitter(box).ok() && w.add_emitter(octahedron).ok());
      EXPECT_LT(fastest_after(w, 1e-3), 1e-3) << static_cast<int>(c.solver) << ", H/dx " << ratio;
      EXPECT_GT(w.particle_count(), 7 * 8 * 6 + 20u);
    }
}

}  // namespace
}  // namespace oilskin::test
