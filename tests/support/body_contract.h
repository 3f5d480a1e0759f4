/// What every host of a dynamic rigid body (SurfaceMotion::body) must do, as tests: run on the mock body and
/// on Bullet's, in float and in double.
///
/// A fixture provides:
///   World& world();                the world that the host is attached to by attach()
///   Status attach();               a box of 0.08 m and 0.3 kg, centre at the origin, with the velocity
///                                  body_velocity() and the angular velocity body_spin(), a thickness of 1 mm
///   void lock_height();            before attach(): nothing moves the body along y, nothing turns it
///   void step(double dt);          the host's own motion and the coupling
///   Vec3 velocity(), spin(), center();
///   Eigen::Matrix3d inverse_inertia();
///   SurfaceId id();
///   static constexpr bool is_double;
/// No gravity acts on the body.
#pragma once

#include "support/contract_suite.h"

namespace oilskin::test {

constexpr double body_mass = 0.3, body_half = 0.04;
inline Vec3 body_velocity() {
  return Vec3(0.1, 0.05, -0.1);
}
inline Vec3 body_spin() {
  return Vec3(3, -2, 5);
}

template <class Fixture>
class BodyContract : public ::testing::Test {
 protected:
  Fixture fixture;
  const double rounding = Fixture::is_double ? 1e-12 : 2e-6;

