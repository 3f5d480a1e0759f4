/// Integrals of the kernel over triangles, and which parts of them a particle sees.
#include "fluid/boundary/wall_integral.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fluid/boundary/visible_part.h"
#include "fluid/lattice.h"
#include "support/random.h"

namespace oilskin::fluid {
namespace {

WallView view_of_wall(const std::array<Eigen::Vector3f, 3>& corners) {
  VisibleParts alone;
  alone.add(corners);
  return alone.views([](std::size_t) { return true; })[0];
}

// Values of Λ (B.1).
TEST(WallIntegral, half_space_function_of_the_cubic_spline) {
  const double zeta[] = {0, 0.1, 0.25, 0.5, 0.75, 0.9};
  const double mass[] = {0.5, 0.362622, 0.187760, 0.033333, 0.001302, 0.000015};
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(half_space_mass(zeta[k]), mass[k], 1e-6);
    const double e = 1e-6, z = zeta[k] + e;
    EXPECT_NEAR(plane_integral(z), (half_space_mass(z - e) - half_space_mass(z + e)) / (2 * e), 1e-6);
    EXPECT_NEAR(plane_integral_slope(z), (plane_integral(z - e) - plane_integral(z + e)) / (2 * e), 1e-5);
  }
  EXPECT_EQ(half_space_mass(1.0), 0);
  EXPECT_EQ(plane_integral(1.5), 0);
}

TEST(WallIntegral, tiles_of_a_plane_hide_it_together) {
  test::Random random(5);
  for (float edge : {0.3f, 0.9f, 2.0f, 20.0f})
    for (float z : {0.05f, 0.1f, 0.25f, 0.49f})
      for (int trial = 0; trial < 20; ++trial) {
        const float x = edge * static_cast<float>(random.uniform()),
                    y = edge * static_cast<float>(random.uniform());
        const int cells = static_cast<int>(std::ceil(1 / edge)) + 1;
        const auto corner = [&](int a, int b) {
          return Eigen::Vector3f(static_cast<float>(a) * edge - x, -z, static_cast<float>(b) * edge - y);
        };
        float share = 0;
        for (int a = -cells; a <= cells; ++a)
          for (int b = -cells; b <= cells; ++b) {
            const WallView one = view_of_wall({corner(a, b), corner(a + 1, b), corner(a + 1, b + 1)});
            const WallView two = view_of_wall({corner(a, b + 1), corner(a, b), corner(a + 1, b + 1)});
            share += one.share + two.share;
            for (const WallView& w : {one, two}) {
              if (!(w.share > 0)) continue;
              EXPECT_LT((w.normal - Eigen::Vector3f(0, 1, 0)).norm(), 1e-5);
            }
          }
        EXPECT_NEAR(share, 1, z < 0.1f ? 0.02 : 2e-4) << "edge " << edge << ", z " << z;
      }
}

/// ϖ(r) by the integral of the kernel.
double beyond(double q) {
  const double q3 = q * q * q, q5 = q3 * q * q;
  if (q < 0.5) return -32 * q3 * q3 + 192 * q5 / 5 - 32 * q3 / 3 + 1;
  return q < 1 ? 32 * q3 * q3 / 3 - 192 * q5 / 5 + 48 * q3 * q - 64 * q3 / 3 + 16.0 / 15 : 0;
}

TEST(WallIntegral, mass_beyond_a_distance) {
  for (int k = 0; k <= 20; ++k) EXPECT_NEAR(mass_beyond(0.05 * k), beyond(0.05 * k), 1e-12) << k;
}

/// Λ_T by its definition (B.7): ∫ over the triangle of solid angle × kernel mass beyond.
double shadow_mass(const std::array<Eigen::Vector3f, 3>& corners, int n) {
  const Vec3 a = corners[0].cast<double>(), b = corners[1].cast<double>(), c = corners[2].cast<double>();
  const Vec3 normal = (b - a).cross(c - a);
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      double s = (i + 0.5) / n, t = (j + 0.5) / n;
      if (s + t > 1) s = 1 - s, t = 1 - t;
      const Vec3 y = a + s * (b - a) + t * (c - a);
      const double r = y.norm();
      sum += std::abs(normal.dot(y)) / (2.0 * n * n) / (4 * pi * r * r * r) * beyond(r);
    }
  return sum;
}

TEST(WallIntegral, a_triangle_hides_what_the_definition_says) {
  test::Random random(9);
  for (int trial = 0; trial < 60; ++trial) {
    std::array<Eigen::Vector3f, 3> corners;
    for (Eigen::Vector3f& x : corners)
      x = Vec3(1.6 * (random.uniform() - 0.5), -0.15 - 0.4 * random.uniform(), 1.6 * (random.uniform() - 0.5))
              .cast<float>();
    const WallView view = view_of_wall(corners);
    if (view.distance < 0.08f) continue;  // seen edge-on: the sum over points is too coarse there
    EXPECT_NEAR(view.share * half_space_mass(view.distance), shadow_mass(corners, 200), 2e-3);
  }
}

