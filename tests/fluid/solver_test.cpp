/// What holds for every fluid model.
#include <gtest/gtest.h>

#include "fluid/lattice.h"
#include "fluid/random.h"
#include "tank.h"

namespace oilskin::fluid {
namespace {

class EveryModel : public testing::TestWithParam<PressureSolver> {
 protected:
  static FluidSettings settings() {
    FluidSettings s = water();
    s.solver = GetParam();
    return s;
  }
};
INSTANTIATE_TEST_SUITE_P(Fluid, EveryModel,
                         testing::Values(PressureSolver::mcg03, PressureSolver::pcisph,
                                         PressureSolver::dfsph),
                         [](const auto& test) { return solver_name(test.param); });

/// A disordered, partly compressed blob with random velocities.
void fill_randomly(Tank& tank, std::size_t n, double size, std::uint64_t seed) {
  auto random = [&](std::uint64_t k) { return 2 * random_unit(seed, k) - 1; };
  for (std::size_t i = 0; i < n; ++i)
    tank.add(size * Vec3(random(6 * i), random(6 * i + 1), random(6 * i + 2)),
             Vec3(random(6 * i + 3), random(6 * i + 4), random(6 * i + 5)));
}

TEST_P(EveryModel, mass_gives_the_lattice_rest_density) {
  Tank tank(settings());
  tank.fill(12, 12, 12, 0.005);
  tank.walls = false;
  tank.step(1e-4);
  std::size_t inner = 0;
  for (std::size_t i = 0; i < tank.particles.size(); ++i) {
    if (((tank.particles.position[i].array() < 0.02) || (tank.particles.position[i].array() > 0.04)).any())
      continue;
    EXPECT_NEAR(tank.particles.density[i], 1000, 1e-2);
    ++inner;
  }
  EXPECT_EQ(inner, 64u);
  EXPECT_NEAR(tank.solver.particle_mass(), 1.25e-4, 2e-6);
}

TEST_P(EveryModel, roll_back_repeats_a_step) {
  const auto hash_after = [&](bool checkpoint, double dt_between) {
    Tank tank(settings());
    fill_randomly(tank, 1500, 0.03, 4);
    tank.walls = false;
    for (int k = 0; k < 3; ++k) tank.step(5e-4);
    const Particles before = tank.particles;
    if (checkpoint) tank.solver.checkpoint();
    if (dt_between > 0) tank.step(dt_between);
    if (checkpoint) tank.solver.roll_back();
    tank.particles = before;
    tank.step(5e-4);
    return tank.hash();
  };
  EXPECT_EQ(hash_after(true, 2e-4), hash_after(false, 0));
  if (GetParam() != PressureSolver::mcg03) {  // which keeps nothing
    EXPECT_NE(hash_after(false, 2e-4), hash_after(false, 0));
  }
}

/// Emitted particles are appended between prepare() and propose().
TEST_P(EveryModel, appended_particles_take_no_part) {
  Tank with(settings()), without(settings());
  std::vector<Vec3> velocity[2];
  for (Tank* tank : {&with, &without}) {
    fill_randomly(*tank, 1500, 0.03, 4);
    tank->solver.prepare(tank->particles, tank->seconds);
    if (tank == &with) tank->add(Vec3(0.001, 0.002, 0.003), Vec3(1, 2, 3));
    std::vector<Vec3>& v = velocity[tank == &with];
    v.assign(tank->particles.size(), Vec3::Zero());
    const std::vector<Vec3> before = tank->particles.velocity;
    tank->solver.propose(5e-4, tank->gravity, tank->particles, {}, {}, v, tank->report, tank->seconds);
    EXPECT_EQ(tank->particles.velocity, before) << "is read only";
  }
  EXPECT_EQ(velocity[1].back(), Vec3::Zero());
  velocity[1].pop_back();
  EXPECT_EQ(velocity[0], velocity[1]);
}

TEST_P(EveryModel, momentum_changes_by_gravity_alone) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Tank tank(settings());
    fill_randomly(tank, 3000, 0.04, seed);
    tank.walls = false;
    for (int step = 0; step < 5; ++step) {
      const Vec3 before = tank.velocity_sum();
      tank.step(5e-4);
      const Vec3 gained = tank.velocity_sum() - before - 3000 * 5e-4 * tank.gravity;
      EXPECT_LE(gained.norm(), 1e-12 * tank.speed_sum());
      EXPECT_GT(*std::max_element(tank.particles.pressure.begin(), tank.particles.pressure.end()), 0);
    }
  }
}

