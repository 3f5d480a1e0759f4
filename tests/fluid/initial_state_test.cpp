// Fields of velocities and displacements, and shaken starts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/archive.h"
#include "fluid/emission/emission.h"
#include "support/random.h"

namespace oilskin::fluid {
namespace {

constexpr double dx = 0.005, mass = 1000 * dx * dx * dx;

/// The gradient at x by central differences.
Eigen::Matrix3d gradient(const VectorField& f, const Vec3& x) {
  constexpr double step = 1e-6;
  Eigen::Matrix3d g;
  for (int k = 0; k < 3; ++k)
    g.col(k) = (f(x + step * Vec3::Unit(k)) - f(x - step * Vec3::Unit(k))) / (2 * step);
  return g;
}

Vec3 curl(const Eigen::Matrix3d& g) {
  return {g(2, 1) - g(1, 2), g(0, 2) - g(2, 0), g(1, 0) - g(0, 1)};
}

TEST(VectorFields, rotation_is_solid) {
  const VectorField f = rotation_field(Vec3(1, 2, 3), Vec3(0, 0, 5), 2);
  EXPECT_EQ(f(Vec3(1, 2, 9)), Vec3::Zero());
  EXPECT_LT((f(Vec3(2, 2, 3)) - Vec3(0, 2, 0)).norm(), 1e-15);
  EXPECT_LT((curl(gradient(f, Vec3(7, 8, 9))) - Vec3(0, 0, 4)).norm(), 1e-8);
}

TEST(VectorFields, linear_is_its_gradient) {
  Eigen::Matrix3d g;
  g << 1, 2, 3, 4, 5, 6, 7, 8, 10;
  EXPECT_LT((gradient(linear_field(Vec3(1, 1, 1), g), Vec3(3, 2, 1)) - g).norm(), 1e-8);
}

TEST(VectorFields, taylor_green_fills_its_rectangle_without_divergence) {
  const Vec3 corner(0.1, 0.2, 0.3), u(0, 0.3, 0.4), v(0.2, 0, 0);
  const VectorField f = taylor_green_field(corner, u, v, 0.7);
  test::Random random(1);
  for (int k = 0; k < 50; ++k) {
    const double a = random.uniform(), b = random.uniform();
    EXPECT_NEAR(gradient(f, corner + a * u + b * v).trace(), 0, 1e-8);
    EXPECT_NEAR(f(corner + b * v).dot(u), 0, 1e-15) << "nothing through the edges";
    EXPECT_NEAR(f(corner + u + b * v).dot(u), 0, 1e-15);
    EXPECT_NEAR(f(corner + a * u).dot(v), 0, 1e-15);
    EXPECT_NEAR(f(corner + a * u + v).dot(v), 0, 1e-15);
  }
  EXPECT_NEAR(f(corner + 0.5 * u).dot(u.normalized()), 0.7, 1e-15);
  EXPECT_NEAR(f(corner + 0.5 * v).norm(), 0.7 * 0.2 / 0.5, 1e-15);
}

TEST(VectorFields, standing_wave_is_the_linear_mode) {
  StandingWave w;
  w.origin = Vec3(1, 2, 3);
  w.along = Vec3(0, 0, 2);
  w.wavelength = 0.4;
  w.depth = 0.1;
  w.amplitude = 0.05;
  const VectorField f = standing_wave_field(w);
  test::Random random(2);
  for (int k = 0; k < 50; ++k) {
    const Vec3 x = w.origin + Vec3(random.uniform(), random.uniform(0, 0.1), random.uniform(0, 0.4));
    const Eigen::Matrix3d g = gradient(f, x);
    EXPECT_NEAR(g.trace(), 0, 1e-8);
    EXPECT_LT(curl(g).norm(), 1e-8);
    EXPECT_NEAR(f(Vec3(x.x(), 2, x.z())).y(), 0, 1e-15) << "the bottom";
    for (const double wall : {0.0, 0.2}) EXPECT_NEAR(f(Vec3(x.x(), x.y(), 3 + wall)).z(), 0, 1e-15);
  }
  EXPECT_NEAR(f(w.origin + Vec3(0, 0.1, 0)).y(), 0.05, 1e-15) << "a crest";
  w.depth = 1e4;
  EXPECT_NEAR(standing_wave_field(w)(w.origin + Vec3(0, 1e4, 0)).y(), 0.05, 1e-12) << "deep water";
}

std::vector<Start> starts_of(const InitialState& initial) {
  Emission emission(dx, 1000, mass);
  BoxEmitter e;
  e.box = {Vec3::Zero(), Vec3(10, 10, 10) * dx};
  e.velocity = Vec3(1, 0, 0);
  e.initial = initial;
  EXPECT_TRUE(emission.add(e).ok());
  return emission.due(0, 1e-3);
}

TEST(InitialState, velocity_is_added_where_the_particle_starts) {
  InitialState initial;
  initial.displacement = [](const Vec3& x) -> Vec3 { return {0, 0.1 * x.x(), 0}; };
  initial.velocity = rotation_field(Vec3::Zero(), Vec3(0, 0, 1), 3);
  const std::vector<Start> plain = starts_of({}), starts = starts_of(initial);
  ASSERT_EQ(starts.size(), 1000u);
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const Vec3 x = plain[k].position + Vec3(0, 0.1 * plain[k].position.x(), 0);
    EXPECT_LT((starts[k].position - x).norm(), 1e-15);
    EXPECT_LT((starts[k].velocity - Vec3(1, 0, 0) - 3 * Vec3(-x.y(), x.x(), 0)).norm(), 1e-15);
    EXPECT_EQ(plain[k].velocity, Vec3(1, 0, 0));
  }
}

TEST(InitialState, displacements_carry_along_the_field_and_keep_volumes) {
  InitialState turned;
  turned.displacement = rotation_field(Vec3::Zero(), Vec3(0, 0, 1), 0.5);
  const std::vector<Start> plain = starts_of({}), starts = starts_of(turned);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.5, Vec3(0, 0, 1)).toRotationMatrix();
  for (std::size_t k = 0; k < starts.size(); ++k)
    EXPECT_LT((starts[k].position - turn * plain[k].position).norm(), 1e-6 * dx);

