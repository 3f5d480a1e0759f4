// What [Akinci2012] states of boundary particles: volumes that make up for the sampling, a first layer at the
// rest density, forces in both directions, no attraction.
#include "method_helpers.h"
#include "study/comparators/boundary_samples.h"
#include "study/comparators/water_cases.h"
#include "support/record.h"

namespace oilskin::study {
namespace {

constexpr double dx = 0.005;

struct Density {
  double corrected = 0, uncorrected = 0;  // over ρ0, of a particle at a spacing from the middle of a sheet
  std::size_t samples = 0;
};

Density density_above(int cells) {
  Sheet sheet(rigid(0.08, cells));
  SurfaceSet surfaces;
  EXPECT_TRUE(surfaces.attach(sheet.host(), 0.001, nullptr).ok());
  EXPECT_TRUE(surfaces.gather(1e-3).ok());
  surfaces.begin_interval(1);
  BoundarySamples samples(dx, 2 * dx);
  samples.update(surfaces);
  Density d;
  d.samples = samples.size();
  for (std::size_t b = 0; b < samples.size(); ++b) {
    const double w = cubic_spline((samples.positions()[b] - Vec3(0, dx, 0)).norm(), 2 * dx);
    d.corrected += samples.volume(b) * w;
    d.uncorrected += dx * dx * dx * w;
  }
  return d;
}

// [Akinci2012] section 3: V_b = 1/Σ W makes the density independent of how densely a surface is sampled.
TEST(BoundaryParticles, volumes_make_up_for_the_density_of_samples) {
  const Density coarse = density_above(16), fine = density_above(64);  // cells of 5 and of 1.25 mm
  EXPECT_GT(fine.samples, 5 * coarse.samples);
  EXPECT_GT(fine.uncorrected, 5 * coarse.uncorrected);
  EXPECT_NEAR(fine.corrected, coarse.corrected, 0.05 * coarse.corrected);
  test::record("density coarse", coarse.corrected);
  test::record("density fine", fine.corrected);
}

TEST(BoundaryParticles, a_sheet_that_stretches_gets_more_samples) {
  SurfaceSet surfaces;
  Sheet small(rigid(0.08, 4)), large(rigid(0.16, 4));
  ASSERT_TRUE(surfaces.attach(small.host(), 0.001, nullptr).ok());
  BoundarySamples samples(dx, 2 * dx);
  ASSERT_TRUE(surfaces.gather(1e-3).ok());
  surfaces.begin_interval(1);
  samples.update(surfaces);
  const std::size_t before = samples.size();
  for (Vec3& x : surfaces[0].x_t0) x *= 2;
  samples.update(surfaces);
  EXPECT_GT(samples.size(), 3 * before);
  SurfaceSet other;
  ASSERT_TRUE(other.attach(large.host(), 0.001, nullptr).ok());
  ASSERT_TRUE(other.gather(1e-3).ok());
  other.begin_interval(1);
  BoundarySamples of_large(dx, 2 * dx);
  of_large.update(other);
  EXPECT_EQ(samples.size(), of_large.size());
}

/// A column at rest in a tank whose walls are a spacing from the first layer.
class SettledColumn {
 public:
  SettledColumn() : method_(make_method(Method::boundary_particles, {})), tank_(make_tank(around())) {
    EXPECT_TRUE(method_->attach(tank_).ok());
    add_water(*method_, {Vec3::Zero(), Vec3(8 * dx, 8 * dx, 8 * dx)});
    for (int k = 0; k < 300; ++k) EXPECT_TRUE(method_->step(2e-3).ok());
  }
  /// Mean density of the particles in the layer at a height of [low, high) spacings above the floor, over ρ0.
  double density(double low, double high) const {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < method_->positions().size(); ++i) {
      const double y = method_->positions()[i].y() / dx + 0.5;
      if (y >= low && y < high) sum += method_->densities()[i] / 1000, count += 1;
    }
    EXPECT_GT(count, 30);
    return sum / count;
  }

 private:
  static Box around() { return {Vec3::Constant(-0.5 * dx), Vec3(8.5 * dx, 16 * dx, 8.5 * dx)}; }
  std::unique_ptr<CouplingMethod> method_;
  demo::MockBody tank_;
};

TEST(BoundaryParticles, the_first_layer_settles_at_the_rest_density_a_spacing_from_the_floor) {
  const SettledColumn column;
  const double first = column.density(0.7, 1.5), inner = column.density(2, 5);
  EXPECT_NEAR(first, 1, 0.02);
  EXPECT_NEAR(inner, 1, 0.01);
  test::record("first layer", first);
  test::record("inner", inner);
}

// Pressures are not negative: what moves away is not held.
TEST(BoundaryParticles, water_that_leaves_does_not_stick) {
  const std::unique_ptr<CouplingMethod> method = make_method(Method::boundary_particles, weightless());
  Sheet sheet(rigid(0.08, 16));
  ASSERT_TRUE(method->attach(sheet.host()).ok());
  add_water(*method, {Vec3(-0.015, 0.5 * dx, -0.015), Vec3(0.015, 4.5 * dx, 0.015)}, Vec3(0, 0.1, 0));
  const double start = method->momentum().y();
  for (int k = 0; k < 100; ++k) {
    sheet.advance(1e-3, Vec3::Zero());
    ASSERT_TRUE(method->step(1e-3).ok());
  }
  EXPECT_GE(method->momentum().y(), start * (1 - 1e-12));
  for (const Vec3& x : method->positions()) EXPECT_GT(x.y(), 1.9 * dx);
}

/// Velocity of the centre of mass of a free sheet after a block of the same size has struck it at 0.5 m/s.
double struck(double areal_density, double& water_mass, double& sheet_mass) {
  const std::unique_ptr<CouplingMethod> method = make_method(Method::boundary_particles, weightless());
  SheetSettings shape;
  shape.size = 0.04, shape.cells = 8, shape.held = Held::none, shape.areal_density = areal_density;
  Sheet sheet(shape);
  EXPECT_TRUE(method->attach(sheet.host()).ok());
  add_water(*method, {Vec3(-0.02, 1.2 * dx, -0.02), Vec3(0.02, 5.2 * dx, 0.02)}, Vec3(0, -0.5, 0));
  for (int k = 0; k < 200; ++k) {
    sheet.advance(0.5e-3, Vec3::Zero());
    EXPECT_TRUE(method->step(0.5e-3).ok());
  }
  water_mass = method->particle_mass() * static_cast<double>(method->positions().size());
  sheet_mass = areal_density * shape.size * shape.size;
  return sheet_momentum(*method).y() / sheet_mass;
}

// Between the common velocity of an inelastic impact and twice that, the elastic one.
TEST(BoundaryParticles, a_light_sheet_is_carried_along_and_a_heavy_one_hardly_moves) {
  for (double areal_density : {2.0, 20.0, 200.0}) {
    double water = 0, sheet = 0;
    const double velocity = struck(areal_density, water, sheet);
    const double inelastic = -0.5 * water / (water + sheet);
    EXPECT_LT(velocity, 0.5 * inelastic) << areal_density;
    EXPECT_GT(velocity, 2.0 * inelastic) << areal_density;
    test::record("velocity over inelastic " + std::to_string(areal_density), velocity / inelastic);
  }
}

}  // namespace
}  // namespace oilskin::study