TEST_P(EveryModel, isolated_spray_is_ballistic) {
  Tank tank(settings());
  for (int i = 0; i < 50; ++i) tank.add(0.02 * Vec3(i, i % 7, i % 3), Vec3(1, 2, i));
  const std::vector<Vec3> v0 = tank.particles.velocity;
  tank.walls = false;
  for (int step = 0; step < 10; ++step) tank.step(1e-3);
  const std::vector<std::size_t> order = tank.by_id();
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(tank.particles.pressure[order[i]], 0);
    EXPECT_LT((tank.particles.velocity[order[i]] - v0[i] - 0.01 * tank.gravity).norm(), 1e-14 * 100);
  }
  EXPECT_EQ(tank.report.density_error_max, 0);
  EXPECT_TRUE(tank.report.converged);
}

TEST_P(EveryModel, results_do_not_depend_on_threads) {
  std::vector<std::uint64_t> hashes;
  for (const int threads : {1, 2, 3}) {
    FluidSettings s = settings();
    Tank tank(s, threads);
    tank.box = {Vec3::Zero(), Vec3(0.12, 0.2, 0.06)};
    tank.fill(14, 16, 12, 0.005);
    for (int step = 0; step < 50; ++step) tank.step(s.solver == PressureSolver::mcg03 ? 2e-4 : 5e-4);
    EXPECT_TRUE(tank.finite());
    hashes.push_back(tank.hash());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

TEST_P(EveryModel, unsorted_input_gives_the_same_fluid) {
  Tank sorted(settings()), shuffled(settings());
  sorted.walls = shuffled.walls = false;
  fill_randomly(sorted, 2000, 0.03, 9);
  std::vector<std::size_t> order(2000);
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [](std::size_t a, std::size_t b) { return mix64(a) < mix64(b); });
  for (const std::size_t i : order)
    shuffled.particles.push_back(i + 1, sorted.particles.position[i], sorted.particles.velocity[i], 1000);
  sorted.step(5e-4);
  shuffled.step(5e-4);
  const std::vector<std::size_t> a = sorted.by_id(), b = shuffled.by_id();
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(sorted.particles.id[a[i]], shuffled.particles.id[b[i]]);
    // Within a cell the order differs, so sums round differently.
    ASSERT_NEAR(sorted.particles.density[a[i]], shuffled.particles.density[b[i]], 1e-2);
    ASSERT_LT((sorted.particles.velocity[a[i]] - shuffled.particles.velocity[b[i]]).norm(), 5e-2);
  }
}

TEST_P(EveryModel, equal_input_order_gives_equal_output) {
  Tank a(settings()), b(settings());
  for (Tank* tank : {&a, &b}) {
    tank->walls = false;
    fill_randomly(*tank, 1000, 0.03, 4);
    for (int step = 0; step < 5; ++step) tank->step(2e-4);
  }
  EXPECT_EQ(a.particles.id, b.particles.id);
  EXPECT_EQ(a.hash(), b.hash());
}

TEST_P(EveryModel, coincident_particles_stay_finite) {
  Tank tank(settings());
  tank.walls = false;
  for (int i = 0; i < 1000; ++i) tank.add(Vec3(0.1, 0.2, 0.3), Vec3::Zero());
  tank.fill(6, 6, 6, 0.005, Vec3(0.09, 0.19, 0.29));
  for (int step = 0; step < 3; ++step) {
    tank.step(5e-4);
    ASSERT_TRUE(tank.finite());
  }
}

TEST_P(EveryModel, none_and_one_particle) {
  Tank tank(settings());
  tank.step(1e-3);
  EXPECT_EQ(tank.particles.size(), 0u);
  tank.add(Vec3(0.5, 0.5, 0.5), Vec3(1, 0, 0));
  tank.step(1e-3);
  EXPECT_LT((tank.particles.velocity[0] - Vec3(1, -0.00981, 0)).norm(), 1e-15);
  EXPECT_EQ(tank.particles.pressure[0], 0);
}

TEST_P(EveryModel, smoothing_dissipates_and_ends_at_the_mean) {
  FluidSettings s = settings();
  s.xsph_rate = 400;
  s.viscosity = 0;
  Tank tank(s);
  tank.walls = false;
  tank.gravity.setZero();
  tank.fill(8, 8, 8, 0.00505);  // just apart: no pressure
  for (std::size_t i = 0; i < tank.particles.size(); ++i)
    tank.particles.velocity[i] = Vec3(i % 2 ? 1e-3 : -1e-3, 0, 0);
  double last = tank.speed_sum();
  for (int step = 0; step < 20; ++step) {
    tank.step(1e-3);
    EXPECT_LE(tank.speed_sum(), last * (1 + 1e-12));
    last = tank.speed_sum();
  }
  EXPECT_LT(last, 0.2 * 512 * 1e-3);
}

