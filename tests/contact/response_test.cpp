// Impulses and slip against closed forms: one particle, one triangle; k particles on one node; sliding on an
// incline.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/constraints.h"
#include "support/particle_arrays.h"
#include "support/random.h"

namespace oilskin {
namespace {

using test::ParticleArrays;
using test::Random;

SurfaceMotion one_triangle(const Vec3& a, const Vec3& b, const Vec3& c,
                           const std::array<double, 3>& inverse_mass, double thickness = 0.01) {
  SurfaceMotion s;
  s.id = 1;
  s.x_t0 = {a, b, c};
  s.x_t1 = s.x_t0;
  s.velocity.assign(3, Vec3::Zero());
  s.inverse_mass.assign(inverse_mass.begin(), inverse_mass.end());
  s.triangles = {{0, 1, 2}};
  s.thickness = thickness;
  s.delta = minimum_separation(thickness, 10, Storage::float64);
  s.holdable.assign(3, 0);
  return s;
}

struct Collision {
  double mass;
  std::array<double, 3> node_mass;  // infinity = pinned
  std::array<double, 3> weights;
  double impulse, particle_after;
  std::array<double, 3> nodes_after;
  double energy_lost;
};

const double inf = std::numeric_limits<double>::infinity();
const Collision reference_collisions[] = {
    {2, {1, 1, 1}, {1. / 3, 1. / 3, 1. / 3}, 1.2, -0.4, {-0.4, -0.4, -0.4}, 0.6},
    {2, {1, 1, 1}, {1, 0, 0}, 2. / 3, -2. / 3, {-2. / 3, 0, 0}, 1. / 3},
    {2, {1, 1, 1}, {0.5, 0.5, 0}, 1.0, -0.5, {-0.5, -0.5, 0}, 0.5},
    {1,
     {1, 2, 4},
     {0.5, 0.3, 0.2},
     0.76628352,
     -0.23371648,
     {-0.38314176, -0.11494253, -0.03831418},
     0.38314176},
    {1, {inf, 2, 4}, {0.5, 0.3, 0.2}, 0.94786730, -0.05213270, {0, -0.14218009, -0.04739336}, 0.47393365},
};

// Table of reference collisions: v_p = −1 along n, triangle at rest, stop impulse only. Also turned and
// moved.
TEST(Response, stop_impulse_matches_the_reference_collisions_in_any_frame) {
  Random random(3);
  for (const Collision& c : reference_collisions) {
    for (int turn = 0; turn < 20; ++turn) {
      Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
      Vec3 shift = Vec3::Zero();
      if (turn > 0) {
        rotation = Eigen::AngleAxisd(random.uniform(0, 6), random.direction()).toRotationMatrix();
        shift = random.in_cube(2);
      }
      const auto place = [&](const Vec3& x) { return Vec3(rotation * x + shift); };
      std::array<double, 3> u{};
      for (int k = 0; k < 3; ++k) u[k] = 1 / c.node_mass[k];
      SurfaceMotion s = one_triangle(place({0, 0, 0}), place({1, 0, 0}), place({0, 0, 1}), u);
      const Vec3 n = rotation * Vec3(0, 1, 0);
      const Vec3 foot = c.weights[0] * s.x_t0[0] + c.weights[1] * s.x_t0[1] + c.weights[2] * s.x_t0[2];
      ParticleArrays p;
      p.add(foot + 0.005 * n, -n, c.mass);
      p.move(1e-4);
      ParticleMotion motion = p.motion();
      SurfaceMotion* surfaces[] = {&s};
      ContactSettings settings;
      settings.solver_iterations = 1;
      settings.repulsion = Repulsion::none;
      ContactSolver solver(settings, 1);
      ContactReport report;
      StageSeconds seconds;
      ASSERT_TRUE(solver.resolve(1e-4, motion, surfaces, report, seconds).ok());
      const double tolerance =
          c.impulse == 1.2 || c.weights[2] == 0 ? 1e-13 : 1e-8;  // the table has 8 digits
      EXPECT_NEAR(p.velocity[0].dot(n), c.particle_after, tolerance);
      Vec3 impulse_on_nodes = Vec3::Zero();
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(s.velocity[k].dot(n), c.nodes_after[k], tolerance);
        EXPECT_NEAR((s.velocity[k] - s.velocity[k].dot(n) * n).norm(), 0,
                    2e-13);  // n is a difference of 5 mm at 2 m
        impulse_on_nodes += s.impulse[k];
      }
      // −J in total, the pin's share included: reactions are recorded.
      EXPECT_NEAR(impulse_on_nodes.dot(n), -c.impulse, tolerance);
      EXPECT_NEAR(-report.kinetic_energy_change, c.energy_lost, tolerance);
    }
  }
}

TEST(Response, stop_impulse_matches_the_closed_form_to_fourteen_digits) {
  Random random(5);
  for (int k = 0; k < 2000; ++k) {
    SurfaceMotion s = one_triangle({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 0, 0});
    for (double& u : s.inverse_mass) u = random.uniform() < 0.2 ? 0 : random.log_uniform(1e-3, 1e3);
    const double wb = random.uniform(0.1, 0.4), wc = random.uniform(0.1, 0.4);
    const std::array<double, 3> w{1 - wb - wc, wb, wc};
    ParticleArrays p;
    p.add({wb, 0.005, wc}, random.in_cube(1) - Vec3(0, 2, 0), random.log_uniform(1e-3, 1e3));
    for (Vec3& v : s.velocity) v = random.in_cube(0.1);
    for (int i = 0; i < 3; ++i)
      if (s.inverse_mass[i] == 0) s.velocity[i].setZero();
    double vn = p.velocity[0].y(), effective = p.inverse_mass[0];
    for (int i = 0; i < 3; ++i) vn -= w[i] * s.velocity[i].y(), effective += w[i] * w[i] * s.inverse_mass[i];
    const double expected = p.velocity[0].y() - vn / effective * p.inverse_mass[0];
    double energy = 0.5 * p.velocity[0].squaredNorm() / p.inverse_mass[0];
    for (int i = 0; i < 3; ++i)
      if (s.inverse_mass[i] > 0) energy += 0.5 * s.velocity[i].squaredNorm() / s.inverse_mass[i];
    p.move(1e-5);
    ParticleMotion motion = p.motion();
    SurfaceMotion* surfaces[] = {&s};
    ContactSettings settings;
    settings.repulsion = Repulsion::none;
    ContactReport report;
    StageSeconds seconds;
    ASSERT_TRUE(ContactSolver(settings, 1).resolve(1e-5, motion, surfaces, report, seconds).ok());
    EXPECT_NEAR(p.velocity[0].y(), expected, 1e-14 * std::max(1.0, std::abs(vn)) * 4);
    EXPECT_NEAR(-report.kinetic_energy_change, 0.5 * vn * vn / effective, 1e-13 * energy);
  }
}

// k equal particles hit one free node at once: the converged answer is −k m v/(M + k m), in any order.
TEST(Response, simultaneous_impacts_converge_to_the_inelastic_solution_in_any_order) {
  const int k = 64;
  const double m = 1, mass = 64;  // k m = M: the one-sweep answer is 26 % too fast
  for (bool reversed : {false, true}) {
    for (int solver_iterations : {1, 5, 200}) {
      SurfaceMotion s = one_triangle({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1 / mass, 0, 0});
      ParticleArrays p;
      for (int i = 0; i < k; ++i) {
        const double angle = 2 * M_PI * (reversed ? k - 1 - i : i) / k;
        // outside the corner, so that the vertex alone is the closest feature
        const Vec3 away = Vec3(-1 - 0.5 * std::cos(angle), 0, -1 - 0.5 * std::sin(angle)) * 1e-9;
        p.add(away + Vec3(0, 0.005, 0), {0, -1, 0}, m);
      }
      p.move(1e-4);
      ParticleMotion motion = p.motion();
      SurfaceMotion* surfaces[] = {&s};
      ContactSettings settings;
      settings.solver_iterations = solver_iterations;
      settings.repulsion = Repulsion::none;
      ContactReport report;
      StageSeconds seconds;
      ASSERT_TRUE(ContactSolver(settings, 1).resolve(1e-4, motion, surfaces, report, seconds).ok());
      const double expected = -k * m / (mass + k * m);
      const double got = s.velocity[0].y();
      if (solver_iterations == 1) {
        EXPECT_NEAR(got / expected, 1.259, 0.005) << "one sweep is known to be order dependent";
      } else {
        EXPECT_NEAR(got, expected, solver_iterations == 5 ? 0.05 : 1e-8);
      }
    }
  }
}

struct Slide {
  SlipModel model;
  double friction, degrees, expected;  // acceleration along the incline [m/s²]
};

class Incline : public ::testing::TestWithParam<Slide> {};

// A particle on a pinned flat sheet at an angle, over many inner edges.
TEST_P(Incline, particle_accelerates_as_the_law_says) {
  const Slide c = GetParam();
  const double angle = c.degrees * M_PI / 180, dt = 1e-3, mass = 1.25e-4;
  const Vec3 down(std::cos(angle), -std::sin(angle), 0), normal(std::sin(angle), std::cos(angle), 0);
  SurfaceMotion s =
      test::make_grid(101, 11, Vec3(0, 0, -0.05), 2 * down, Vec3(0, 0, 0.1), 0, 0.001, 4, Storage::float64);
  s.slip.model = c.model;
  s.slip.friction = c.friction;
  ParticleArrays p;
  p.add(s.x_t0[0] + Vec3(0, 0, 0.0513) + 0.1 * down + 0.001 * normal, Vec3::Zero(), mass);
  SurfaceMotion* surfaces[] = {&s};
  ContactSolver solver(ContactSettings{}, 1);
  const Vec3 gravity(0, -9.81, 0);
  double speed_at_100 = 0, normal_impulse = 0;
  const int steps = 500;
  for (int k = 0; k < steps; ++k) {
    p.velocity[0] += dt * gravity;
    p.move(dt);
    ParticleMotion motion = p.motion();
    ContactReport report;
    StageSeconds seconds;
    ASSERT_TRUE(solver.resolve(dt, motion, surfaces, report, seconds).ok());
    if (k == 100) speed_at_100 = p.velocity[0].dot(down);
    normal_impulse = -report.impulse_on_prescribed.dot(normal);
    p.x_t0 = p.x_t1;
    const double height = (p.x_t0[0] - s.x_t0[0]).dot(normal);
    EXPECT_NEAR(height, 0.001, 1e-6) << "step " << k;
  }
  const double acceleration = (p.velocity[0].dot(down) - speed_at_100) / ((steps - 1 - 100) * dt);
  EXPECT_NEAR(acceleration, c.expected, 1e-6 * 9.81);
  EXPECT_NEAR(normal_impulse, mass * 9.81 * std::cos(angle) * dt, 1e-9 * mass * 9.81 * dt);
}

INSTANTIATE_TEST_SUITE_P(
    Laws, Incline,
    ::testing::Values(Slide{SlipModel::free, 0, 30, 4.905},
                      Slide{SlipModel::coulomb, 0.3, 30, 9.81 * (0.5 - 0.3 * std::sqrt(0.75))},
                      Slide{SlipModel::coulomb, 1, 30, 0},
                      Slide{SlipModel::coulomb, 1, 60, 9.81 * (std::sqrt(0.75) - 0.5)},
                      Slide{SlipModel::coulomb, std::numeric_limits<double>::infinity(), 60, 0},
                      Slide{SlipModel::sticking, 0, 30, 0}));

TEST(Response, viscous_wall_slows_by_its_implicit_law_and_never_reverses) {
  for (double viscosity : {1e-6, 1e-3, 1.0, 1e3}) {
    SurfaceMotion s = one_triangle({-1, 0, -1}, {1, 0, -1}, {0, 0, 1}, {0, 0, 0}, 0.001);
    s.slip.model = SlipModel::viscous_wall;
    ParticleArrays p;
    const double mass = 1.25e-4, dt = 1e-3, z = 0.001;
    p.add({0, z, 0}, {1, 0, 0}, mass);
    p.move(dt);
    ParticleMotion motion = p.motion(0.005);
    motion.viscosity = viscosity;
    SurfaceMotion* surfaces[] = {&s};
    ContactReport report;
    StageSeconds seconds;
    ASSERT_TRUE(ContactSolver(ContactSettings{}, 1).resolve(dt, motion, surfaces, report, seconds).ok());
    const double drag = viscosity * 1000 * 0.005 * 0.005 / std::max(z, 0.005 / 4);
    EXPECT_NEAR(p.velocity[0].x(), 1 / (1 + dt * drag / mass), 1e-12);
  }
}

TEST(Response, split_repulsion_removes_a_tenth_of_the_overlap_and_adds_no_velocity) {
  for (int count : {1, 25}) {
    SurfaceMotion s = one_triangle({-1, 0, -1}, {1, 0, -1}, {0, 0, 1}, {1e5, 1e5, 1e5}, 0.01);
    ParticleArrays p;
    for (int k = 0; k < count; ++k) p.add({1e-4 * k, 0.004, 0}, Vec3::Zero(), 1.25e-4);
    ParticleMotion motion = p.motion();
    SurfaceMotion* surfaces[] = {&s};
    ContactSettings settings;
    settings.solver_iterations = 200;
    ContactReport report;
    StageSeconds seconds;
    ASSERT_TRUE(ContactSolver(settings, 1).resolve(1e-3, motion, surfaces, report, seconds).ok());
    for (int k = 0; k < count; ++k) {
      const double x = 1e-4 * k;  // weights of the point (x, 0) in the triangle (−1, −1), (1, −1), (0, 1)
      const Vec3 foot = (0.25 - x / 2) * s.x_t1[0] + (0.25 + x / 2) * s.x_t1[1] + 0.5 * s.x_t1[2];
      EXPECT_NEAR(p.x_t1[k].y() - foot.y(), 0.0046, 2e-5) << count << " particles";
      EXPECT_EQ(p.velocity[k], Vec3::Zero());
    }
    EXPECT_NEAR(report.kinetic_energy_change, 0, 1e-20);
  }
}

TEST(Response, bridson_repulsion_is_capped_whatever_its_stiffness) {
  SurfaceMotion s = one_triangle({-1, 0, -1}, {1, 0, -1}, {0, 0, 1}, {0, 0, 0}, 0.01);
  ParticleArrays p;
  p.add({0, 0.004, 0}, {0, -3, 0}, 1.25e-4);
  p.move(1e-3);
  ParticleMotion motion = p.motion();
  SurfaceMotion* surfaces[] = {&s};
  ContactSettings settings;
  settings.repulsion = Repulsion::bridson;
  settings.stiffness = 1e9;
  ContactReport report;
  StageSeconds seconds;
  ASSERT_TRUE(ContactSolver(settings, 1).resolve(1e-3, motion, surfaces, report, seconds).ok());
  EXPECT_NEAR(p.velocity[0].y(), 0.1 * 0.006 / 1e-3, 1e-12);
}

TEST(Response, nodes_that_must_not_be_moved_get_impulses_as_velocity_only) {
  SurfaceMotion s = one_triangle({-1, 0, -1}, {1, 0, -1}, {0, 0, 1}, {1e3, 1e3, 1e3}, 0.01);
  s.nodes_movable = false;
  const std::vector<Vec3> proposed = s.x_t1;
  ParticleArrays p;
  p.add({0, 0.004, 0}, {0, -1, 0}, 1.25e-4);
  p.move(1e-3);
  ParticleMotion motion = p.motion();
  SurfaceMotion* surfaces[] = {&s};
  ContactReport report;
  StageSeconds seconds;
  ASSERT_TRUE(ContactSolver(ContactSettings{}, 1).resolve(1e-3, motion, surfaces, report, seconds).ok());
  EXPECT_EQ(s.x_t1, proposed);
  EXPECT_LT(s.velocity[0].y(), -0.02);
  EXPECT_NEAR(p.x_t1[0].y(), 0.0046, 1e-12) << "the particle takes all of the displacement";
}

TEST(Response, pinned_triangle_and_immovable_particle_have_no_effective_mass_and_no_division) {
  SurfaceMotion s = one_triangle({-1, 0, -1}, {1, 0, -1}, {0, 0, 1}, {0, 0, 0}, 0.01);
  ParticleArrays p;
  p.add({0, 0.004, 0}, Vec3::Zero(), 0);
  ParticleMotion motion = p.motion();
  SurfaceMotion* surfaces[] = {&s};
  ContactReport report;
  StageSeconds seconds;
  ASSERT_TRUE(ContactSolver(ContactSettings{}, 1).resolve(1e-3, motion, surfaces, report, seconds).ok());
  EXPECT_EQ(p.x_t1[0], Vec3(0, 0.004, 0));
  EXPECT_TRUE(p.velocity[0].isZero(0));
}

}  // namespace
}  // namespace oilskin