TEST(WallIntegral, hides_nothing_where_there_is_no_area) {
  const Eigen::Vector3f a(0.1f, -0.2f, 0), b(0.3f, -0.2f, 0.1f);
  EXPECT_EQ(view_of_wall({a, b, b}).share, 0);
  EXPECT_EQ(view_of_wall({a, a, a}).share, 0);
  EXPECT_EQ(view_of_wall({a, b, Eigen::Vector3f(0.2f, -0.2f, 0.05f)}).share, 0);
  const Eigen::Vector3f in_plane(1, 0, 0), too(0, 0, 1), third(1, 0, 1);
  EXPECT_EQ(view_of_wall({in_plane, too, third}).share, 0) << "edge-on";
}

/// Distance of a triangle from the origin along a direction, or 1.
double hit(const std::array<Eigen::Vector3f, 3>& corners, const Vec3& direction) {
  const Vec3 a = corners[0].cast<double>(), b = corners[1].cast<double>(), c = corners[2].cast<double>();
  const Vec3 normal = (b - a).cross(c - a);
  const double t = normal.dot(a) / normal.dot(direction);
  const Vec3 x = t * direction;
  const bool inside = normal.dot((b - a).cross(x - a)) >= 0 && normal.dot((c - b).cross(x - b)) >= 0 &&
                      normal.dot((a - c).cross(x - c)) >= 0;
  return t > 0 && inside ? std::min(t, 1.0) : 1;
}

TEST(VisibleParts, hide_together_what_rays_to_the_first_triangle_do) {
  test::Random random(21);
  constexpr int rays = 40000;
  for (int trial = 0; trial < 25; ++trial) {
    std::vector<std::array<Eigen::Vector3f, 3>> triangles(2 + trial % 5);
    VisibleParts parts;
    for (auto& corners : triangles) {
      const Vec3 center = (0.3 + 0.3 * random.uniform()) * random.direction();
      for (Eigen::Vector3f& x : corners) x = (center + 0.6 * random.direction()).cast<float>();
      parts.add(corners);
    }
    double mass = 0, nearest = 1;
    for (const WallView& view : parts.views([](std::size_t) { return true; })) {
      nearest = std::min(nearest, static_cast<double>(view.distance));
      mass += static_cast<double>(view.share * half_space_mass(view.distance));
    }
    if (nearest < 0.08) continue;  // seen edge-on, where six Gauss points along an edge are too few
    double expected = 0;
    for (int k = 0; k < rays; ++k) {  // Fibonacci's sphere
      const double y = 1 - (2 * k + 1.0) / rays, phi = k * pi * (3 - std::sqrt(5.0)),
                   r = std::sqrt(1 - y * y);
      double first = 1;
      for (const auto& corners : triangles)
        first = std::min(first, hit(corners, Vec3(r * std::cos(phi), y, r * std::sin(phi))));
      expected += beyond(first) / rays;
    }
    EXPECT_NEAR(mass, expected, 3e-3) << "trial " << trial;
  }
}

/// Sums over all walls: λ, and the push in units of κ.
struct Sums {
  double lambda = 0;
  Vec3 push = Vec3::Zero();
  explicit Sums(const std::vector<WallView>& views) {
    for (const WallView& v : views) {
      lambda += static_cast<double>(v.share * half_space_mass(v.distance));
      push += (v.share * plane_integral(v.distance) * v.normal).cast<double>();
    }
  }
};

TEST(VisibleParts, are_the_same_by_samples) {
  test::Random random(33);
  const auto all = [](std::size_t) { return true; };
  for (int trial = 0; trial < 12; ++trial) {
    // A ball of small triangles, in front of the particle or around it.
    const Vec3 middle = trial % 2 ? Vec3(0, -0.6, 0) : Vec3::Zero();
    VisibleParts parts;
    for (int k = 0; k < 60 + 20 * trial; ++k) {
      const Vec3 center = middle + (0.2 + 0.25 * random.uniform()) * random.direction();
      std::array<Eigen::Vector3f, 3> corners;
      for (Eigen::Vector3f& x : corners) x = (center + 0.12 * random.direction()).cast<float>();
      parts.add(corners);
    }
    const Sums cut(parts.views(all, 100000000)), sampled(parts.views(all, 0)), given_up(parts.views(all, 50));
    EXPECT_EQ(given_up.lambda, sampled.lambda) << "in the middle of a triangle";
    EXPECT_NEAR(sampled.lambda, cut.lambda, 0.01) << trial;
    EXPECT_LT((sampled.push - cut.push).norm(), 0.06 * cut.push.norm() + 0.03) << trial;
  }
}

TEST(VisibleParts, by_samples_count_only_what_is_asked_for) {
  VisibleParts parts;
  for (float z : {-0.4f, -0.3f})
    parts.add({Eigen::Vector3f(-1, -1, z), Eigen::Vector3f(2, -1, z), Eigen::Vector3f(-1, 2, z)});
  parts.add({Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(0, 1, 0), Eigen::Vector3f(0, 0, 0)});  // edge-on
  EXPECT_EQ(parts.views([](std::size_t k) { return k == 0; }, 0)[0].share, 0) << "hidden";
  EXPECT_GT(parts.views([](std::size_t k) { return k == 1; }, 0)[1].share, 0.9f);
  for (const WallView& view : parts.views([](std::size_t) { return false; }, 0)) EXPECT_EQ(view.share, 0);
}

}  // namespace
}  // namespace oilskin::fluid
