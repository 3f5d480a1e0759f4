// Particles whose masses differ.
#include <gtest/gtest.h>

#include "fluid/random.h"
#include "tank.h"

namespace oilskin::fluid {
namespace {

class Masses : public testing::TestWithParam<PressureSolver> {
 protected:
  static FluidSettings settings() {
    FluidSettings s = water();
    s.solver = GetParam();
    return s;
  }
};
INSTANTIATE_TEST_SUITE_P(Fluid, Masses,
                         testing::Values(PressureSolver::mcg03, PressureSolver::pcisph,
                                         PressureSolver::dfsph),
                         [](const auto& test) { return solver_name(test.param); });

void fill_randomly(Tank& tank, std::size_t n, double size) {
  const auto random = [&](std::uint64_t k) { return 2 * random_unit(7, k) - 1; };
  for (std::size_t i = 0; i < n; ++i)
    tank.add(size * Vec3(random(6 * i), random(6 * i + 1), random(6 * i + 2)),
             Vec3(random(6 * i + 3), random(6 * i + 4), random(6 * i + 5)));
}

void set_masses(Tank& tank, float least) {
  tank.particles.let_mass_vary();
  for (std::size_t i = 0; i < tank.particles.size(); ++i)
    tank.particles.mass_ratio[i] =
        least + (1 - least) * static_cast<float>(random_unit(11, tank.particles.id[i]));
}

Vec3 momentum(const Tank& tank) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < tank.particles.size(); ++i)
    sum += tank.particles.relative_mass(i) * tank.particles.velocity[i];
  return sum;
}

TEST_P(Masses, equal_masses_give_the_same_bits_as_none) {
  std::uint64_t hash[2];
  for (const bool varies : {false, true}) {
    Tank tank(settings());
    fill_randomly(tank, 1500, 0.03);
    if (varies) tank.particles.let_mass_vary();
    for (int k = 0; k < 5; ++k) tank.step(5e-4);
    hash[varies] = tank.hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST_P(Masses, momentum_is_kept) {
  Tank tank(settings());
  fill_randomly(tank, 1500, 0.03);
  set_masses(tank, 0.01f);
  tank.walls = false;
  tank.gravity.setZero();
  const Vec3 before = momentum(tank);
  double moved = 0;
  for (const Vec3& v : tank.particles.velocity) moved += v.norm();
  for (int k = 0; k < 10; ++k) tank.step(5e-4);
  EXPECT_LE((momentum(tank) - before).norm(), 1e-13 * moved);
}

TEST_P(Masses, density_is_the_sum_of_masses) {
  // Half the mass in each particle of the lattice: half the density.
  Tank whole(settings()), half(settings());
  for (Tank* tank : {&whole, &half}) {
    tank->fill(12, 12, 12, 0.005);
    tank->walls = false;
  }
  half.particles.let_mass_vary();
  for (float& m : half.particles.mass_ratio) m = 0.5f;
  whole.step(1e-4);
  half.step(1e-4);
  for (std::size_t i = 0; i < whole.particles.size(); ++i)
    EXPECT_NEAR(half.particles.density[i], 0.5 * whole.particles.density[i], 1e-3);
}

/// Particles with little mass stand for little volume: a column of them is as high as it weighs.
TEST_P(Masses, a_column_of_mixed_masses_is_as_high_as_it_weighs) {
  if (GetParam() == PressureSolver::mcg03) GTEST_SKIP() << "compressible";
  constexpr int across = 8, layers = 12;
  const double dx = 0.005;
  double middle[2], mass[2];
  for (const bool mixed : {false, true}) {
    Tank tank(settings());
    tank.box.max = Vec3(across * dx, 1, across * dx);
    tank.fill(across, layers, across, dx);
    if (mixed) set_masses(tank, 0.3f);
    for (int k = 0; k < 800; ++k) tank.step(1e-3);
    ASSERT_LT(tank.report.density_error_mean, 0.002);
    mass[mixed] = tank.particles.sum_of_relative_masses();
    double moment = 0, speed = 0;
    for (std::size_t i = 0; i < tank.particles.size(); ++i) {
      moment += tank.particles.relative_mass(i) * tank.particles.position[i].y();
      speed = std::max(speed, tank.particles.velocity[i].norm());
    }
    middle[mixed] = moment / mass[mixed];
    EXPECT_LT(speed, 0.15);
  }
  EXPECT_NEAR(mass[1] / mass[0], 0.65, 0.02);
  EXPECT_NEAR(middle[1] / middle[0], mass[1] / mass[0], 0.05);
}

TEST_P(Masses, results_do_not_depend_on_threads) {
  std::uint64_t hash[2];
  for (int threads : {1, 2}) {
    Tank tank(settings(), threads);
    fill_randomly(tank, 1500, 0.03);
    set_masses(tank, 0.001f);
    for (int k = 0; k < 5; ++k) tank.step(5e-4);
    hash[threads - 1] = tank.hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST(MassesOfParticles, follow_their_particles) {
  Particles p;
  p.push_back(1, Vec3::Zero(), Vec3::Zero(), 1000);
  EXPECT_EQ(p.relative_mass(0), 1);
  p.let_mass_vary();
  p.push_back(2, Vec3::Zero(), Vec3::Zero(), 1000);
  p.push_back(3, Vec3::Zero(), Vec3::Zero(), 1000);
  p.mass_ratio = {0.25f, 0.5f, 0.75f};
  const std::vector<std::uint32_t> order = {2, 0, 1};
  Particles::Scratch scratch;
  p.permute(order, Workers(1), scratch);
  EXPECT_EQ(p.id[0], 3u);
  EXPECT_EQ(p.mass_ratio, (std::vector<float>{0.75f, 0.25f, 0.5f}));
  const std::vector<std::uint8_t> keep = {1, 0, 1};
  p.compress(keep);
  EXPECT_EQ(p.mass_ratio, (std::vector<float>{0.75f, 0.5f}));
  EXPECT_EQ(p.sum_of_relative_masses(), 1.25);
}

}  // namespace
}  // namespace oilskin::fluid
