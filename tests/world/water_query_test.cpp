// Questions about the water between two steps.
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "oilskin/water_query.h"

namespace oilskin::test {
namespace {

constexpr double dx = 0.01;

/// 15³ particles around the origin, which turn about the axis y.
struct Cube : World {
  Cube() : World(settings(), fluid()) {
    std::vector<Vec3> x, v;
    for (int i = -7; i <= 7; ++i)
      for (int j = -7; j <= 7; ++j)
        for (int k = -7; k <= 7; ++k) {
          x.push_back(dx * Vec3(i, j, k));
          v.push_back(Vec3::UnitY().cross(x.back()) + Vec3(1, 2, 3));
        }
    EXPECT_TRUE(add_particles(x, v).ok());
  }
  static WorldSettings settings() {
    WorldSettings s;
    s.threads = 1;
    return s;
  }
  static FluidSettings fluid() {
    FluidSettings s;
    s.spacing = dx;
    return s;
  }
};

TEST(WaterQuery, volume_is_that_of_the_particles_inside) {
  Cube w;
  const WaterQuery q(w);
  const double one = w.particle_mass() / w.fluid_settings().rest_density;
  double volume = 0;
  ASSERT_TRUE(q.volume(Box{Vec3::Constant(-2.5 * dx), Vec3::Constant(2.5 * dx)}, &volume).ok());
  EXPECT_NEAR(volume, 125 * one, 1e-12 * volume);
  ASSERT_TRUE(q.volume(Vec3::Zero(), 1.1 * dx, &volume).ok());
  EXPECT_NEAR(volume, 7 * one, 1e-12 * volume);
}

TEST(WaterQuery, sample_has_the_rest_density_inside_and_a_linear_velocity) {
  Cube w;
  const WaterQuery q(w);
  WaterSample s;
  ASSERT_TRUE(q.sample(Vec3::Zero(), &s).ok());
  EXPECT_NEAR(s.density, w.fluid_settings().rest_density, 0.03 * w.fluid_settings().rest_density);
  EXPECT_LT((s.velocity - Vec3(1, 2, 3)).norm(), 1e-12);
  ASSERT_TRUE(q.sample(Vec3(1, 0, 0), &s).ok());
  EXPECT_EQ(s.density, 0);
  EXPECT_EQ(s.velocity, Vec3(0, 0, 0));
}

TEST(WaterQuery, ray_stops_at_the_first_ball_and_nearest_finds_the_corner) {
  Cube w;
  const WaterQuery q(w);
  WaterHit hit;
  ASSERT_TRUE(q.ray(Vec3(0, 1, 0), Vec3(0, -1, 0), &hit).ok());
  ASSERT_TRUE(hit.found);
  EXPECT_LT((hit.place - Vec3(0, 7.5 * dx, 0)).norm(), 1e-12);
  EXPECT_LT((hit.normal - Vec3(0, 1, 0)).norm(), 1e-9);
  ASSERT_TRUE(q.ray(Vec3(0, 1, 0), Vec3(0, 0.5, 0), &hit).ok());
  EXPECT_FALSE(hit.found);
  ASSERT_TRUE(q.nearest(Vec3(1, 1, 1), &hit).ok());
  EXPECT_EQ(w.positions()[hit.particle], dx * Vec3(7, 7, 7));
}

/// Σ m W and Σ m W v over all particles.
WaterSample sample_of_all(const World& w, const Vec3& point) {
  const FluidSettings& f = w.fluid_settings();
  const double h = f.support_ratio * f.spacing, norm = 315 / (64 * std::acos(-1.0) * std::pow(h, 9));
  WaterSample sum;
  for (std::size_t i = 0; i < w.particle_count(); ++i) {
    const double r2 = (w.positions()[i] - point).squaredNorm();
    if (r2 >= h * h) continue;
    const double part = w.particle_mass() * norm * std::pow(h * h - r2, 3);
    sum.density += part;
    sum.velocity += part * w.motions()[i];
  }
  if (sum.density > 0) sum.velocity /= sum.density;
  return sum;
}

TEST(WaterQuery, sample_is_the_sum_over_all_particles_after_steps_inside_at_surfaces_and_away) {
  for (const double spacing : {0.004, 0.01}) {
    for (const double ratio : {1.5, 2.0, 2.5}) {
      FluidSettings fluid = Cube::fluid();
      fluid.spacing = spacing;
      fluid.support_ratio = ratio;
      World w(Cube::settings(), fluid);
      std::vector<Vec3> x, v;
      for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j)
          for (int k = 0; k < 8; ++k) {
            x.push_back(spacing * Vec3(i, j, k) - Vec3::Constant(3.5 * spacing));
            v.push_back(10 * Vec3(x.back().y(), -x.back().x(), x.back().z()));
          }
      ASSERT_TRUE(w.add_particles(x, v).ok());
      for (int step = 0; step < 5; ++step) ASSERT_TRUE(w.step(1e-3).status.ok());
      const WaterQuery q(w);
      int wet = 0;
      for (int k = -40; k <= 40; ++k) {
        const Vec3 point = 0.25 * spacing * Vec3(k, 0.3 * k, -0.7 * k);
        WaterSample s;
        ASSERT_TRUE(q.sample(point, &s).ok());
        const WaterSample all = sample_of_all(w, point);
        EXPECT_NEAR(s.density, all.density, 1e-9 * fluid.rest_density) << point.transpose();
        EXPECT_LT((s.velocity - all.velocity).norm(), 1e-9) << point.transpose();
        wet += all.density > 0;
      }
      EXPECT_GT(wet, 20);
      EXPECT_LT(wet, 81);
    }
  }
}

TEST(WaterQuery, sample_far_out_ends_and_finds_nothing) {
  Cube w;
  const WaterQuery q(w);
  for (const double far : {1e12, 1e15, 1e18, 1e300, -1e18, -1e300}) {
    WaterSample s;
    ASSERT_TRUE(q.sample(Vec3(far, 0, far), &s).ok());
    EXPECT_EQ(s.density, 0) << far;
  }
}

TEST(WaterQuery, threads_read_the_same_and_the_world_stays_as_it_is) {
  Cube w;
  const std::uint64_t before = w.state_hash();
  const WaterQuery q(w);
  std::array<WaterSample, 4> found;
  std::vector<std::thread> threads;
  for (WaterSample& s : found)
    threads.emplace_back([&q, &s] { EXPECT_TRUE(q.sample(Vec3(0.003, 0.07, -0.01), &s).ok()); });
  for (std::thread& t : threads) t.join();
  for (const WaterSample& s : found) {
    EXPECT_EQ(s.density, found[0].density);
    EXPECT_EQ(s.velocity, found[0].velocity);
  }
  EXPECT_EQ(w.state_hash(), before);
}

TEST(WaterQuery, bad_input_is_refused) {
  Cube w;
  const WaterQuery q(w);
  const Vec3 nan = Vec3::Constant(std::nan(""));
  double volume = -1;
  WaterSample s;
  WaterHit hit;
  EXPECT_FALSE(q.volume(Box{}, &volume).ok());
  EXPECT_FALSE(q.volume(Box{Vec3(1, 0, 0), Vec3(0, 1, 1)}, &volume).ok());
  EXPECT_FALSE(q.volume(Vec3::Zero(), -1, &volume).ok());
  EXPECT_FALSE(q.volume(Vec3::Zero(), 1, nullptr).ok());
  EXPECT_FALSE(q.volume(Vec3::Zero(), std::nan(""), &volume).ok());
  EXPECT_FALSE(q.volume(nan, 1, &volume).ok());
  EXPECT_FALSE(q.volume(Box{Vec3::Zero(), Vec3::Zero()}, nullptr).ok());
  EXPECT_FALSE(q.nearest(Vec3::Zero(), nullptr).ok());
  EXPECT_FALSE(q.ray(Vec3::Zero(), Vec3(1, 0, 0), nullptr).ok());
  EXPECT_FALSE(q.ray(Vec3::Zero(), nan, &hit).ok());
  EXPECT_FALSE(q.sample(nan, &s).ok());
  EXPECT_FALSE(q.sample(Vec3::Zero(), nullptr).ok());
  EXPECT_FALSE(q.nearest(nan, &hit).ok());
  EXPECT_FALSE(q.ray(nan, Vec3::Zero(), &hit).ok());
  EXPECT_FALSE(q.ray(Vec3::Zero(), Vec3::Zero(), &hit).ok());
  EXPECT_EQ(volume, -1);
}

}  // namespace
}  // namespace oilskin::test