  Vec3 momentum() { return body_mass * fixture.velocity(); }
  /// A block beside the axis of the body, so that it turns it.
  void add_water(double speed) {
    add_block(fixture.world(), 5, Vec3(0.008, 0.09, -0.013), Vec3(0.2, -speed, 0.1));
  }
};
TYPED_TEST_SUITE_P(BodyContract);

TYPED_TEST_P(BodyContract, the_motion_of_the_nodes_is_that_of_the_body) {
  auto& host = this->fixture;
  ASSERT_TRUE(host.attach().ok());
  for (int k = 0; k < 10; ++k) {
    host.step(2e-3);
    const SurfaceMotion& m = *host.world().surface(host.id());
    ASSERT_TRUE(m.body.has_value());
    const BodyMotion& body = *m.body;
    EXPECT_LE((body.center_t1 - host.center()).norm(), this->rounding);
    EXPECT_LE((body.center_t1 - body.center_t0 - 2e-3 * body_velocity()).norm(), this->rounding);
    EXPECT_LE((body.inverse_mass - Vec3::Constant(1 / body_mass)).norm(), 10 * this->rounding);
    EXPECT_LE((body.inverse_inertia - host.inverse_inertia()).norm(),
              1e-2 * this->rounding + 1e-6 * body.inverse_inertia.norm());
    EXPECT_LE((body.inverse_inertia - body.inverse_inertia.transpose()).norm(),
              1e-12 * body.inverse_inertia.norm());
    EXPECT_EQ(body.gravity, Vec3::Zero());
    for (std::size_t i = 0; i < m.x_t1.size(); ++i) {
      const Vec3 arm = m.x_t1[i] - body.center_t1;
      EXPECT_EQ(m.inverse_mass[i], 0);
      // The interval ends with the mean velocity of the node's way, which is a chord.
      const double of_turn = 2e-3 * body.angular_velocity.squaredNorm() * arm.norm();
      EXPECT_LE((m.velocity[i] - body.velocity - body.angular_velocity.cross(arm)).norm(), of_turn);
      EXPECT_EQ(stored(m.x_t1[i], m.storage), m.x_t1[i]);
    }
  }
}

TYPED_TEST_P(BodyContract, impulses_reach_both_velocities_as_the_report_says) {
  auto& host = this->fixture;
  ASSERT_TRUE(host.attach().ok());
  World& w = host.world();
  this->add_water(1.5);
  const Vec3 start = fluid_momentum(w) + this->momentum();
  for (int k = 0; k < 60; ++k) {
    const Vec3 before = this->momentum();
    host.step(2e-3);
    ASSERT_TRUE(w.report().status.ok()) << w.report().status.message;
    EXPECT_LE(w.report().momentum_residual().norm(), 1e-10 * start.norm()) << "step " << k;
    const SurfaceMotion& m = *w.surface(host.id());
    const BodyMotion& body = *m.body;
    EXPECT_LE((this->momentum() - before - body.impulse).norm(), this->rounding * start.norm());
    EXPECT_LE((host.velocity() - body.velocity).norm(), 10 * this->rounding);
    EXPECT_LE((host.spin() - body.angular_velocity).norm(), 1e3 * this->rounding);
    EXPECT_LE((load_of(m).impulse - body.impulse).norm(), 1e-10 * start.norm()) << "no zone acted";
  }
  EXPECT_LE((fluid_momentum(w) + this->momentum() - start).norm(), 10 * this->rounding * start.norm());
  EXPECT_GT((this->momentum() - body_mass * body_velocity()).norm(), 0.1 * start.norm()) << "it was not hit";
  EXPECT_GT((host.spin() - body_spin()).norm(), 0.5) << "it was not turned";
}

TYPED_TEST_P(BodyContract, nothing_crosses_at_any_speed) {
  auto& host = this->fixture;
  ASSERT_TRUE(host.attach().ok());
  World& w = host.world();
  add_block(w, 3, Vec3(-0.02, 0.08, -0.003), Vec3(0, -3, 0));
  add_block(w, 3, Vec3(0.2, 0.01, 0.007), Vec3(-60, 0, 0));
  add_block(w, 3, Vec3(0.01, -0.4, -0.003), Vec3(0, 500, 0));
  std::uint64_t impacts = 0;
  for (int k = 0; k < 40; ++k) {
    host.step(1e-3);
    ASSERT_TRUE(w.report().status.ok());
    ASSERT_EQ(w.report().contact.crossings_found_by_verify, 0u) << "step " << k;
    ASSERT_EQ(w.report().contact.removed, 0u);
    impacts += w.report().contact.impacts;
  }
  EXPECT_GT(impacts, 0u);
}

TYPED_TEST_P(BodyContract, impulses_change_how_it_goes_on_not_where_it_is) {
  auto& host = this->fixture;
  ASSERT_TRUE(host.attach().ok());
  World& w = host.world();
  this->add_water(3);
  Vec3 center = host.center();
  int hits = 0;
  for (int k = 0; k < 60; ++k) {
    const Vec3 velocity = host.velocity();
    host.step(1e-3);
    ASSERT_EQ(w.report().flags & flag_scatter_mismatch, 0u);
    EXPECT_LE((host.center() - center - 1e-3 * velocity).norm(), this->rounding) << "step " << k;
    center = host.center();
    hits += w.surface(host.id())->body->impulse.isZero(0) ? 0 : 1;
  }
  EXPECT_GT(hits, 5);
}

TYPED_TEST_P(BodyContract, the_next_step_starts_from_what_was_certified) {
  auto& host = this->fixture;
  ASSERT_TRUE(host.attach().ok());
  World& w = host.world();
  this->add_water(2);
  std::vector<Vec3> last;
  for (int k = 0; k < 40; ++k) {
    host.step(1e-3);
    const SurfaceMotion& m = *w.surface(host.id());
    if (k > 0 && w.report().substeps == 1) {
      EXPECT_EQ(m.x_t0, last) << "step " << k;
    }
    last = m.x_t1;
  }
}

TYPED_TEST_P(BodyContract, a_locked_axis_takes_nothing_and_no_momentum_is_lost) {
  auto& host = this->fixture;
  host.lock_height();
  ASSERT_TRUE(host.attach().ok());
  World& w = host.world();
  this->add_water(2);
  const double height = host.velocity().y();
  const Vec3 spin = host.spin();
  double load = 0;
  for (int k = 0; k < 60; ++k) {
    host.step(2e-3);
    const BodyMotion& body = *w.surface(host.id())->body;
    EXPECT_EQ(body.inverse_mass.y(), 0);
    EXPECT_TRUE(body.inverse_inertia.isZero(0));
    EXPECT_LE(w.report().momentum_residual().norm(), 1e-10);
    load += body.impulse.y();
  }
  EXPECT_LT(load, -0.01) << "the reaction is told";
  EXPECT_EQ(host.velocity().y(), height);
  EXPECT_LE((host.spin() - spin).norm(), this->rounding * spin.norm());
  EXPECT_NE(host.velocity().x(), body_velocity().x());
}

REGISTER_TYPED_TEST_SUITE_P(BodyContract, the_motion_of_the_nodes_is_that_of_the_body,
                            impulses_reach_both_velocities_as_the_report_says, nothing_crosses_at_any_speed,
                            impulses_change_how_it_goes_on_not_where_it_is,
                            the_next_step_starts_from_what_was_certified,
                            a_locked_axis_takes_nothing_and_no_momentum_is_lost);

}  // namespace oilskin::test
