// The path of a node over the sub-steps of a step.
#include <gtest/gtest.h>

#include <cmath>

#include "world/substeps.h"

namespace oilskin {
namespace {

using world::SurfacePaths;

/// One node on its way from 0 to (1, 0, 0).
SurfaceMotion one_node(double inverse_mass) {
  SurfaceMotion m;
  m.x_t0 = {Vec3::Zero()};
  m.x_t1 = {Vec3(1, 0, 0)};
  m.velocity = {Vec3(0.25, 0, 0)};
  m.inverse_mass = {inverse_mass};
  return m;
}

/// As contact does: resets the output, moves the node, gives an impulse.
void act(SurfaceMotion& m, const Vec3& end, const Vec3& impulse) {
  m.impulse = {impulse};
  m.velocity[0] += m.inverse_mass[0] * impulse;
  m.moved = {std::uint8_t(end != m.x_t1[0])};
  m.touched.assign(m.moved[0] != 0 || !impulse.isZero(0) ? 1 : 0, 0);
  m.x_t1[0] = end;
}

TEST(SurfacePaths, a_node_continues_from_where_it_is_to_where_the_host_wants_it) {
  SurfaceMotion m = one_node(2);
  SurfaceMotion* const surfaces[] = {&m};
  SurfacePaths paths;
  paths.begin(surfaces, 4, 1);
  paths.next();
  EXPECT_EQ(m.x_t1[0], Vec3(0.25, 0, 0));
  act(m, Vec3(0.25, 0.3, 0), Vec3(0, 1, 0));  // moved aside
  paths.next();
  EXPECT_EQ(m.x_t0[0], Vec3(0.25, 0.3, 0));
  EXPECT_TRUE(m.x_t1[0].isApprox(Vec3(0.5, 0.2, 0), 1e-15));
  EXPECT_EQ(m.velocity[0], Vec3(0.25, 2, 0));
  act(m, m.x_t0[0], Vec3(0, 0, 1));  // held
  paths.next();
  EXPECT_TRUE(m.x_t1[0].isApprox(Vec3(0.625, 0.15, 0), 1e-15));
  act(m, m.x_t1[0], Vec3::Zero());
  paths.next();
  EXPECT_EQ(m.x_t1[0], Vec3(1, 0, 0));
  act(m, m.x_t1[0], Vec3(0, 1, 0));
  paths.end();
  EXPECT_EQ(m.x_t0[0], Vec3::Zero());
  EXPECT_EQ(m.x_t1[0], Vec3(1, 0, 0));
  EXPECT_EQ(m.impulse[0], Vec3(0, 2, 1));
  EXPECT_EQ(m.velocity[0], Vec3(0.25, 4, 2));
  EXPECT_FALSE(m.moved[0]) << "it has arrived: the host need not write anything";
}

TEST(SurfacePaths, a_held_pin_catches_up_and_moved_marks_where_it_did_not) {
  SurfaceMotion m = one_node(0);
  SurfaceMotion* const surfaces[] = {&m};
  SurfacePaths paths;
  paths.begin(surfaces, 4, 1);
  paths.next();
  act(m, m.x_t0[0], Vec3(0, -1, 0));  // held
  paths.next();
  EXPECT_TRUE(m.x_t1[0].isApprox(Vec3(1.0 / 3, 0, 0), 1e-15));
  EXPECT_TRUE(m.velocity[0].isApprox(Vec3(1.0 / 3, 0, 0), 1e-15));
  act(m, m.x_t1[0], Vec3::Zero());
  paths.next();
  act(m, m.x_t1[0], Vec3::Zero());
  paths.next();
  EXPECT_EQ(m.x_t1[0], Vec3(1, 0, 0));
  act(m, m.x_t0[0], Vec3(0, -1, 0));  // held in the last one
  paths.end();
  EXPECT_TRUE(m.moved[0]);
  EXPECT_TRUE(m.x_t1[0].isApprox(Vec3(2.0 / 3, 0, 0), 1e-15));
  EXPECT_EQ(m.velocity[0], Vec3(0.25, 0, 0)) << "the host's";
  EXPECT_EQ(m.impulse[0], Vec3(0, -2, 0));
}

TEST(SurfacePaths, one_part_changes_nothing) {
  SurfaceMotion m = one_node(1);
  SurfaceMotion* const surfaces[] = {&m};
  SurfacePaths paths;
  paths.begin(surfaces, 1, 1);
  paths.next();
  EXPECT_EQ(m.x_t1[0], Vec3(1, 0, 0));
  m.impulse = {Vec3(1, 2, 3)};
  m.moved = {1};
  paths.end();
  EXPECT_EQ(m.impulse[0], Vec3(1, 2, 3));
  EXPECT_TRUE(m.moved[0]);
}

/// As contact does that finds nothing.
void find_nothing(SurfaceMotion& m) {
  m.impulse.assign(m.x_t0.size(), Vec3::Zero());
  m.moved.assign(m.x_t0.size(), 0);
  m.touched.clear();
}

/// A prescribed paddle that its host turns by 1 rad about an axle 0.4 m beside it, and shifts along the axle.
struct TurningPaddle {
  SurfaceMotion m;
  Vec3 axle{-0.4, 0, 0};
  Eigen::AngleAxisd turn{1, Vec3::UnitZ()};

