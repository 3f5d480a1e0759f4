// What [Macklin2013] states of position based fluids: constant density, conserved momentum, stability at the
// steps of games.
#include "method_helpers.h"
#include "study/comparators/neighbour_lists.h"
#include "study/comparators/water_cases.h"
#include "support/record.h"

namespace oilskin::study {
namespace {

std::unique_ptr<CouplingMethod> compressed_block() {
  std::unique_ptr<CouplingMethod> method = make_method(Method::position_based, weightless());
  add_water(*method, {Vec3::Zero(), Vec3::Constant(0.04)}, Vec3::Zero(), 0.0047);  // rest: 0.005
  return method;
}

/// Density of the particles in the middle where they are now, over ρ0.
double inner_density(const CouplingMethod& method) {
  const Span<const Vec3> x = method.positions();
  double sum = 0, count = 0;
  for (const Vec3& a : x) {
    if ((a - Vec3::Constant(0.0188)).cwiseAbs().maxCoeff() > 0.009) continue;
    for (const Vec3& b : x) sum += method.particle_mass() / 1000 * poly6((a - b).norm(), 0.01);
    count += 1;
  }
  return sum / count;
}

// Eq. 11 and 12: the iterations remove a compression of 20 %, in pairs of equal and opposite corrections.
TEST(PositionBased, compression_vanishes_within_a_step_and_momentum_is_kept) {
  const std::unique_ptr<CouplingMethod> method = compressed_block();
  const double before = inner_density(*method);
  EXPECT_GT(before, 1.15);
  ASSERT_TRUE(method->step(4e-3).ok());
  EXPECT_NEAR(inner_density(*method), 1, 0.05);
  EXPECT_LT(method->momentum().norm(), 1e-13);
  test::record("density before", before);
  test::record("density after a step", inner_density(*method));
}

// Abstract: large steps are stable.
TEST(PositionBased, the_largest_speed_does_not_grow_at_a_step_of_a_frame) {
  const std::unique_ptr<CouplingMethod> method = compressed_block();
  double limit = 0;
  for (int k = 0; k < 30; ++k) {
    ASSERT_TRUE(method->step(1.0 / 60).ok());
    double fastest = 0;
    for (const Vec3& v : method->velocities()) fastest = std::max(fastest, v.norm());
    if (k == 0) limit = fastest;
    ASSERT_LE(fastest, limit * (1 + 1e-9)) << "step " << k;
  }
  EXPECT_LT(limit, 2) << "a spacing a step is 0.3 m/s";
}

TEST(PositionBased, a_dam_break_keeps_density_and_makes_no_energy) {
  DamCase dam;
  dam.method = Method::position_based, dam.dt = 4e-3;
  const DamResult result = run(dam);
  EXPECT_LT(result.density_error, 0.015);
  EXPECT_LT(result.largest_density, 1.08) << "the densest tenth";
  EXPECT_LE(result.energy_gain, 0);
  EXPECT_LT(result.front_error, 0.1);
  test::record("mean compression", result.density_error);
}

TEST(PositionBased, a_particle_found_within_its_radius_ends_at_the_radius) {
  const std::unique_ptr<CouplingMethod> method = make_method(Method::position_based, weightless());
  Sheet sheet(rigid());
  ASSERT_TRUE(method->attach(sheet.host()).ok());
  const Vec3 x(0.0013, 0.003, 0.0007), v(0.2, -1, 0);
  ASSERT_TRUE(method->add_particles(Span<const Vec3>(&x, 1), Span<const Vec3>(&v, 1)).ok());
  ASSERT_TRUE(method->step(1e-3).ok());
  EXPECT_NEAR(method->positions()[0].y(), 0.0025, 1e-12);
  EXPECT_NEAR(method->velocities()[0].y(), (0.0025 - 0.003) / 1e-3, 1e-9);
  EXPECT_NEAR(method->velocities()[0].x(), 0.2, 1e-12) << "no friction";
}

}  // namespace
}  // namespace oilskin::study
