// Particles as ellipsoids: their shapes, their volume, and that they do not reach through cloth.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/closest_point.h"
#include "reconstruction/scenes.h"

namespace oilskin {
namespace {

using test::WaterScene;

constexpr double pi = 3.14159265358979;

EllipsoidOptions options_for(const WaterScene& s, double gap = 0) {
  EllipsoidOptions o;
  o.spacing = s.spacing;
  o.gap = gap * s.spacing;
  o.threads = 2;
  return o;
}

std::vector<WaterEllipsoid> ellipsoids(const ReconstructionInput& input, const EllipsoidOptions& options) {
  std::vector<WaterEllipsoid> result;
  const Status status = make_ellipsoids(input, options, &result);
  EXPECT_TRUE(status.ok()) << status.message;
  return result;
}

Vec3 vec(const std::array<float, 3>& p) {
  return {p[0], p[1], p[2]};
}

double volume(const WaterEllipsoid& e) {
  return 4 * pi / 3 * double(e.radii[0]) * double(e.radii[1]) * double(e.radii[2]);
}

double stretch(const WaterEllipsoid& e) {
  return double(e.radii[0]) / double(e.radii[2]);
}

/// A tilted plane of particles.
WaterScene layer(double distance = 1) {
  WaterScene s;
  test::Random random(1);
  for (int j = 0; j < 14; ++j)
    for (int i = 0; i < 14; ++i)
      s.particles.push_back(s.spacing * (distance * Vec3(i, j, 0.5 * i) + random.in_cube(0.05)));
  return s;
}

std::size_t inner(int i, int j) {
  return std::size_t(14 * j + i);
}

TEST(Ellipsoids, of_lone_particles_are_spheres_with_the_volume_of_their_water) {
  WaterScene s;
  s.particles = {Vec3::Zero(), Vec3(0.1, 0, 0), Vec3(0.2, 0, 0)};
  const std::vector<double> volumes = {1e-7, 3e-8, 0};
  ReconstructionInput input = s.input();
  input.volumes = volumes;
  const auto result = ellipsoids(input, options_for(s));
  ASSERT_EQ(result.size(), 3u);
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_NEAR(volume(result[p]), volumes[p], 1e-6 * 1e-7);
    EXPECT_EQ(result[p].radii[0], result[p].radii[2]);
    EXPECT_EQ(vec(result[p].position), s.particles[p].cast<float>().cast<double>());
  }
}

TEST(Ellipsoids, of_a_layer_lie_in_it_and_keep_their_volume) {
  const WaterScene s = layer();
  const auto result = ellipsoids(s.input(), options_for(s));
  const Vec3 normal = Vec3(-0.5, 0, 1).normalized();
  for (int i = 4; i < 10; ++i)
    for (int j = 4; j < 10; ++j) {
      const WaterEllipsoid& e = result[inner(i, j)];
      EXPECT_GT(std::abs(vec(e.axes[2]).dot(normal)), 0.995);
      EXPECT_NEAR(stretch(e), 4, 1e-4) << "clamped";
      EXPECT_NEAR(volume(e), std::pow(s.spacing, 3), 1e-5 * std::pow(s.spacing, 3));
      EXPECT_NEAR(double(e.thickness), 4.0 / 3 * double(e.radii[2]), 1e-9);
    }
}

TEST(Ellipsoids, of_a_strand_lie_along_it) {
  WaterScene s;
  const Vec3 along = Vec3(1, 2, -0.5).normalized();
  for (int i = 0; i < 20; ++i) s.particles.push_back(0.4 * i * s.spacing * along);
  const auto result = ellipsoids(s.input(), options_for(s));
  for (std::size_t i = 6; i < 14; ++i) EXPECT_GT(std::abs(vec(result[i].axes[0]).dot(along)), 0.999);
}

TEST(Ellipsoids, deep_in_water_are_nearly_round) {
  WaterScene s;
  s.add_water({Vec3::Zero(), Vec3::Constant(10 * s.spacing)}, 0.05, 2);
  const auto result = ellipsoids(s.input(), options_for(s));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Vec3 at = s.particles[i] / s.spacing;
    if (at.minCoeff() > 3 && at.maxCoeff() < 7) {
      EXPECT_LT(stretch(result[i]), 1.3);
    }
  }
}

