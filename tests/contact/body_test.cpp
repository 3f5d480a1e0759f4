// Impulses on dynamic rigid bodies against closed forms and conserved quantities.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/zone_body.h"
#include "support/mock_body.h"
#include "support/particle_arrays.h"
#include "support/random.h"

namespace oilskin {
namespace {

using test::MockBody;
using test::ParticleArrays;
using test::Random;

/// The body as a surface that stands where it is.
SurfaceMotion surface_of(MockBody& body, double thickness = 0.001) {
  SurfaceMotion s;
  EXPECT_TRUE(body.gather(0, s).status.ok());
  s.id = 1;
  s.thickness = thickness;
  s.delta = minimum_separation(thickness, 10, s.storage);
  s.x_t0 = s.x_t1;
  s.body->center_t0 = s.body->center_t1;
  return s;
}

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

/// Of particles on their x_t0.
Vec3 momentum(const ParticleArrays& p) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < p.id.size(); ++i) sum += p.velocity[i] / p.inverse_mass[i];
  return sum;
}
Vec3 angular_momentum(const ParticleArrays& p) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < p.id.size(); ++i) sum += p.x_t0[i].cross(p.velocity[i]) / p.inverse_mass[i];
  return sum;
}
double energy(const ParticleArrays& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.id.size(); ++i) sum += 0.5 * p.velocity[i].squaredNorm() / p.inverse_mass[i];
  return sum;
}

MockBody random_body(Random& random) {
  MockBody body;
  body.mass = std::exp(random.uniform(-3, 3));
  body.half = Vec3(random.uniform(0.02, 0.1), random.uniform(0.02, 0.1), random.uniform(0.02, 0.1));
  body.center = random.in_cube(0.3);
  body.rotation = Eigen::AngleAxisd(random.uniform(0, 6), random.direction()).toRotationMatrix();
  body.velocity = random.in_cube(1);
  body.spin = random.in_cube(5);
  return body;
}

/// Particles just outside random points of the faces, which approach.
ParticleArrays around(const MockBody& body, Random& random, int count) {
  ParticleArrays p;
  for (int k = 0; k < count; ++k) {
    Vec3 at(random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8));
    const int axis = k % 3;
    const double side = k % 2 ? 1 : -1;
    Vec3 local = at.cwiseProduct(body.half), out = Vec3::Zero();
    local[axis] = side * (body.half[axis] + 0.0005);
    out[axis] = side;
    p.add(body.center + body.rotation * local, body.velocity - 2 * (body.rotation * out) + random.in_cube(1),
          std::exp(random.uniform(-4, 1)));
  }
  p.move(1e-3);
  return p;
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

TEST(BodyPath, is_the_rotation_of_the_nodes_also_of_flat_bodies) {
  Random random(14);
  for (int turn = 0; turn < 100; ++turn) {
    MockBody body = random_body(random);
    if (turn % 2) body.half.y() = 0;
    SurfaceMotion s = surface_of(body);
    const Eigen::Matrix3d r = Eigen::AngleAxisd(random.uniform(0, 3), random.direction()).toRotationMatrix();
    s.body->center_t1 = s.body->center_t0 + random.in_cube(1);
    std::vector<Vec3> displacement;
    for (const Vec3& x : s.x_t0)
      displacement.emplace_back(s.body->center_t1 + r * (x - s.body->center_t0) - x);
    const contact::BodyPath path = contact::path_of_body(s, displacement.data());
    EXPECT_LE((path.rotation - r).norm(), 1e-12) << "turn " << turn;
    const Vec3 x = random.in_cube(1);
    EXPECT_LE((path.end_of(x) - s.body->center_t1 - r * (x - s.body->center_t0)).norm(), 1e-12);
  }
}