  StandingWave w;
  w.wavelength = 0.4;
  w.depth = 0.05;
  w.amplitude = 0.01;
  InitialState shaped;
  shaped.displacement = standing_wave_field(w);
  const std::vector<Start> wave = starts_of(shaped);
  double furthest = 0, error = 0;
  for (std::size_t k = 0; k + 111 < wave.size(); ++k) {
    if (k % 10 == 9 || k / 10 % 10 == 9) continue;
    Eigen::Matrix3d cell;
    cell << wave[k + 1].position - wave[k].position, wave[k + 10].position - wave[k].position,
        wave[k + 100].position - wave[k].position;
    error = std::max(error, std::abs(cell.determinant() / (dx * dx * dx) - 1));
    furthest = std::max(furthest, (wave[k].position - plain[k].position).norm());
  }
  EXPECT_GT(furthest, dx);
  EXPECT_LT(error, 0.02) << "x + u(x) has 0.06";
}

TEST(InitialState, shaken_starts_are_a_function_of_the_seed) {
  InitialState initial;
  initial.shake = 0.1;
  const std::vector<Start> plain = starts_of({}), a = starts_of(initial), again = starts_of(initial);
  initial.seed = 2;
  const std::vector<Start> b = starts_of(initial);
  Vec3 mean = Vec3::Zero();
  double square = 0, largest = 0, differs = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].position, again[k].position);
    const Vec3 d = (a[k].position - plain[k].position) / (0.1 * dx);
    mean += d / 1000;
    square += d.squaredNorm() / 3000;
    largest = std::max(largest, d.cwiseAbs().maxCoeff());
    differs += (a[k].position - b[k].position).norm() > 0.001 * dx;
  }
  EXPECT_LE(largest, 1);
  EXPECT_GT(largest, 0.99);
  EXPECT_LT(mean.norm(), 0.06) << "three of its standard deviations";
  EXPECT_NEAR(square, 1.0 / 3, 0.02);
  EXPECT_GT(differs, 990);
}

TEST(InitialState, layers_of_a_nozzle_are_shaken_one_by_one_at_any_step) {
  std::vector<std::vector<Vec3>> all;
  for (const double dt : {0.05, 1e-3, 3.3e-4}) {
    Emission emission(dx, 1000, mass);
    DiscEmitter e;
    e.shake = 0.25;
    e.seed = 9;
    ASSERT_TRUE(emission.add(e).ok());
    std::vector<Vec3>& places = all.emplace_back();
    for (int k = 0; places.size() < 800; ++k)
      for (const Start& s : emission.due(k * dt, dt)) places.push_back(s.position);
    places.resize(800);
    EXPECT_EQ(places, all.front());
    EXPECT_NE(places[0], places[80]) << "the next layer";
  }
}

TEST(InitialState, is_saved_until_the_volume_is_filled) {
  BoxEmitter e;
  e.box = {Vec3::Zero(), Vec3(4, 4, 4) * dx};
  e.start = 0.5;
  e.initial.shake = 0.1;
  e.initial.velocity = rotation_field(Vec3::Zero(), Vec3(0, 0, 1), 3);
  Emission one(dx, 1000, mass), two(dx, 1000, mass);
  ASSERT_TRUE(one.add(e).ok());
  std::vector<std::uint8_t> bytes;
  Archive out(bytes);
  one.visit(out, 0);
  Archive in{Span<const std::uint8_t>(bytes)};
  two.visit(in, 0);
  ASSERT_TRUE(in.ok()) << in.status().message;
  EXPECT_GT(two.fastest_due(0.5, 0.1), 0.04);
  const std::vector<Start> a = one.due(0.5, 0.1), b = two.due(0.5, 0.1);
  ASSERT_EQ(a.size(), 64u);
  ASSERT_EQ(b.size(), 64u);
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].position, b[k].position);
    EXPECT_EQ(a[k].velocity, b[k].velocity);
  }
}

TEST(InitialState, refuses_what_is_not_finite_or_out_of_range) {
  const auto message = [](const InitialState& initial) {
    Emission emission(dx, 1000, mass);
    BoxEmitter e;
    e.box = {Vec3::Zero(), Vec3(2, 2, 2) * dx};
    e.initial = initial;
    return emission.add(e).message;
  };
  EXPECT_EQ(message({}), "");
  InitialState s;
  s.shake = 0.26;
  EXPECT_EQ(message(s), "box emitter: initial.shake is 0.26; it must be 0 … 0.25 spacings of the fluid");
  s.shake = std::nan("");
  EXPECT_NE(message(s), "");
  s = {};
  s.velocity = [](const Vec3& x) -> Vec3 { return x / 0.0; };
  EXPECT_NE(message(s).find("velocity must be finite"), std::string::npos) << message(s);
  s = {};
  s.displacement = [](const Vec3&) -> Vec3 { return Vec3::Constant(std::nan("")); };
  EXPECT_NE(message(s).find("particle 0"), std::string::npos);
  DiscEmitter disc;
  disc.shake = -0.1;
  EXPECT_NE(Emission(dx, 1000, mass).add(disc).message.find("disc emitter: shake"), std::string::npos);
}

}  // namespace
}  // namespace oilskin::fluid
