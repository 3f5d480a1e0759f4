// Impact zones that move with rigid bodies.
#include "contact/zone_body.h"

#include "bodies.h"
#include "core/body_motion.h"
#include "core/body_path.h"

namespace oilskin {
namespace {

using namespace test;

/// Zones alone separate the particles from the surfaces.
ContactReport resolve_by_zones(double dt, ParticleArrays& p, Span<SurfaceMotion* const> surfaces) {
  ParticleMotion motion = p.motion();
  ContactReport report;
  StageSeconds seconds;
  ContactSettings settings;
  settings.ccd_iterations = 0;
  settings.repulsion = Repulsion::none;
  settings.verify = true;
  EXPECT_TRUE(ContactSolver(settings).resolve(dt, motion, surfaces, report, seconds).ok());
  EXPECT_EQ(report.crossings_found_by_verify, 0u);
  EXPECT_EQ(report.removed, 0u);
  return report;
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
    const BodyPath path = path_of_body(s, displacement.data());
    EXPECT_LE((path.rotation - r).norm(), 1e-12) << "turn " << turn;
    const Vec3 x = random.in_cube(1);
    EXPECT_LE((path.end_of(x) - s.body->center_t1 - r * (x - s.body->center_t0)).norm(), 1e-12);
  }
}

TEST(BodyPath, has_the_centre_where_the_nodes_say_also_if_it_is_not_their_mean) {
  Random random(18);
  for (int turn = 0; turn < 100; ++turn) {
    MockBody body = random_body(random);
    SurfaceMotion s = surface_of(body);
    const Eigen::Matrix3d r = Eigen::AngleAxisd(random.uniform(0, 3), random.direction()).toRotationMatrix();
    const Vec3 center = s.x_t0[0] + random.in_cube(0.1), shift = random.in_cube(1);
    for (std::size_t i = 0; i < s.x_t0.size(); ++i) s.x_t1[i] = shift + r * s.x_t0[i];
    s.body->center_t1 = shift + r * center;
    EXPECT_LE((center_at_start(s) - center).norm(), 1e-12) << "turn " << turn;
  }
}

TEST(BodyPath, has_parts_that_follow_each_other) {
  Random random(19);
  for (int turn = 0; turn < 100; ++turn) {
    BodyPath path = {random.in_cube(1), random.in_cube(1), {}};
    path.rotation = Eigen::AngleAxisd(random.uniform(0, 3), random.direction()).toRotationMatrix();
    BodyPath third = path.part(1.0 / 3);
    const Vec3 x = random.in_cube(1);
    Vec3 end = x;
    for (int k = 0; k < 3; ++k) {
      end = third.end_of(end);
      third.center_t1 += third.center_t1 - third.center_t0;
      third.center_t0 += (path.center_t1 - path.center_t0) / 3;
    }
    EXPECT_LE((end - path.end_of(x)).norm(), 1e-12) << "turn " << turn;
    EXPECT_LE((path.start_of(path.end_of(x)) - x).norm(), 1e-12);
    EXPECT_LE((path.part(1).end_of(x) - path.end_of(x)).norm(), 1e-12);
    EXPECT_EQ(path.part(0).end_of(x), path.center_t0 + (x - path.center_t0));
  }
}

double kinetic_energy(const BodyMotion& b, double mass) {
  return 0.5 * (mass * b.velocity.squaredNorm() + b.angular_velocity.dot(inertia_of(b) * b.angular_velocity));
}

// Bodies down to a ten-thousandth of the points' mass. Points that took on v + ω × r with the ω from before
// made energy without bound where they had more inertia than the body.
TEST(RidingVelocity, keeps_momentum_and_makes_no_energy) {
  Random random(16);
  for (int turn = 0; turn < 200; ++turn) {
    MockBody body = random_body(random);
    body.mass = std::exp(random.uniform(-9, 3));
    SurfaceMotion s = surface_of(body);
    const bool is_locked = turn % 3 == 0;
    if (is_locked) s.body->inverse_mass.x() = 0;  // the host moves it along x
    if (turn % 6 == 0) s.body->inverse_inertia.setZero();
    const BodyMotion start = *s.body;
    ParticleArrays p = around(body, random, 6);
    const Vec3 before = momentum(p), turning = angular_momentum(p);
    const double energy_before = energy(p) + kinetic_energy(start, body.mass);
    contact::RidingVelocity common(*s.body);
    for (std::size_t i = 0; i < p.id.size(); ++i) common.add(p.inverse_mass[i], p.x_t0[i], p.velocity[i]);
    common.solve();
    for (std::size_t i = 0; i < p.id.size(); ++i) {
      const Vec3 v = common.at(p.x_t0[i]);
      push_body(*s.body, p.x_t0[i] - s.body->center_t0, -(v - p.velocity[i]) / p.inverse_mass[i]);
      p.velocity[i] = v;
    }
    const double scale = before.norm() + s.body->impulse.norm(), speed = scale / body.mass;
    EXPECT_LE((s.body->velocity - common.velocity()).norm(), 1e-12 * speed);
    EXPECT_LE((s.body->angular_velocity - common.angular_velocity()).norm(), 1e-12 * speed / 0.02);
    if (is_locked) {
      EXPECT_EQ(s.body->velocity.x(), start.velocity.x());
    } else {
      EXPECT_LE(energy(p) + kinetic_energy(*s.body, body.mass), energy_before * (1 + 1e-9))
          << "turn " << turn;
    }
    if (turn % 6 == 0) {
      EXPECT_EQ(s.body->angular_velocity, start.angular_velocity);
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
    const ContactReport report = resolve_by_zones(dt, p, surfaces);
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

/// Two bodies that turn close on particles between them. The lighter one and the particles move with the
/// heavier one: nothing is held, and momentum is kept, angular momentum too, and no energy is made. A body
/// whose axes are locked carries the other, whatever their masses.
TEST(Body, that_presses_particles_on_another_takes_both_along) {
  Random random(17);
  std::uint64_t rounds = 0;
  for (int turn = 0; turn < 60; ++turn) {
    MockBody upper = random_body(random), lower = random_body(random);
    lower.half = upper.half = Vec3::Constant(0.05);
    const Vec3 n = upper.rotation.col(1);
    lower.rotation = upper.rotation;
    lower.center = upper.center - 0.1008 * n;
    lower.mass = upper.mass * std::exp(random.uniform(-6, 6));
    upper.velocity = -2 * n + 0.2 * random.in_cube(1);
    lower.velocity = 0.2 * random.in_cube(1);
    const bool is_locked = turn % 4 == 0;
    if (is_locked) lower.free_axes = Vec3::Zero();
    if (is_locked) lower.turns = false;
    if (is_locked) lower.velocity = lower.spin = Vec3::Zero();
    const double dt = 1e-3;
    SurfaceMotion above = surface_of(upper), below = surface_of(lower);
    below.id = 2;
    const Vec3 above_t0 = above.body->center_t0, below_t0 = below.body->center_t0;
    ParticleArrays p;
    for (int k = 0; k < 5; ++k)
      p.add(upper.center - 0.0504 * n + random.uniform(-0.03, 0.03) * upper.rotation.col(0) +
                random.uniform(-0.03, 0.03) * upper.rotation.col(2),
            Vec3::Zero(), 1e-4);
    ASSERT_TRUE(upper.gather(dt, above).status.ok() && lower.gather(dt, below).status.ok());
    above.body->center_t0 = above_t0;
    below.body->center_t0 = below_t0;
    const auto turning = [&] {
      Vec3 sum = angular_momentum(p);
      for (const SurfaceMotion* s : {&above, &below})
        if (is_free(*s->body))
          sum += s->body->center_t0.cross(s->body->velocity.cwiseQuotient(s->body->inverse_mass)) +
                 inertia_of(*s->body) * s->body->angular_velocity;
      return sum;
    };
    const auto all_energy = [&] {
      return energy(p) + kinetic_energy(*above.body, upper.mass) + kinetic_energy(*below.body, lower.mass);
    };
    const Vec3 turning_before = turning();
    const double energy_before = all_energy();
    SurfaceMotion* surfaces[] = {&above, &below};
    const ContactReport report = resolve_by_zones(dt, p, surfaces);
    EXPECT_EQ(report.held, 0u) << "turn " << turn;
    rounds += report.zone_rounds;
    const double scale = upper.momentum().norm() + above.body->impulse.norm();
    const Vec3 carried = is_locked ? Vec3(-below.body->impulse) : Vec3(momentum(p) + below.body->impulse);
    if (!is_locked) {
      EXPECT_LE((above.body->impulse + carried).norm(), 1e-12 * scale);
      EXPECT_LE((turning() - turning_before).norm(), 1e-12 * scale);
    }
    EXPECT_LE(all_energy(), energy_before * (1 + 1e-9));
    // Each goes to where its nodes are.
    upper.scatter(above);
    lower.scatter(below);
    for (MockBody* body : {&upper, &lower}) {
      const SurfaceMotion& s = body == &upper ? above : below;
      EXPECT_LE((body->center - s.body->center_t1).norm(), 1e-12);
      EXPECT_LE((body->rotation * body->rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    }
    EXPECT_EQ(upper.held + lower.held, report.zone_rounds > 0 ? 1 : 0) << "one leaves its path";
  }
  EXPECT_GT(rounds, 30u) << "or the case is too easy";
}

}  // namespace
}  // namespace oilskin