TEST(Ellipsoids, have_orthonormal_axes_by_length) {
  const WaterScene s = test::wavy_scene(true, 0.05, 12);
  for (const WaterEllipsoid& e : ellipsoids(s.input(), options_for(s, 0.1))) {
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b)
        EXPECT_NEAR(vec(e.axes[a]).dot(vec(e.axes[b])), a == b ? 1 : 0, 1e-6);
    EXPECT_NEAR(vec(e.axes[0]).cross(vec(e.axes[1])).dot(vec(e.axes[2])), 1, 1e-5);
    EXPECT_GE(e.radii[0], e.radii[1]);
    EXPECT_GE(e.radii[1], e.radii[2]);
  }
}

double nearest_distance(const Vec3& x, const WaterScene& s) {
  double least = INFINITY;
  for (const Triangle& t : s.triangles)
    least = std::min(least, closest_point(x, s.vertices[t[0]], s.vertices[t[1]], s.vertices[t[2]]).distance);
  return least;
}

/// The smallest distance of points of an ellipsoid from all triangles. The triangles nearest to it matter.
double distance(const WaterEllipsoid& e, const WaterScene& s, test::Random& random) {
  std::vector<std::size_t> near;
  const double reach = double(e.radii[0]) + s.spacing;
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const Triangle& i = s.triangles[t];
    if (closest_point(vec(e.position), s.vertices[i[0]], s.vertices[i[1]], s.vertices[i[2]]).distance < reach)
      near.push_back(t);
  }
  double least = INFINITY;
  for (int n = 0; n < 200; ++n) {
    const Vec3 on_sphere = random.direction();
    Vec3 x = vec(e.position);
    for (int k = 0; k < 3; ++k)
      x += on_sphere[k] * double(e.radii[std::size_t(k)]) * vec(e.axes[std::size_t(k)]);
    for (const std::size_t t : near) {
      const Triangle& i = s.triangles[t];
      least =
          std::min(least, closest_point(x, s.vertices[i[0]], s.vertices[i[1]], s.vertices[i[2]]).distance);
      // Behind the triangle a point may be far from it: the way there must not cross it.
      const Vec3 a = s.vertices[i[0]], n1 = (s.vertices[i[1]] - a).cross(s.vertices[i[2]] - a);
      const double from = n1.dot(vec(e.position) - a), to = n1.dot(x - a);
      if (from * to >= 0) continue;
      const Vec3 at = vec(e.position) + from / (from - to) * (x - vec(e.position));
      const ClosestPoint c = closest_point(at, a, s.vertices[i[1]], s.vertices[i[2]]);
      if (c.distance < 1e-12) least = -1;
    }
  }
  return least;
}

TEST(Ellipsoids, keep_the_gap_to_cloth_on_their_own_side) {
  test::Random random(5);
  const WaterScene scenes[] = {test::wavy_scene(true, 0.05, 12), test::vee_scene(0.05),
                               test::crumple_scene(0.05, 20)};
  for (const WaterScene& s : scenes)
    for (const double smoothing : {0.0, 0.9}) {
      EllipsoidOptions options = options_for(s, 0.1);
      options.smoothing = smoothing;
      std::size_t near = 0;
      for (const WaterEllipsoid& e : ellipsoids(s.input(), options)) {
        if (e.radii[0] == 0) {
          ASSERT_LE(nearest_distance(vec(e.position), s), options.gap * (1 + 1e-6)) << "it has space";
          continue;
        }
        const double d = distance(e, s, random);
        near += d < 0.3 * s.spacing;
        ASSERT_GE(d, options.gap * (1 - 1e-3));
      }
      EXPECT_GT(near, 20u) << "the case tests nothing";
    }
}