FluidSettings with_smoothing_by_strain(FluidSettings s) {
  s.xsph_rate = 0;
  s.xsph_strain = 0.5;
  s.viscosity = 0;
  return s;
}

TEST_P(EveryModel, smoothing_by_strain_leaves_a_rotation_alone) {
  Tank tank(with_smoothing_by_strain(settings()));
  tank.walls = false;
  tank.gravity.setZero();
  tank.fill(8, 8, 8, 0.00505);  // just apart: no pressure
  const Vec3 middle = Vec3::Constant(4 * 0.00505), omega(3, -2, 5);
  for (std::size_t i = 0; i < tank.particles.size(); ++i)
    tank.particles.velocity[i] = omega.cross(tank.particles.position[i] - middle);
  tank.solver.prepare(tank.particles, tank.seconds);  // sorts them
  const std::vector<Vec3> before = tank.particles.velocity;
  tank.solver.propose(1e-3, tank.gravity, tank.particles, {}, {}, tank.particles.velocity, tank.report,
                      tank.seconds);
  for (std::size_t i = 0; i < tank.particles.size(); ++i)
    EXPECT_LT((tank.particles.velocity[i] - before[i]).norm(), 1e-6);
}

TEST_P(EveryModel, smoothing_by_strain_takes_a_share_that_grows_with_the_speed) {
  // Particle 0 leaves its neighbours at v: it loses Σ D w(q) min(C |v·Δ|/√(q² + 0.01) dt/dx, 1/8) v.
  const double dt = 1e-3;
  for (const double v : {0.01, 0.1, 1.0, 100.0}) {
    const FluidSettings s = with_smoothing_by_strain(settings());
    Tank tank(s);
    tank.walls = false;
    tank.gravity.setZero();
    const double d = 1.2 * s.spacing, h = s.support_ratio * s.spacing;
    tank.add(Vec3(0.5, 0.5, 0.5), Vec3(v, 0, 0));
    tank.add(Vec3(0.5 - d, 0.5, 0.5), Vec3::Zero());
    tank.add(Vec3(0.5, 0.5 + d, 0.5), Vec3::Zero());
    tank.solver.prepare(tank.particles, tank.seconds);
    tank.solver.propose(dt, tank.gravity, tank.particles, {}, {}, tank.particles.velocity, tank.report,
                        tank.seconds);
    const double q = d / h, scale = std::pow(s.spacing, 3) / lattice_density<CubicSpline>(s.support_ratio) *
                                    CubicSpline::norm / std::pow(h, 3);
    const double share = std::min(0.5 * v * q / std::sqrt(q * q + 0.01) * dt / s.spacing, 0.125);
    double fastest = 0;
    Vec3 sum = Vec3::Zero();
    for (const Vec3& u : tank.particles.velocity) {
      fastest = std::max(fastest, u.norm());
      sum += u;
    }
    EXPECT_NEAR(fastest, v * (1 - scale * CubicSpline::w(q) * share), 1e-6 * v) << v;
    EXPECT_LT((sum - Vec3(v, 0, 0)).norm(), 1e-15 * v);
  }
}

TEST_P(EveryModel, shear_decays_at_the_rate_of_the_viscosity) {
  // v_x = v0 sin(k z) in the middle of a block decays as exp(−ν k² t).
  FluidSettings s = settings();
  s.xsph_rate = 0;
  s.viscosity = 0.01;
  s.support_ratio = 3;
  s.spacing = 0.01;
  Tank tank(s);
  tank.walls = false;
  tank.gravity.setZero();
  tank.fill(12, 12, 32, 0.01005);  // just apart: no pressure
  const double k = 2 * pi / 0.16, v0 = 1e-3, dt = 1e-4;
  for (std::size_t i = 0; i < tank.particles.size(); ++i)
    tank.particles.velocity[i].x() = v0 * std::sin(k * tank.particles.position[i].z());
  tank.solver.prepare(tank.particles, tank.seconds);
  const std::vector<Vec3> before = tank.particles.velocity;
  tank.solver.propose(dt, tank.gravity, tank.particles, {}, {}, tank.particles.velocity, tank.report,
                      tank.seconds);
  double projected = 0, norm = 0;
  for (std::size_t i = 0; i < tank.particles.size(); ++i) {
    const Vec3& x = tank.particles.position[i];
    if ((x.head<2>().array() < 0.04).any() || (x.head<2>().array() > 0.08).any()) continue;
    if (x.z() < 0.08 || x.z() > 0.24) continue;  // one wave
    projected += (tank.particles.velocity[i].x() - before[i].x()) * before[i].x();
    norm += before[i].x() * before[i].x();
  }
  EXPECT_NEAR(-projected / norm / (s.viscosity * k * k * dt), 1, 0.12);
}

}  // namespace
}  // namespace oilskin::fluid
