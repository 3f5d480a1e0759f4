// The predicates of contact: what they add to the continuous test.
#include "contact/predicates.h"

#include <gtest/gtest.h>

#include <cmath>

namespace oilskin::contact {
namespace {

PointTriangle over_the_unit_triangle(const Vec3& p) {
  return {p, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
}

TEST(PathsIntersect, a_held_pair_counts_as_disjoint_even_where_it_touches) {
  for (const Vec3& p : {Vec3(.25, .25, 0), Vec3(.5, .5, 0), Vec3(0, 0, 0)}) {
    const PointTriangle x = over_the_unit_triangle(p);
    EXPECT_FALSE(paths_intersect(x, x).hit);
    const ccd::Impact touch = ccd::point_triangle({x.p, x.a, x.b, x.c, x.p, x.a, x.b, x.c});
    EXPECT_TRUE(touch.hit) << "as a continuous test it touches at 0";
    EXPECT_EQ(touch.time, 0);
  }
}

TEST(PathsIntersect, a_pair_is_held_only_if_all_four_points_are_bit_for_bit) {
  const PointTriangle x0 = over_the_unit_triangle({.25, .25, 0});
  const auto touches = [&x0](Vec3 PointTriangle::*point, int axis) {
    PointTriangle x1 = x0;
    double& x = (x1.*point)[axis];
    x = std::nextafter(x, 2);
    return paths_intersect(x0, x1).hit;
  };
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_TRUE(touches(&PointTriangle::p, axis));
    EXPECT_TRUE(touches(&PointTriangle::a, axis));
    EXPECT_TRUE(touches(&PointTriangle::b, axis));
    EXPECT_TRUE(touches(&PointTriangle::c, axis));
  }
  PointTriangle negative_zero = x0;
  negative_zero.p.z() = -0.0;
  EXPECT_TRUE(paths_intersect(x0, negative_zero).hit);
}

TEST(EndDistance, is_too_close_below_delta_only) {
  const double delta = 1e-3;
  for (const Vec3& direction : {Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
    const auto at = [&](double d) { return over_the_unit_triangle(Vec3(.25, .25, 0) + d * direction); };
    EXPECT_TRUE(end_distance(at(0), delta).too_close);
    EXPECT_TRUE(end_distance(at((1 - 1e-9) * delta), delta).too_close);
    EXPECT_FALSE(end_distance(at((1 + 1e-9) * delta), delta).too_close);
    EXPECT_NEAR(end_distance(at(delta), delta).distance, delta, 1e-15);
  }
}

}  // namespace
}  // namespace oilskin::contact
