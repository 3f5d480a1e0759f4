// Smooth sheets: the edges between their triangles turn what slides round them and take no speed.
#include <gtest/gtest.h>

#include <cmath>

#include "support/particle_arrays.h"
#include "support/random.h"
#include "support/record.h"

namespace oilskin {
namespace {

using test::ParticleArrays;
using test::Random;

constexpr double radius = 0.07, half_width = 0.02;

/// A half pipe about the z axis of `facets` equal facets, open towards −x, and a sheet that leads to it.
SurfaceMotion half_pipe(int facets, bool smooth, double node_mass = 0) {
  SurfaceMotion s;
  s.id = 1;
  s.smooth = smooth;
  s.thickness = 0.001;
  s.delta = minimum_separation(s.thickness, 1, Storage::float64);
  const auto row = [&s](double x, double y) {
    for (double z : {-half_width, half_width}) s.x_t0.push_back({x, y, z});
  };
  row(-0.1, -radius);
  for (int k = 0; k <= facets; ++k) {
    const double angle = M_PI * k / facets;
    row(radius * std::sin(angle), -radius * std::cos(angle));
  }
  for (std::uint32_t a = 0; a + 2 < s.x_t0.size(); a += 2) {
    s.triangles.push_back({a, a + 1, a + 3});
    s.triangles.push_back({a, a + 3, a + 2});
  }
  s.x_t1 = s.x_t0;
  s.velocity.assign(s.x_t0.size(), Vec3::Zero());
  s.inverse_mass.assign(s.x_t0.size(), node_mass > 0 ? 1 / node_mass : 0);
  return s;
}

/// The speed relative to the pipe with which a particle leaves it, when the pipe moves at `frame`.
Vec3 turned(int facets, bool smooth, double speed, double dt, const Vec3& frame = Vec3::Zero()) {
  SurfaceMotion s = half_pipe(facets, smooth);
  ParticleArrays p;
  p.add({-0.05, -radius + 1.0005 * s.thickness, 0.003}, Vec3(speed, 0, 0) + frame, 1e-4);
  ContactSolver solver({}, 1);
  const int steps = static_cast<int>((0.1 + 3.3 * radius) / speed / dt);
  for (int k = 0; k < steps; ++k) {
    s.velocity.assign(s.x_t0.size(), frame);
    for (std::size_t i = 0; i < s.x_t0.size(); ++i) s.x_t1[i] = s.x_t0[i] + dt * frame;
    p.move(dt);
    ParticleMotion motion = p.motion();
    SurfaceMotion* surfaces[] = {&s};
    ContactReport report;
    EXPECT_TRUE(solver.resolve(dt, motion, surfaces, report).ok());
    p.x_t0 = p.x_t1;
    s.x_t0 = s.x_t1;
  }
  return p.velocity[0] - frame;
}

TEST(SmoothSheet, a_particle_keeps_its_speed_round_a_half_pipe_of_any_facets) {
  for (int facets : {4, 7, 12, 31})
    for (double dt : {2e-4, 1.3e-3}) {
      const double plain = turned(facets, false, 1.7, dt).norm() / 1.7;
      const double half = 0.5 * M_PI / facets;  // the angle between the first facet and the leading sheet
      const double stopped = std::cos(half) * std::pow(std::cos(2 * half), facets - 1);
      EXPECT_NEAR(plain, stopped, 0.002) << facets << " facets";
      const Vec3 v = turned(facets, true, 1.7, dt) / 1.7;
      test::record("kept by " + std::to_string(facets) + " facets", v.norm());
      EXPECT_GT(v.norm(), 0.995) << facets << " facets, " << dt << " s";
      EXPECT_LT(v.norm(), 1 + 1e-12);
      EXPECT_LT(v.x(), -0.9) << "it is turned by 180°";
    }
}

TEST(SmoothSheet, the_result_does_not_depend_on_the_frame) {
  const Vec3 at_rest = turned(9, true, 1.2, 5e-4), moving = turned(9, true, 1.2, 5e-4, {0.3, -0.7, 0.2});
  EXPECT_LT((at_rest - moving).norm(), 1e-6);
}

/// One particle against the middle of the first facet behind the leading sheet, at an angle to it.
double speed_after(double approach, bool smooth, int facets) {
  SurfaceMotion s = half_pipe(facets, smooth);
  const double slope = 0.5 * M_PI / facets;  // of the first facet
  const Vec3 along(std::cos(slope), std::sin(slope), 0), normal(-along.y(), along.x(), 0);
  ParticleArrays p;
  const Vec3 middle = 0.5 * (s.x_t0[2] + s.x_t0[4]);
  p.add({middle.x(), middle.y(), 0.001}, std::cos(approach) * along - std::sin(approach) * normal, 1e-4);
  p.x_t0[0] += s.thickness * normal;
  p.move(1e-4);
  ParticleMotion motion = p.motion();
  SurfaceMotion* surfaces[] = {&s};
  ContactReport report;
  EXPECT_TRUE(ContactSolver({}, 1).resolve(1e-4, motion, surfaces, report).ok());
  EXPECT_LE(report.kinetic_energy_change, 1e-18);
  return p.velocity[0].norm();
}

TEST(SmoothSheet, an_approach_steeper_than_the_edges_loses_what_is_steeper) {
  const double edge = M_PI / 10;  // of 10 facets
  EXPECT_NEAR(speed_after(0.5 * edge, true, 10), 1, 1e-12);
  EXPECT_NEAR(speed_after(0.5 * edge, false, 10), std::cos(0.5 * edge), 1e-12);
  for (double angle : {1.5 * edge, 1.2}) {
    const double expected = std::cos(angle) * std::hypot(1, std::tan(edge));
    EXPECT_NEAR(speed_after(angle, true, 10), expected, 1e-9);
  }
}

TEST(SmoothSheet, a_flat_sheet_and_one_with_sharp_edges_stop_as_ever) {
  // One facet stands at 90° to the leading sheet; of two, each at 45° to the next.
  for (int facets : {1, 2}) {
    const double angle = 0.2;
    const double expected = facets == 1 ? std::cos(angle) : 1;
    EXPECT_NEAR(speed_after(angle, true, facets), expected, 1e-12) << facets;
  }
}

TEST(SmoothSheet, momentum_is_exact_and_energy_never_rises_on_free_sheets) {
  Random random(5);
  ContactSolver solver({}, 1);
  for (int k = 0; k < 300; ++k) {
    const double mass = 1e-4, node_mass = mass * std::pow(10, random.uniform(-2, 2)), dt = 1e-3;
    SurfaceMotion s = half_pipe(6, true, node_mass);
    s.id = static_cast<std::uint64_t>(k) + 1;
    for (Vec3& v : s.velocity) v = random.in_cube(0.3);
    ParticleArrays p;
    for (int i = 0; i < 12; ++i) {
      const double angle = random.uniform(0, M_PI), r = (radius - 0.003) * random.uniform(0.93, 1);
      p.add({r * std::sin(angle), -r * std::cos(angle), random.uniform(-0.015, 0.015)}, random.in_cube(2),
            mass);
    }
    p.move(dt);
    for (std::size_t i = 0; i < s.x_t0.size(); ++i) s.x_t1[i] = s.x_t0[i] + dt * s.velocity[i];
    const auto momentum = [&] {
      Vec3 sum = Vec3::Zero();
      for (const Vec3& v : p.velocity) sum += mass * v;
      for (const Vec3& v : s.velocity) sum += node_mass * v;
      return sum;
    };
    const Vec3 before = momentum();
    ParticleMotion motion = p.motion();
    SurfaceMotion* surfaces[] = {&s};
    ContactReport report;
    ASSERT_TRUE(solver.resolve(dt, motion, surfaces, report).ok());
    EXPECT_LT((momentum() - before).norm(), 1e-14 * (mass + node_mass) * 100);
    EXPECT_LE(report.kinetic_energy_change, 1e-16);
  }
}

}  // namespace
}  // namespace oilskin
