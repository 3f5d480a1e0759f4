// Impulses on dynamic rigid bodies against closed forms and conserved quantities.
#include <gtest/gtest.h>

#include <cmath>

#include "bodies.h"

namespace oilskin {
namespace {

using namespace test;

struct Hit {
  ContactReport report;
  ParticleArrays particles;
  SurfaceMotion surface;
};

Hit resolve(MockBody& body, const ParticleArrays& particles, const SlipSettings& slip = {}, double dt = 1e-3,
            const ContactSettings& settings = {}) {
  Hit hit;
  hit.particles = particles;
  hit.surface = surface_of(body);
  hit.surface.slip = slip;
  SurfaceMotion* surfaces[] = {&hit.surface};
  ParticleMotion motion = hit.particles.motion();
  StageSeconds seconds;
  const Status status = ContactSolver(settings).resolve(dt, motion, surfaces, hit.report, seconds);
  EXPECT_TRUE(status.ok()) << status.message;
  body.scatter(hit.surface);
  return hit;
}

TEST(Body, a_hit_beside_the_centre_turns_it_as_the_closed_form_says) {
  Random random(11);
  for (int turn = 0; turn < 50; ++turn) {
    MockBody body = random_body(random);
    body.velocity.setZero();
    body.spin.setZero();
    const Vec3 n = body.rotation.col(1);
    const Vec3 foot =
        body.center + body.rotation * Vec3(0.5 * body.half.x(), body.half.y(), 0.3 * body.half.z());
    const double mass = 0.3;
    ParticleArrays p;
    p.add(foot + 0.0005 * n, -n, mass);
    p.move(1e-3);
    const Vec3 r = foot - body.center, lever = r.cross(n);
    const double k = 1 / mass + 1 / body.mass + lever.dot(body.inverse_inertia() * lever);
    const Vec3 spin = body.inverse_inertia() * (-1 / k * lever);
    ContactSettings settings;
    settings.solver_iterations = 1;
    const Hit hit = resolve(body, p, {}, 1e-3, settings);
    EXPECT_NEAR(hit.particles.velocity[0].dot(n), -1 + 1 / k / mass, 1e-12);
    EXPECT_LE((body.velocity + n / k / body.mass).norm(), 1e-12);
    EXPECT_LE((body.spin - spin).norm(), 1e-11 * (1 + spin.norm()));
  }
}

TEST(Body, linear_and_angular_momentum_are_kept_and_energy_never_rises) {
  Random random(12);
  for (int turn = 0; turn < 200; ++turn) {
    MockBody body = random_body(random);
    const ParticleArrays p = around(body, random, 12);
    SlipSettings slip;
    const SlipModel models[] = {SlipModel::free, SlipModel::coulomb, SlipModel::sticking};
    slip.model = models[turn % 3];
    slip.friction = 0.5;
    const Vec3 before = momentum(p) + body.momentum();
    const Vec3 turning = angular_momentum(p) + body.angular_momentum();
    const double start = energy(p) + body.kinetic_energy();
    const Hit hit = resolve(body, p, slip);
    const double scale = before.norm() + hit.surface.body->impulse.norm();
    EXPECT_GT(hit.surface.body->impulse.norm(), 1e-3);
    EXPECT_LE((momentum(hit.particles) + body.momentum() - before).norm(), 1e-13 * scale);
    // A tangential impulse acts at the particle and at the sheet, which are up to the thickness apart.
    const double lever = slip.model == SlipModel::free ? 1e-13 : 0.001;
    EXPECT_LE((angular_momentum(hit.particles) + body.angular_momentum() - turning).norm(), lever * scale);
    const double change = energy(hit.particles) + body.kinetic_energy() - start;
    EXPECT_LE(change, 1e-12 * start) << "turn " << turn;
    EXPECT_NEAR(hit.report.kinetic_energy_change, change, 1e-11 * start);
    EXPECT_LE((hit.report.impulse_on_bodies - hit.surface.body->impulse).norm(), 1e-13 * scale);
    EXPECT_TRUE(hit.report.impulse_on_prescribed.isZero(0));
  }
}

TEST(Body, nothing_approaches_after_enough_sweeps) {
  Random random(13);
  for (int turn = 0; turn < 50; ++turn) {
    MockBody body = random_body(random);
    const ParticleArrays p = around(body, random, 12);
    ContactSettings settings;
    settings.solver_iterations = 1000;
    const Hit hit = resolve(body, p, {}, 1e-3, settings);
    for (std::size_t i = 0; i < p.id.size(); ++i) {
      const int axis = static_cast<int>(i) % 3;
      const Vec3 out = (i % 2 ? 1 : -1) * body.rotation.col(axis);
      const Vec3 foot = p.x_t0[i] - 0.0005 * out;
      const Vec3 of_body = body.velocity + body.spin.cross(foot - body.center);
      EXPECT_GE((hit.particles.velocity[i] - of_body).dot(out), -1e-6)
          << "turn " << turn << ", particle " << i;
    }
  }
}

TEST(Body, locked_axes_take_nothing_and_their_support_the_rest) {
  MockBody body;
  body.free_axes = Vec3(1, 0, 1);
  ParticleArrays p;
  p.add(Vec3(0.01, 0.0505, 0), Vec3(0.3, -1, 0), 0.1);
  p.move(1e-3);
  SlipSettings slip;
  slip.model = SlipModel::sticking;
  const Hit hit = resolve(body, p, slip);
  EXPECT_EQ(body.velocity.y(), 0);
  EXPECT_GT(body.velocity.x(), 0);
  EXPECT_EQ(hit.report.impulse_on_bodies.y(), 0);
  EXPECT_LT(hit.report.impulse_on_prescribed.y(), -0.01);
  EXPECT_NEAR(hit.report.impulse_on_bodies.x() + momentum(hit.particles).x(), 0.03, 1e-15);
}

TEST(Body, numbers_that_make_no_sense_are_refused) {
  const auto refusal = [](const auto& spoil) {
    MockBody body;
    SurfaceMotion s = surface_of(body);
    spoil(s);
    ParticleArrays p;
    p.add(Vec3(0, 1, 0), Vec3::Zero(), 1);
    ParticleMotion motion = p.motion();
    SurfaceMotion* surfaces[] = {&s};
    ContactReport report;
    StageSeconds seconds;
    return ContactSolver(ContactSettings()).resolve(1e-3, motion, surfaces, report, seconds).message;
  };
  EXPECT_EQ(refusal([](SurfaceMotion&) {}), "");
  EXPECT_NE(refusal([](SurfaceMotion& s) { s.body->velocity.x() = NAN; }), "");
  EXPECT_NE(refusal([](SurfaceMotion& s) { s.body->center_t1.y() = 1e16; }), "");
  EXPECT_NE(refusal([](SurfaceMotion& s) { s.body->inverse_mass.z() = -1; }), "");
  EXPECT_NE(refusal([](SurfaceMotion& s) { s.body->inverse_inertia(0, 1) = 7; }), "");
  EXPECT_NE(refusal([](SurfaceMotion& s) { s.body->inverse_inertia(2, 2) = -1; }), "");
  EXPECT_NE(refusal([](SurfaceMotion& s) { s.body->inverse_inertia(0, 0) = INFINITY; }), "");
  EXPECT_NE(refusal([](SurfaceMotion& s) { s.inverse_mass[3] = 1; }), "");
}

/// Closes on particles over a prescribed floor from above.
TEST(Body, that_falls_on_particles_on_a_floor_waits_and_crushes_none) {
  MockBody body;
  body.center = Vec3(0, 0.0503, 0);
  body.mass = 50;
  SurfaceMotion hull = surface_of(body), floor = hull;
  floor.body.reset();
  floor.id = 2;
  floor.triangles = {{0, 1, 2}, {1, 3, 2}};
  floor.x_t0 = {Vec3(-1, 0, -1), Vec3(1, 0, -1), Vec3(-1, 0, 1), Vec3(1, 0, 1)};
  floor.x_t1 = floor.x_t0;
  floor.velocity.assign(4, Vec3::Zero());
  floor.inverse_mass.assign(4, 0);
  floor.holdable.assign(4, 0);
  ParticleArrays p;
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j)
      p.add(Vec3(-0.02 + 0.005 * i, 0.00015, -0.02 + 0.005 * j), Vec3::Zero(), 1e-4);
  body.velocity = Vec3(0, -2, 0);
  body.spin = Vec3(0, 0, 0.5);
  SurfaceMotion moved = hull;
  ASSERT_TRUE(body.gather(1e-3, moved).status.ok());
  moved.body->center_t0 = hull.body->center_t0;
  SurfaceMotion* surfaces[] = {&moved, &floor};
  ParticleMotion motion = p.motion();
  ContactReport report;
  StageSeconds seconds;
  ContactSettings settings;
  settings.verify = true;
  ASSERT_TRUE(ContactSolver(settings).resolve(1e-3, motion, surfaces, report, seconds).ok());
  EXPECT_EQ(report.crossings_found_by_verify, 0u);
  EXPECT_EQ(report.removed, 0u);
  EXPECT_EQ(moved.x_t1, hull.x_t0) << "it would touch the floor";
  EXPECT_EQ(moved.body->center_t1, hull.body->center_t0);
  EXPECT_GE(report.held, 1u);
}

}  // namespace
}  // namespace oilskin