  Vec3 after(double part, const Vec3& x) const {
    return axle + Eigen::AngleAxisd(part * turn.angle(), turn.axis()) * (x - axle) + Vec3(0, 0, 0.1 * part);
  }
  TurningPaddle() {
    m.id = 7;
    m.x_t0 = {Vec3(0, 0, 0), Vec3(0.2, 0, 0), Vec3(0, 0, 0.3)};
    for (const Vec3& x : m.x_t0) m.x_t1.push_back(after(1, x));
    m.inverse_mass.assign(3, 0);
    m.velocity.assign(3, Vec3(5, 0, 0));  // a belt
    find_nothing(m);
  }
};

TEST(SurfacePaths, what_turns_as_a_whole_turns_about_its_axle_in_every_part) {
  TurningPaddle paddle;
  const std::vector<Vec3> start = paddle.m.x_t0, end = paddle.m.x_t1;
  SurfaceMotion* const surfaces[] = {&paddle.m};
  SurfacePaths paths;
  paths.begin(surfaces, 4, 0.5);
  EXPECT_EQ(paths.part_before(0), nullptr);
  Vec3 impulse_moment = Vec3::Zero();
  for (int part = 0; part < 4; ++part) {
    paths.next();
    for (int i = 0; i < 3; ++i) {
      EXPECT_TRUE(paddle.m.x_t0[i].isApprox(paddle.after(part / 4.0, start[i]), 1e-13)) << part;
      EXPECT_TRUE(paddle.m.x_t1[i].isApprox(paddle.after((part + 1) / 4.0, start[i]), 1e-13)) << part;
      const Vec3 of_part = (paddle.m.x_t1[i] - paddle.m.x_t0[i]) / 0.5, of_step = (end[i] - start[i]) / 2;
      EXPECT_TRUE(paddle.m.velocity[i].isApprox(Vec3(5, 0, 0) + of_part - of_step, 1e-12));
    }
    if (part > 0) {
      ASSERT_NE(paths.part_before(0), nullptr);
      EXPECT_EQ(paths.part_before(0)->x_t1, paddle.m.x_t0);
      EXPECT_TRUE(paths.part_before(0)->x_t0[1].isApprox(paddle.after((part - 1) / 4.0, start[1]), 1e-13));
    }
    find_nothing(paddle.m);
    paddle.m.impulse[1] = Vec3(0, 1, part);
    paddle.m.touched = {1};
    impulse_moment += paddle.m.x_t0[1].cross(paddle.m.impulse[1]);
  }
  EXPECT_EQ(paddle.m.x_t1, end);
  paths.end();
  EXPECT_EQ(paddle.m.x_t0, start);
  EXPECT_EQ(paddle.m.velocity[0], Vec3(5, 0, 0));
  EXPECT_EQ(paddle.m.impulse[1], Vec3(0, 4, 6));
  EXPECT_TRUE(paddle.m.angular_impulse.isApprox(impulse_moment, 1e-14));
}

TEST(SurfacePaths, what_turns_and_is_held_goes_on_straight) {
  TurningPaddle paddle;
  const std::vector<Vec3> end = paddle.m.x_t1;
  SurfaceMotion* const surfaces[] = {&paddle.m};
  SurfacePaths paths;
  paths.begin(surfaces, 3, 1);
  paths.next();
  paddle.m.x_t1 = paddle.m.x_t0;
  paddle.m.moved.assign(3, 1);
  paddle.m.touched = {0, 1, 2};
  paths.next();
  EXPECT_EQ(paths.part_before(0), nullptr);
  EXPECT_TRUE(paddle.m.x_t1[1].isApprox(0.5 * (paddle.m.x_t0[1] + end[1]), 1e-14));
  find_nothing(paddle.m);
  paths.next();
  EXPECT_EQ(paddle.m.x_t1, end);
  paths.end();
}

/// Over the step before, the speed was that of its middle.
TEST(SurfacePaths, the_speed_before_a_turn_is_that_of_the_last_part) {
  TurningPaddle paddle;
  SurfaceMotion before;
  before.id = 7;
  for (const Vec3& x : paddle.m.x_t0) {
    before.x_t0.push_back(paddle.after(-1, x));
    before.x_t1.push_back(x);
  }
  SurfaceMotion* const surfaces[] = {&paddle.m};
  SurfacePaths paths;
  paths.begin(surfaces, 4, 0.25);
  paths.next();
  const SurfaceMotion& last = *paths.step_before(0, before, 1);
  Vec3 speed = last.x_t1[1] - last.x_t0[1],
       expected = 4 * (paddle.m.x_t0[1] - paddle.after(-0.25, paddle.m.x_t0[1]));
  EXPECT_NEAR(speed.z(), expected.z(), 1e-14);
  speed.z() = expected.z() = 0;
  EXPECT_LT(speed.cross(expected).norm(), 1e-12) << "the same direction";
  EXPECT_NEAR(speed.norm(), expected.norm(), 0.05 * expected.norm()) << "the chord of a whole step";
}

/// Two edges of a body, at right angles, that the host turns by 2 rad and moves.
struct TurningBody {
  SurfaceMotion m;
  Vec3 center{0.5, 0, 0}, center_t1{0.6, 0.3, 0};

