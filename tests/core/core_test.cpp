#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "core/assert.h"
#include "core/closest_point.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "oilskin/settings.h"
#include "oilskin/surface_motion.h"
#include "oilskin/version.h"
#include "support/random.h"

namespace oilskin {
namespace {

using test::Random;

// Twin: dense sampling of the triangle can only be farther, and by no more than the sampling step.
TEST(ClosestPoint, is_no_farther_than_any_sample_and_attained) {
  Random random(2);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 a = random.in_cube(1), b = random.in_cube(1), p = random.in_cube(1.5);
    Vec3 c = random.in_cube(1);
    if (k % 4 == 1) c = a + (b - a) * random.uniform(-1, 2) + random.in_cube(1e-9);  // sliver
    if (k % 4 == 2) c = a + (b - a) * random.uniform(-1, 2);                         // segment
    if (k % 4 == 3) c = a;                                                           // segment by coincidence
    const ClosestPoint r = closest_point(p, a, b, c);
    const Vec3 point = r.weights[0] * a + r.weights[1] * b + r.weights[2] * c;
    EXPECT_NEAR((p - point).norm(), r.distance, 1e-12);
    EXPECT_NEAR(r.weights[0] + r.weights[1] + r.weights[2], 1, 1e-15);
    for (double w : r.weights) EXPECT_TRUE(w >= 0 && w <= 1);
    const int n = 24;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const Vec3 q = a + (b - a) * (double(i) / n) + (c - a) * (double(j) / n);
        ASSERT_LE(r.distance, (p - q).norm() + 1e-8);
      }
  }
}

TEST(ClosestPoint, weights_off_the_feature_are_exactly_zero) {
  const ClosestPoint v = closest_point({-1, 0.3, -1}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1});
  EXPECT_EQ(v.feature, 1);
  EXPECT_EQ(v.weights, (std::array<double, 3>{1, 0, 0}));
  const ClosestPoint e = closest_point({0.5, 0.3, -1}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1});
  EXPECT_EQ(e.feature, 3);
  EXPECT_EQ(e.weights[2], 0);
  const ClosestPoint f = closest_point({0.25, 0.3, 0.25}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1});
  EXPECT_EQ(f.feature, 7);
  EXPECT_NEAR(f.distance, 0.3, 1e-15);
}

TEST(Workers, chunks_cover_the_range_once_and_sums_do_not_depend_on_threads) {
  double sums[3];
  int k = 0;
  for (int threads : {1, 2, 5}) {
    const Workers workers(threads);
    std::vector<std::atomic<int>> hits(1003);
    workers.for_each(hits.size(), 10, [&](std::size_t i) { ++hits[i]; });
    for (auto& h : hits) EXPECT_EQ(h.load(), 1);
    sums[k++] = workers.ordered_sum(1000003, 1000, 0.0, [](std::size_t begin, std::size_t end) {
      double s = 0;
      for (std::size_t i = begin; i < end; ++i) s += std::sin(static_cast<double>(i));
      return s;
    });
  }
  EXPECT_EQ(sums[0], sums[1]);
  EXPECT_EQ(sums[0], sums[2]);
  Workers(2).for_each(0, 16, [](std::size_t) { FAIL(); });
}

TEST(Hash, depends_on_order_and_bits) {
  Hash64 a, b, c;
  a.add(1.0), a.add(2.0);
  b.add(2.0), b.add(1.0);
  c.add(1.0), c.add(2.0);
  EXPECT_NE(a.value(), b.value());
  EXPECT_EQ(a.value(), c.value());
  Hash64 d, e;
  d.add(0.0);
  e.add(-0.0);
  EXPECT_NE(d.value(), e.value());
}

TEST(Stored, keeps_what_a_float_keeps) {
  Random random(9);
  for (int k = 0; k < 100000; ++k) {
    const Vec3 x = random.in_cube(random.log_uniform(1e-6, 1e6));
    const Vec3 s = stored(x, Storage::float32);
    for (int i = 0; i < 3; ++i) {
      volatile float f = static_cast<float>(x[i]);
      ASSERT_EQ(s[i], static_cast<double>(f));
    }
    ASSERT_EQ(stored(s, Storage::float32), s);
    ASSERT_EQ(stored(x, Storage::float64), x);
  }
}