/// The mean of its neighbours is in the gap or behind it.
TEST(Ellipsoids, do_not_vanish_because_smoothing_moves_them) {
  WaterScene s;
  s.add_sheet(2, [](double u, double v) { return Vec3(u - 0.5, v - 0.5, 0); });
  test::Random random(8);
  for (int n = 0; n < 200; ++n) {
    const Vec3 along = s.spacing * random.in_cube(4);
    s.particles.emplace_back(along.x(), along.y(), (n % 4 == 0 ? 0.12 : 0.08) * s.spacing);
  }
  EllipsoidOptions options = options_for(s, 0.1);
  options.smoothing = 1;
  const auto result = ellipsoids(s.input(), options);
  for (std::size_t p = 0; p < result.size(); ++p)
    EXPECT_EQ(result[p].radii[0] > 0, s.particles[p].z() > options.gap) << p;
}

TEST(Ellipsoids, do_not_see_particles_without_water) {
  WaterScene s = layer();
  const auto alone = ellipsoids(s.input(), options_for(s));
  std::vector<double> volumes(s.particles.size(), std::pow(s.spacing, 3));
  for (int i = 0; i < 14; ++i) s.particles.push_back(s.particles[inner(i, 6)] + s.spacing * Vec3(0, 0, 1));
  volumes.resize(s.particles.size(), 0);
  ReconstructionInput input = s.input();
  input.volumes = volumes;
  const auto result = ellipsoids(input, options_for(s));
  EXPECT_EQ(std::memcmp(alone.data(), result.data(), alone.size() * sizeof alone[0]), 0);
  EXPECT_EQ(result.back().radii[0], 0);
}

TEST(Ellipsoids, on_cloth_become_flat_before_they_lose_volume) {
  WaterScene s = layer();
  for (Vec3& p : s.particles) p.z() = 0.3 * s.spacing;
  s.add_sheet(8, [](double u, double v) { return Vec3(0.1 * u - 0.015, 0.1 * v - 0.015, 0); });
  const auto result = ellipsoids(s.input(), options_for(s, 0.1));
  for (int i = 4; i < 10; ++i) {
    const WaterEllipsoid& e = result[inner(i, 7)];
    EXPECT_NEAR(volume(e), std::pow(s.spacing, 3), 0.01 * std::pow(s.spacing, 3));
    EXPECT_LE(double(e.radii[2]), 0.2 * s.spacing);
    EXPECT_GT(double(e.radii[2]), 0.15 * s.spacing);
  }
}

TEST(Ellipsoids, do_not_see_neighbours_behind_a_sheet) {
  WaterScene above, both;
  const auto sheet = [](double u, double v) { return Vec3(0.1 * u - 0.02, 0.1 * v - 0.02, 0); };
  above.add_sheet(8, sheet);
  both.add_sheet(8, sheet);
  above.add_water({Vec3(0, 0, 0.001), Vec3(0.05, 0.05, 0.011)}, 0.1, 3);
  both.particles = above.particles;
  both.add_water({Vec3(0, 0, -0.011), Vec3(0.05, 0.05, -0.001)}, 0.1, 4);
  const auto alone = ellipsoids(above.input(), options_for(above)),
             together = ellipsoids(both.input(), options_for(both));
  EXPECT_EQ(std::memcmp(alone.data(), together.data(), alone.size() * sizeof alone[0]), 0);
  both.vertices.clear();
  both.triangles.clear();
  above.vertices.clear();
  above.triangles.clear();
  const auto a = ellipsoids(above.input(), options_for(above)),
             b = ellipsoids(both.input(), options_for(both));
  EXPECT_NE(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0) << "the other layer is in reach";
}

