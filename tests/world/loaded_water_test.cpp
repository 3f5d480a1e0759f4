// Intervals by the pressure of the water (F.55): columns of any height stand at a game's step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/mock_cloth.h"
#include "support/record.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"
#include "world/driven_sheet.h"

namespace oilskin::test {
namespace {

constexpr double dx = 0.005, g = 9.81;

/// A column of water in a shaft of `across` spacings. `down` is a unit axis.
struct Column {
  Column(int across, int layers_, const Vec3& down, PressureSolver solver, int max_substeps = 20)
      : layers(layers_), up(-down), world(box(2, g * down), fluid(solver, max_substeps)) {
    const Vec3 u = up.unitOrthogonal(), v = up.cross(u);
    const Vec3 corner = -0.5 * across * dx * (u + v);
    const Vec3 x = across * dx * u, z = across * dx * v, y = 2 * layers * dx * up;
    shaft.add_rectangle(corner, x, z);
    for (const Vec3& at : {corner, Vec3(corner + z)}) shaft.add_rectangle(at, x, y);
    for (const Vec3& at : {corner, Vec3(corner + x)}) shaft.add_rectangle(at, z, y);
    EXPECT_TRUE(world.attach(shaft, sheet_settings(), nullptr).ok());
    std::vector<Vec3> points;
    for (int i = 0; i < across; ++i)
      for (int j = 0; j < layers; ++j)
        for (int k = 0; k < across; ++k)
          points.push_back(corner + dx * ((i + 0.5) * u + (j + 0.5) * up + (k + 0.5) * v));
    EXPECT_TRUE(world.add_particles(points, std::vector<Vec3>(points.size(), Vec3::Zero())).ok());
    EXPECT_EQ(world.particle_count(), points.size());
  }

  static FluidSettings fluid(PressureSolver solver, int max_substeps) {
    FluidSettings s;
    s.spacing = dx;
    s.solver = solver;
    s.max_substeps = max_substeps;
    return s;
  }

  /// Means of the last third of `duration`: height over that of the lattice, density error, sub-steps.
  struct Means {
    double height = 0, density = 0, substeps = 0;
  };
  Means rest(double dt, double duration) {
    Means sum;
    int count = 0;
    while (world.time() < duration) {
      const StepReport& r = world.step(dt);
      EXPECT_TRUE(r.status.ok());
      if (world.time() < 2 * duration / 3) continue;
      double height = 0;
      for (const Vec3& x : world.positions()) height += x.dot(up);
      sum.height += 2 * height / (static_cast<double>(world.particle_count()) * layers * dx);
      sum.density += r.fluid.density_error_mean;
      sum.substeps += r.substeps;
      ++count;
    }
    return {sum.height / count, sum.density / count, sum.substeps / count};
  }

  int layers;
  Vec3 up;
  StaticMesh shaft;
  World world;
};

struct Case {
  int layers;
  double substeps;  // at two steps a frame of 1/60 s
  PressureSolver solver;
  Vec3 down;
};

class LoadedWater : public ::testing::TestWithParam<Case> {};

TEST_P(LoadedWater, stands_at_a_games_step) {
  const Case& c = GetParam();
  Column column(6, c.layers, c.down, c.solver);
  const Column::Means m = column.rest(1.0 / 120, 0.5);
  EXPECT_NEAR(m.height, 0.98, 0.02);
  EXPECT_LE(m.density, 0.005);
  EXPECT_NEAR(m.substeps, c.substeps, 0.5);
  record("height", m.height);
  record("density error", m.density);
}

const Vec3 aslant = Vec3(1, -2, 2) / 3;

INSTANTIATE_TEST_SUITE_P(Columns, LoadedWater,
                         ::testing::Values(Case{3, 1, PressureSolver::dfsph, -Vec3::UnitY()},
                                           Case{10, 2, PressureSolver::dfsph, -Vec3::UnitZ()},
                                           Case{20, 3, PressureSolver::dfsph, Vec3::UnitX()},
                                           Case{60, 5, PressureSolver::dfsph, aslant},
                                           Case{8, 4, PressureSolver::pcisph, aslant}));

TEST(LoadedWaterLimit, deep_water_is_compressed_where_sub_steps_are_too_few) {
  Column column(6, 60, -Vec3::UnitY(), PressureSolver::dfsph, 3);
  EXPECT_GE(column.rest(1.0 / 120, 0.5).density, 0.01) << "the limit would be needless";
}

/// Sub-steps of a step of 1/60 s in which nothing moves fast.
int substeps_of(const std::vector<Vec3>& positions, BoundaryModel boundary, bool with_cloth = false) {
  FluidSettings s = Column::fluid(PressureSolver::dfsph, 1000);
  s.boundary = boundary;
  s.cfl = 100;
  MockCloth<double> cloth;
  World w(box(5, Vec3(0, -g, 0)), s);
  if (with_cloth) EXPECT_TRUE(w.attach(cloth, sheet_settings(), nullptr).ok());
  EXPECT_TRUE(w.add_particles(positions, std::vector<Vec3>(positions.size(), Vec3::Zero())).ok());
  return w.step(1.0 / 60).substeps;
}

TEST(LoadedWaterLimit, takes_the_height_of_water_that_has_no_pressure_yet) {
  const auto parts = [](double layers) {
    return static_cast<int>(std::ceil(1.0 / 60 / (0.7 * std::sqrt(dx / (g * layers)))));
  };
  EXPECT_EQ(substeps_of({Vec3::Zero()}, BoundaryModel::mirrored), parts(3));
  EXPECT_EQ(substeps_of({Vec3::Zero(), Vec3(3, 0, 1)}, BoundaryModel::mirrored), parts(3))
      << "across gravity";
  std::vector<Vec3> tower;  // 2 m high, without pressure
  for (int k = 0; k <= 200; ++k) tower.emplace_back(0, 2 * k * dx, 0);
  EXPECT_EQ(substeps_of(tower, BoundaryModel::mirrored), parts(401));
  EXPECT_EQ(substeps_of(tower, BoundaryModel::contact_only), 1);
  EXPECT_EQ(substeps_of({Vec3(0, dx, 0)}, BoundaryModel::mirrored, true), parts(15)) << "near cloth";
}

TEST(LoadedWaterLimit, does_not_count_what_is_far_away) {
  const int shallow = substeps_of({Vec3::Zero()}, BoundaryModel::mirrored);
  EXPECT_EQ(substeps_of({Vec3::Zero(), Vec3(0, 2, 0)}, BoundaryModel::mirrored), shallow) << "a drop";
  std::vector<Vec3> two_pools;
  for (int k = 0; k < 3; ++k)
    for (double floor : {-1.0, 0.0, 2.0}) two_pools.emplace_back(floor, floor + 2 * k * dx, 0);
  EXPECT_EQ(substeps_of(two_pools, BoundaryModel::mirrored),
            substeps_of({{0, 0, 0}, {0, 2 * dx, 0}, {0, 4 * dx, 0}}, BoundaryModel::mirrored));
  EXPECT_EQ(substeps_of({Vec3(0, 1, 0)}, BoundaryModel::mirrored, true), shallow) << "cloth 1 m below";
}

}  // namespace
}  // namespace oilskin::test