TEST(MinimumSeparation, matches_the_figures_of_the_contact_loop) {
  // float host: R = 10 m needs h ≥ 0.31 mm, R = 100 m 3.1 mm
  EXPECT_NEAR(4 * minimum_separation(0, 10, Storage::float32), 0.31e-3, 0.01e-3);
  EXPECT_NEAR(4 * minimum_separation(0, 100, Storage::float32), 3.1e-3, 0.1e-3);
  EXPECT_EQ(minimum_separation(0.001, 1, Storage::float64), 1e-6);
}

template <class S, class F>
void expect_refused(F spoil, const char* message) {
  S s;
  EXPECT_TRUE(s.validate().ok());
  spoil(s);
  const Status status = s.validate();
  EXPECT_FALSE(status.ok());
  EXPECT_NE(status.message.find(message), std::string::npos) << status.message;
}

TEST(Settings, validate_names_field_value_and_range) {
  const double nan = std::nan("");
  expect_refused<FluidSettings>([](auto& s) { s.spacing = 0; }, "fluid.spacing is 0; it must be");
  expect_refused<FluidSettings>([&](auto& s) { s.rest_density = nan; }, "fluid.rest_density is nan");
  expect_refused<FluidSettings>([](auto& s) { s.support_ratio = 1; }, "1.5 … 4");
  expect_refused<FluidSettings>(
      [](auto& s) {
        s.support_ratio = 3;
        s.boundary = BoundaryModel::mirrored;
      },
      "1.5 … 2.5 with fluid.boundary mirrored");
  expect_refused<FluidSettings>([](auto& s) { s.max_iterations = 2; }, "≥ fluid.min_iterations");
  expect_refused<FluidSettings>([](auto& s) { s.viscosity = -1; }, "fluid.viscosity is -1");
  expect_refused<SurfaceSettings>([](auto& s) { s.thickness = -0.001; }, "thickness is -0.001");
  expect_refused<SurfaceSettings>([](auto& s) { s.slip.friction = -1; }, "slip.friction is -1");
  expect_refused<ContactSettings>([](auto& s) { s.solver_iterations = 0; },
                                  "contact.sweeps is 0; it must be 1");
  expect_refused<WorldSettings>([&](auto& s) { s.gravity.x() = nan; }, "gravity is");
  expect_refused<WorldSettings>([](auto& s) { s.kill_box.max.y() = -200; }, "kill_box");
  expect_refused<WorldSettings>([](auto& s) { s.threads = -1; }, "threads is -1");
}

TEST(Version, library_and_headers_agree_in_numbers_and_text) {
  EXPECT_EQ(version(), header_version);
  EXPECT_NE(version(), (Version{header_version.major, header_version.minor, header_version.patch + 1}));
  const std::string text = std::to_string(header_version.major) + "." + std::to_string(header_version.minor) +
                           "." + std::to_string(header_version.patch);
  EXPECT_EQ(text, OILSKIN_VERSION_STRING);
}

int asserts_seen = 0;

TEST(Assert, can_be_routed_by_a_host) {
  set_assert_handler([](const char*, const char*, int) { ++asserts_seen; });
  detail::assert_failed("a", "b", 1);
  EXPECT_EQ(asserts_seen, 1);
  set_assert_handler(nullptr);
}

TEST(Settings, numbers_that_are_no_choice_are_refused) {
  FluidSettings fluid;
  fluid.solver = static_cast<PressureSolver>(9);
  EXPECT_NE(fluid.validate().message.find("fluid.solver is 9"), std::string::npos);
  fluid = {};
  fluid.boundary = static_cast<BoundaryModel>(-1);
  EXPECT_FALSE(fluid.validate().ok());
  SurfaceSettings surface;
  surface.slip_back = SlipSettings{};
  surface.slip_back->model = static_cast<SlipModel>(9);
  EXPECT_FALSE(surface.validate().ok());
  ContactSettings contact;
  contact.infeasible = static_cast<Infeasible>(5);
  EXPECT_FALSE(contact.validate().ok());
}

}  // namespace
}  // namespace oilskin
