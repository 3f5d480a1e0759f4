// The spring and damper of one particle, against their recursion.
#include "method_helpers.h"
#include "support/record.h"

namespace oilskin::study {
namespace {

constexpr double reach = 0.0025;  // half a spacing [m]

struct Bounce {
  double depth = 0, speed = 0, height = 0;  // when it was first found within reach, and a step later
};

/// One particle that falls on a rigid sheet at a speed, without gravity.
Bounce bounce(double speed, double dt) {
  const std::unique_ptr<CouplingMethod> method = make_method(Method::penalty, weightless());
  Sheet sheet(rigid());
  EXPECT_TRUE(method->attach(sheet.host()).ok());
  const Vec3 x(0.0013, 0.01, 0.0007), v(0, -speed, 0);
  EXPECT_TRUE(method->add_particles(Span<const Vec3>(&x, 1), Span<const Vec3>(&v, 1)).ok());
  Bounce b;
  for (int k = 0; k < 1000 && method->velocities()[0].y() < 0; ++k) {
    b.depth = reach - method->positions()[0].y();
    EXPECT_TRUE(method->step(dt).ok());
  }
  b.speed = method->velocities()[0].y();
  b.height = method->positions()[0].y();
  return b;
}

// With k = m/dt² and c = m/dt the step from depth d and velocity −v gives the velocity −v + d/dt + v = d/dt,
// and the position at the reach.
TEST(Penalty, a_particle_leaves_with_its_depth_over_the_step) {
  for (double speed : {0.1, 0.7, 2.0})
    for (double dt : {2e-4, 1e-3}) {
      const Bounce b = bounce(speed, dt);
      EXPECT_GT(b.depth, 0);
      EXPECT_NEAR(b.speed, b.depth / dt, 1e-9 * speed);
      EXPECT_NEAR(b.height, reach, 1e-12);
      EXPECT_LE(b.speed, speed * (1 + 1e-12)) << "no energy is made";
    }
}

// At rest the spring carries the weight: k d = m g, d = g dt².
TEST(Penalty, a_particle_at_rest_sinks_by_g_dt_squared) {
  const double dt = 2e-3;
  const std::unique_ptr<CouplingMethod> method = make_method(Method::penalty, {});
  Sheet sheet(rigid());
  ASSERT_TRUE(method->attach(sheet.host()).ok());
  const Vec3 x(0.0013, reach, 0.0007), v = Vec3::Zero();
  ASSERT_TRUE(method->add_particles(Span<const Vec3>(&x, 1), Span<const Vec3>(&v, 1)).ok());
  double mean = 0;
  for (int k = 0; k < 400; ++k) {
    ASSERT_TRUE(method->step(dt).ok());
    if (k >= 200) mean += method->positions()[0].y() / 200;
  }
  EXPECT_NEAR(mean, reach - 9.81 * dt * dt, 0.5 * 9.81 * dt * dt);
}

// Many particles on few light nodes: the stiffness counts all of them.
TEST(Penalty, a_crowd_on_a_light_sheet_is_not_hurled_away) {
  SheetSettings shape;
  shape.size = 0.06, shape.cells = 2, shape.held = Held::none, shape.areal_density = 0.01;
  const std::unique_ptr<CouplingMethod> method = make_method(Method::penalty, weightless());
  Sheet sheet(shape);
  ASSERT_TRUE(method->attach(sheet.host()).ok());
  add_water(*method, {Vec3(-0.02, 0.001, -0.02), Vec3(0.02, 0.021, 0.02)}, Vec3(0, -0.5, 0));
  double fastest = 0, of_sheet = 0;
  for (int k = 0; k < 60; ++k) {
    sheet.advance(1e-3, Vec3::Zero());
    ASSERT_TRUE(method->step(1e-3).ok());
    for (const Vec3& u : method->velocities()) fastest = std::max(fastest, u.norm());
    for (const Vec3& u : method->surface(0).velocity) of_sheet = std::max(of_sheet, u.norm());
  }
  test::record("water", fastest);
  test::record("sheet", of_sheet);
  // With the stiffness of each contact alone the water gets 1.4 m/s and the sheet 40 m/s.
  EXPECT_LT(fastest, 1);
  EXPECT_LT(of_sheet, 3);
}

}  // namespace
}  // namespace oilskin::study
