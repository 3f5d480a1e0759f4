/// What DFSPH promises beyond what every incompressible model does (pressure_test.cpp).
#include <gtest/gtest.h>

#include "fluid/kernels.h"
#include "tank.h"

namespace oilskin::fluid {
namespace {

constexpr double dx = 0.005;

FluidSettings dfsph() {
  FluidSettings s = water();
  s.solver = PressureSolver::dfsph;
  return s;
}

/// A column of water at rest in a tank that fits it.
struct Column : Tank {
  Column(const FluidSettings& s, int nx, int ny) : Tank(s) {
    fill(nx, ny, nx, dx);
    box = {Vec3::Zero(), Vec3(nx * dx, 1, nx * dx)};
  }
  /// Mean pressure of the particles on the floor, relative to the weight of the column.
  double pressure_on_floor(int layers) const {
    double sum = 0;
    int counted = 0;
    for (std::size_t i = 0; i < particles.size(); ++i)
      if (particles.position[i].y() < dx) sum += particles.pressure[i], ++counted;
    return sum / counted / (1000 * 9.81 * layers * dx);
  }
};

/// Mean relative compression beyond ρ0 in a step of dt, of particles with a filled neighbourhood.
double mean_compression(Tank& tank, double dt) {
  const double h = tank.solver.support_radius(), volume = tank.solver.particle_mass() / 1000;
  double sum = 0;
  int counted = 0;
  for (std::size_t i = 0; i < tank.particles.size(); ++i) {
    double rate = 0;
    int neighbours = 0;
    for (std::size_t j = 0; j < tank.particles.size(); ++j) {
      const Vec3 r = tank.particles.position[i] - tank.particles.position[j];
      if (i == j || r.norm() >= h) continue;
      const Vec3 gradient = kernel_slope<CubicSpline>(r.norm(), h) * r.normalized();
      rate += volume * (tank.particles.velocity[i] - tank.particles.velocity[j]).dot(gradient);
      ++neighbours;
    }
    if (neighbours < 20) continue;
    sum += std::max(0.0, dt * rate + std::min(0.0, tank.particles.density[i] / 1000 - 1));
    ++counted;
  }
  return sum / counted;
}

/// Velocities of ±0.1 m/s towards the middle height.
void approach(Tank& tank, double middle) {
  for (std::size_t i = 0; i < tank.particles.size(); ++i)
    tank.particles.velocity[i].y() = tank.particles.position[i].y() > middle ? -0.1 : 0.1;
}

TEST(Dfsph, start_velocities_do_not_compress) {
  // The halves of a block approach each other. The density solver may stop at anything.
  const double dt = 1e-3;
  FluidSettings s = dfsph();
  s.xsph_rate = s.viscosity = 0;
  s.tolerance = 1;
  s.min_iterations = 1;
  for (const double tolerance : {1e-3, 1e-4}) {
    s.divergence_tolerance = tolerance;
    Tank tank(s);
    tank.walls = false;
    tank.gravity.setZero();
    tank.fill(8, 8, 8, dx);
    approach(tank, 4 * dx);
    tank.solver.prepare(tank.particles, tank.seconds);
    EXPECT_GT(mean_compression(tank, dt), 2e-3);
    tank.solver.propose(dt, tank.gravity, tank.particles, {}, {}, tank.particles.velocity, tank.report,
                        tank.seconds);
    EXPECT_GT(tank.report.divergence_iterations, 0);
    EXPECT_LE(mean_compression(tank, dt), 1.01 * tolerance);
    EXPECT_LE(tank.velocity_sum().norm(), 1e-12 * tank.speed_sum());
  }
}

TEST(Dfsph, expansion_and_rest_cost_no_divergence_iterations) {
  Tank tank(dfsph());
  tank.walls = false;
  tank.gravity.setZero();
  tank.fill(8, 8, 8, 1.01 * dx);
  for (std::size_t i = 0; i < tank.particles.size(); ++i)
    tank.particles.velocity[i] = 10 * (tank.particles.position[i] - Vec3::Constant(4 * dx));
  tank.step(5e-4);
  EXPECT_EQ(tank.report.divergence_iterations, 0);
  Column column(dfsph(), 8, 8);
  column.step(5e-4);
  EXPECT_EQ(column.report.divergence_iterations, 0);
}

TEST(Dfsph, gaps_may_close) {
  Tank tank(dfsph());
  tank.walls = false;
  tank.gravity.setZero();
  tank.fill(8, 8, 8, 1.05 * dx);
  approach(tank, 4 * 1.05 * dx);
  tank.step(5e-4);
  EXPECT_EQ(tank.report.divergence_iterations, 0);
  for (const double p : tank.particles.pressure) EXPECT_EQ(p, 0);
}

TEST(Dfsph, spray_is_not_held_apart) {
  // Drops of a few particles that approach each other: too few neighbours to speak of compression.
  Tank tank(dfsph());
  tank.walls = false;
  tank.gravity.setZero();
  tank.fill(2, 2, 2, dx);
  for (std::size_t i = 0; i < tank.particles.size(); ++i)
    tank.particles.velocity[i].x() = tank.particles.position[i].x() > dx ? -0.1 : 0.1;
  tank.step(5e-4);
  EXPECT_EQ(tank.report.divergence_iterations, 0);
  for (const double p : tank.particles.pressure) EXPECT_EQ(p, 0);
}

TEST(Dfsph, density_error_of_the_next_step_is_within_the_tolerance) {
  // The report is of a linear prediction; the truth is the density at the positions to which it leads.
  Column tank(dfsph(), 10, 20);
  double sum = 0;
  for (int step = 0; step < 300; ++step) {
    tank.step(5e-4);
    ASSERT_TRUE(tank.report.converged);
    ASSERT_LE(tank.report.density_error_mean, tank.settings.tolerance);
    if (step < 200) continue;
    for (const double density : tank.particles.density) sum += std::max(0.0, density / 1000 - 1);
  }
  EXPECT_LT(sum / 100 / static_cast<double>(tank.particles.size()), tank.settings.tolerance);
}

TEST(Dfsph, pressure_at_rest_does_not_swing) {
  // More than a handful of iterations, at a time step where they used to alternate between few and many.
  Column tank(dfsph(), 10, 30);
  double sum = 0, squares = 0;
  int fewest = 1000, maximum = 0;
  for (int step = 0; step < 600; ++step) {
    tank.step(1e-3);
    if (step < 400) continue;
    const double p = tank.pressure_on_floor(30);
    sum += p / 200;
    squares += p * p / 200;
    fewest = std::min(fewest, tank.report.iterations);
    maximum = std::max(maximum, tank.report.iterations);
  }
  EXPECT_NEAR(sum, 1, 0.2);
  EXPECT_LT(std::sqrt(std::max(0.0, squares - sum * sum)), 0.06);
  EXPECT_LE(maximum - fewest, 1);
}

TEST(Dfsph, a_deep_column_takes_fewer_iterations_than_pcisph) {
  auto iterations = [](PressureSolver solver) {
    FluidSettings s = water();
    s.solver = solver;
    s.tolerance = 1e-4;
    s.max_iterations = 500;
    Column tank(s, 6, 40);
    int sum = 0;
    for (int step = 0; step < 60; ++step) {
      tank.step(1e-3);
      if (solver == PressureSolver::dfsph) {
        EXPECT_TRUE(tank.report.converged);
      }
      if (step >= 30) sum += tank.report.iterations;
    }
    return sum;
  };
  EXPECT_LT(iterations(PressureSolver::dfsph), 0.5 * iterations(PressureSolver::pcisph));
}

TEST(Dfsph, iterations_fall_again_after_an_impact) {
  FluidSettings s = dfsph();
  s.max_iterations = 200;
  Column tank(s, 10, 10);
  for (Vec3& v : tank.particles.velocity) v.y() = -3;
  int maximum = 0;
  for (int step = 0; step < 300; ++step) {
    tank.step(5e-4);
    ASSERT_TRUE(tank.finite());
    maximum = std::max(maximum, tank.report.iterations);
  }
  EXPECT_GT(maximum, 8);
  EXPECT_LE(tank.report.iterations, 4);
}

}  // namespace
}  // namespace oilskin::fluid