  TurningBody() {
    const Eigen::AngleAxisd turn(2, Vec3(1, 2, 2) / 3);
    m.x_t0 = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    for (const Vec3& x : m.x_t0) m.x_t1.emplace_back(center_t1 + turn * (x - center));
    m.velocity.assign(3, Vec3::Zero());
    m.inverse_mass.assign(3, 0);
    m.body.emplace();
    m.body->center_t0 = center;
    m.body->center_t1 = center_t1;
    find_nothing(m);
  }
  void hold() {
    m.x_t1 = m.x_t0;
    m.body->center_t1 = m.body->center_t0;
    m.moved.assign(3, 1);
    m.touched = {0, 1, 2};
  }
  /// By how much lengths and arms differ from those at the start.
  double deformation() const {
    const Vec3 &a = m.x_t1[0], &b = m.x_t1[1], &c = m.x_t1[2], &o = m.body->center_t1;
    double largest = std::abs((a - o).norm() - 0.5);
    largest = std::max(largest, std::abs((b - o).norm() - 0.5));
    largest = std::max(largest, std::abs((c - o).norm() - std::sqrt(1.25)));
    largest = std::max(largest, std::abs((b - a).norm() - 1));
    return std::max(largest, std::abs((b - a).dot(c - a)));
  }
};

TEST(SurfacePaths, a_body_that_turns_keeps_its_shape_in_every_part) {
  TurningBody body;
  const std::vector<Vec3> end = body.m.x_t1;
  SurfaceMotion* const surfaces[] = {&body.m};
  SurfacePaths paths;
  paths.begin(surfaces, 4, 1);
  for (int part = 0; part < 4; ++part) {
    paths.next();
    EXPECT_LT(body.deformation(), 1e-14) << "part " << part;
    const Vec3 arm = body.m.x_t0[2] - body.m.body->center_t0;
    const Vec3 turned = Eigen::AngleAxisd(0.5, Vec3(1, 2, 2) / 3) * arm;
    EXPECT_TRUE((body.m.x_t1[2] - body.m.body->center_t1).isApprox(turned, 1e-14)) << "part " << part;
    find_nothing(body.m);
  }
  EXPECT_EQ(body.m.x_t1, end);
  EXPECT_TRUE(body.m.body->center_t1.isApprox(body.center_t1, 1e-15));
  paths.end();
  EXPECT_TRUE(body.m.touched.empty());
  EXPECT_EQ(body.m.body->center_t0, body.center);
}

TEST(SurfacePaths, a_body_that_is_held_in_the_last_part_keeps_its_shape) {
  TurningBody body;
  SurfaceMotion* const surfaces[] = {&body.m};
  SurfacePaths paths;
  paths.begin(surfaces, 3, 1);
  paths.next();
  body.hold();
  paths.next();
  find_nothing(body.m);
  const Eigen::AngleAxisd half(1, Vec3(1, 2, 2) / 3);  // it caught up in the second part
  const Vec3 center = 0.5 * (body.center + body.center_t1);
  for (int i = 0; i < 3; ++i)
    EXPECT_TRUE(body.m.x_t1[i].isApprox(center + half * (body.m.x_t0[i] - body.center), 1e-14));
  paths.next();
  body.hold();
  paths.end();
  EXPECT_LT(body.deformation(), 1e-14);
  EXPECT_EQ(body.m.moved, (std::vector<std::uint8_t>{1, 1, 1}));
}

TEST(SurfacePaths, a_body_whose_host_changes_its_shape_does_so_evenly) {
  SurfaceMotion m = TurningBody().m;
  for (Vec3& x : m.x_t1) x = m.body->center_t1 + 2 * (x - m.body->center_t1);
  SurfaceMotion* const surfaces[] = {&m};
  SurfacePaths paths;
  paths.begin(surfaces, 2, 1);
  paths.next();
  EXPECT_NEAR((m.x_t1[1] - m.x_t1[0]).norm(), 1.5, 1e-14);
  EXPECT_NEAR((m.x_t1[2] - m.x_t1[0]).norm(), 1.5, 1e-14);
}

}  // namespace
}  // namespace oilskin