TEST(RidingVelocity, keeps_momentum_and_angular_momentum) {
  Random random(16);
  for (int turn = 0; turn < 50; ++turn) {
    MockBody body = random_body(random);
    SurfaceMotion s = surface_of(body);
    if (turn % 3 == 0) s.body->inverse_mass.x() = 0;  // the host moves it along x
    const Vec3 locked = s.body->velocity;
    ParticleArrays p = around(body, random, 6);
    const Vec3 before = momentum(p), turning = angular_momentum(p);
    contact::RidingVelocity common(*s.body);
    for (std::size_t i = 0; i < p.id.size(); ++i) common.add(p.inverse_mass[i], p.x_t0[i], p.velocity[i]);
    for (std::size_t i = 0; i < p.id.size(); ++i) {
      const Vec3 v = common.at(p.x_t0[i]);
      push_body(*s.body, p.x_t0[i] - s.body->center_t0, -(v - p.velocity[i]) / p.inverse_mass[i]);
      p.velocity[i] = v;
    }
    const double scale = before.norm() + s.body->impulse.norm();
    EXPECT_LE((s.body->velocity - common.value()).norm(), 1e-12 * scale / body.mass);
    if (turn % 3 == 0) {
      EXPECT_EQ(s.body->velocity.x(), locked.x());
    }
    EXPECT_LE((momentum(p) - before + s.body->impulse).norm(), 1e-13 * scale);
    EXPECT_LE(
        (angular_momentum(p) - turning + s.body->angular_impulse + s.body->center_t0.cross(s.body->impulse))
            .norm(),
        1e-13 * scale);
  }
}

/// A body that turns closes on particles that lie on a free sheet. They move on with the body, and the sheet
/// with them: nothing is held, and momentum is kept.
TEST(Body, that_presses_particles_on_a_free_sheet_takes_both_along) {
  Random random(15);
  std::uint64_t rounds = 0;
  for (int turn = 0; turn < 40; ++turn) {
    MockBody body = random_body(random);
    body.half = Vec3::Constant(0.05);
    const Vec3 n = body.rotation.col(1), u = body.rotation.col(0), w = body.rotation.col(2);
    const Vec3 foot = body.center - 0.05 * n;
    body.velocity = -2 * n + 0.2 * random.in_cube(1);
    body.spin = random.in_cube(3);
    const double dt = 1e-3;
    SurfaceMotion hull = surface_of(body);
    const Vec3 center_t0 = hull.body->center_t0;
    SurfaceMotion sheet = test::make_grid(5, 5, foot - 0.0004 * n - 0.08 * (u + w), 0.16 * u, 0.16 * w, 1e-3,
                                          0.001, 10, Storage::float64, 2);
    ParticleArrays p;
    for (int k = 0; k < 5; ++k)
      p.add(foot - 0.0002 * n + random.uniform(-0.03, 0.03) * u + random.uniform(-0.03, 0.03) * w,
            Vec3::Zero(), 1e-4);
    const auto nodes = [&] {
      Vec3 sum = Vec3::Zero();
      for (std::size_t i = 0; i < sheet.x_t0.size(); ++i) sum += sheet.velocity[i] / sheet.inverse_mass[i];
      return sum;
    };
    ASSERT_TRUE(body.gather(dt, hull).status.ok());
    hull.body->center_t0 = center_t0;
    const Vec3 before = body.momentum() + momentum(p) + nodes();
    SurfaceMotion* surfaces[] = {&hull, &sheet};
    ParticleMotion motion = p.motion();
    ContactReport report;
    StageSeconds seconds;
    ContactSettings settings;
    settings.ccd_iterations = 0;  // zones alone
    settings.repulsion = Repulsion::none;
    settings.verify = true;
    ASSERT_TRUE(ContactSolver(settings).resolve(dt, motion, surfaces, report, seconds).ok());
    EXPECT_EQ(report.crossings_found_by_verify, 0u);
    EXPECT_EQ(report.removed, 0u);
    EXPECT_EQ(report.held, 0u) << "turn " << turn;
    rounds += report.zone_rounds;
    const Vec3 pushed = hull.body->impulse;
    const double scale = before.norm() + pushed.norm();
    EXPECT_GT(pushed.norm(), 1e-6);
    EXPECT_LE((body.momentum() + pushed + momentum(p) + nodes() - before).norm(), 1e-13 * scale);
    EXPECT_LE((report.impulse_on_bodies - pushed).norm(), 1e-13 * scale);
  }
  EXPECT_GT(rounds, 20u) << "or the case is too easy";
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