TEST(Ellipsoids, have_the_same_bits_on_any_number_of_threads) {
  const WaterScene s = test::wavy_scene(true, 0.06, 12);
  EllipsoidOptions options = options_for(s, 0.1);
  options.threads = 1;
  const auto one = ellipsoids(s.input(), options);
  options.threads = 2;
  const auto two = ellipsoids(s.input(), options);
  EXPECT_EQ(std::memcmp(one.data(), two.data(), one.size() * sizeof one[0]), 0);
}

TEST(Ellipsoids, of_particles_that_are_not_finite_or_at_an_obstacle_have_no_size) {
  WaterScene s;
  s.add_sheet(2, [](double u, double v) { return Vec3(u - 0.5, v - 0.5, 0); });
  s.particles = {Vec3(std::nan(""), 0, 0), Vec3(0, 0, 0), Vec3(0, 0, 0.0004), Vec3(0.1, 0, 0.004)};
  const auto result = ellipsoids(s.input(), options_for(s, 0.1));
  EXPECT_EQ(result[0].radii[0], 0);
  EXPECT_EQ(vec(result[0].position), Vec3::Zero());
  EXPECT_EQ(result[1].radii[0], 0);
  EXPECT_EQ(result[2].radii[0], 0);
  EXPECT_GT(result[3].radii[2], 0);
  EXPECT_TRUE(ellipsoids({}, EllipsoidOptions()).empty());
}

struct Refusal {
  const char* message;
  void (*spoil)(EllipsoidOptions&);
};

class RefusedEllipsoids : public testing::TestWithParam<Refusal> {};

TEST_P(RefusedEllipsoids, with_the_field_and_the_result_stays) {
  WaterScene s;
  s.particles = {Vec3::Zero()};
  EllipsoidOptions options = options_for(s);
  GetParam().spoil(options);
  std::vector<WaterEllipsoid> result(7);
  const Status status = make_ellipsoids(s.input(), options, &result);
  EXPECT_EQ(status.message.substr(0, std::strlen(GetParam().message)), GetParam().message) << status.message;
  EXPECT_EQ(result.size(), 7u);
}

INSTANTIATE_TEST_SUITE_P(
    Options, RefusedEllipsoids,
    testing::Values(Refusal{"spacing is 0;", [](EllipsoidOptions& o) { o.spacing = 0; }},
                    Refusal{"spacing is nan;", [](EllipsoidOptions& o) { o.spacing = std::nan(""); }},
                    Refusal{"reach is 0.5;", [](EllipsoidOptions& o) { o.reach = 0.5; }},
                    Refusal{"reach is 5;", [](EllipsoidOptions& o) { o.reach = 5; }},
                    Refusal{"max_stretch is 0.9;", [](EllipsoidOptions& o) { o.max_stretch = 0.9; }},
                    Refusal{"min_neighbours is -1;", [](EllipsoidOptions& o) { o.min_neighbours = -1; }},
                    Refusal{"smoothing is 1.1;", [](EllipsoidOptions& o) { o.smoothing = 1.1; }},
                    Refusal{"gap is -1;", [](EllipsoidOptions& o) { o.gap = -1; }},
                    Refusal{"threads is -1;", [](EllipsoidOptions& o) { o.threads = -1; }}));

TEST(RefusedEllipsoids, input_is_that_of_the_mesh) {
  WaterScene s = test::vee_scene(0.03);
  std::vector<WaterEllipsoid> result(7);
  ReconstructionInput input = s.input();
  const std::vector<double> volumes = {1e-7};
  input.volumes = volumes;
  EXPECT_NE(make_ellipsoids(input, options_for(s), &result).message.find("volumes"), std::string::npos);
  s.triangles[2][1] = 1u << 30;
  EXPECT_NE(make_ellipsoids(s.input(), options_for(s), &result).message.find("triangle 2"),
            std::string::npos);
  s.triangles[2][1] = 0;
  s.vertices[1].x() = INFINITY;
  EXPECT_NE(make_ellipsoids(s.input(), options_for(s), &result).message.find("vertex 1"), std::string::npos);
  EXPECT_EQ(result.size(), 7u);
}

}  // namespace
}  // namespace oilskin
