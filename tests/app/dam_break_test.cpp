// The dam break's measures: on columns of lattice points, and on made-up fronts.
#include "checks/martin_moyce.h"

#include <gtest/gtest.h>

#include <cmath>

namespace oilskin::demo {
namespace {

constexpr double a = 0.05715, g = 9.81;
const double unit = std::sqrt(a / (2 * g));
const DamFit fit{0.15, 0.1, 0.05}, unshifted{0, 0.1, 0.05};

/// A run whose front and height are functions of T = t sqrt(2g/a) and τ = t sqrt(g/a).
template <class Front, class Height>
std::vector<DamMoment> run_of(Front front, Height height, double until) {
  std::vector<DamMoment> run;
  for (double t = 0; t <= until; t += 0.001)
    run.push_back({t, front(t / unit) * a, height(t / unit / std::sqrt(2.0)) * 2 * a});
  return run;
}

/// Fits to the experiment, good to a few per cent: the front accelerates, then runs at nearly 1.65.
double front_like_theirs(double T) {
  return T < 1.4 ? 1 + 0.32 * T * T : 1.627 + 1.33 * (T - 1.4);
}
double height_like_theirs(double tau) {
  return tau < 0.5 ? 1 - 0.2 * tau * tau : 0.95 - 0.29 * (tau - 0.5);
}

std::vector<Vec3> lattice(const Vec3& from, int nx, int ny, int nz, double dx) {
  std::vector<Vec3> points;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) points.push_back(from + dx * Vec3(i + 0.5, j + 0.5, k + 0.5));
  return points;
}

TEST(DamBreak, a_standing_column_reaches_as_far_as_it_is_wide) {
  DamPlace place;
  place.foot = Vec3(1, 2, 3);
  place.spacing = a / 16;
  place.breadth = a / 2;
  const DamMoment moment = look_at_dam(lattice(place.foot, 16, 32, 8, a / 16), place, 0.5);
  EXPECT_EQ(moment.t, 0.5);
  EXPECT_NEAR(moment.front, a, 1e-12);
  EXPECT_NEAR(moment.height, 2 * a, 1e-12);
}

TEST(DamBreak, runs_along_the_given_axis) {
  DamPlace place;
  place.spacing = 0.01;
  place.width = 0.16;
  place.breadth = 0.05;
  place.along = Vec3(0, 0, -1);
  place.up = Vec3(1, 0, 0);
  const DamMoment moment = look_at_dam(lattice(Vec3(0, 0, -0.3), 10, 5, 30, 0.01), place, 0);
  EXPECT_NEAR(moment.front, 0.3, 1e-12);
  EXPECT_NEAR(moment.height, 0.1, 1e-12);
}

TEST(DamBreak, spray_is_no_front) {
  std::vector<Vec3> water = lattice(Vec3::Zero(), 10, 10, 10, 0.01);
  const std::vector<Vec3> drop = lattice(Vec3(0.5, 0, 0), 3, 3, 3, 0.01);
  water.insert(water.end(), drop.begin(), drop.end());
  EXPECT_EQ(bulk_of(water, 0.02).size(), 1000u);
  const std::vector<Vec3> bridge = lattice(Vec3(0.1, 0, 0), 40, 1, 1, 0.01);
  water.insert(water.end(), bridge.begin(), bridge.end());
  EXPECT_EQ(bulk_of(water, 0.02).size(), water.size());
  EXPECT_TRUE(bulk_of({}, 0.02).empty());
}

TEST(DamBreak, a_front_like_the_measured_one_is_within_the_tolerance) {
  const DamComparison found =
      compare_with_martin_moyce(run_of(front_like_theirs, height_like_theirs, 0.2), a, g, fit);
  EXPECT_LT(found.front, 0.06);
  EXPECT_LE(std::abs(found.shift), 0.15);
  EXPECT_LT(found.height, 0.05);
  // 1.33 sqrt(2 g a) in the front's own units against Ritter's 2 sqrt(2 g a).
  EXPECT_NEAR(found.speed, 1.33 / 2, 1e-3);
}

TEST(DamBreak, a_late_front_is_shifted_no_farther_than_allowed) {
  const auto late = [](double T) { return front_like_theirs(std::max(0.0, T - 0.1)); };
  const auto far_too_late = [](double T) { return front_like_theirs(std::max(0.0, T - 0.6)); };
  const double exact =
      compare_with_martin_moyce(run_of(front_like_theirs, height_like_theirs, 0.2), a, g, unshifted).front;
  const DamComparison found = compare_with_martin_moyce(run_of(late, height_like_theirs, 0.25), a, g, fit);
  EXPECT_LE(found.front, exact + 1e-3);
  EXPECT_GT(found.shift, 0);
  EXPECT_GT(compare_with_martin_moyce(run_of(late, height_like_theirs, 0.25), a, g, unshifted).front,
            found.front);
  EXPECT_GT(compare_with_martin_moyce(run_of(far_too_late, height_like_theirs, 0.25), a, g, fit).front, 0.1);
}

TEST(DamBreak, a_front_that_runs_away_or_stands_still_fails) {
  const auto stands = [](double) { return 1.0; };
  const auto runs = [](double T) { return 1 + 2.2 * T; };
  EXPECT_GT(compare_with_martin_moyce(run_of(stands, height_like_theirs, 0.2), a, g, fit).front, 0.5);
  const DamComparison found = compare_with_martin_moyce(run_of(runs, height_like_theirs, 0.2), a, g, fit);
  EXPECT_GT(found.front, 0.1);
  EXPECT_GT(found.speed, 1);
  EXPECT_GT(compare_with_martin_moyce(run_of(front_like_theirs, stands, 0.2), a, g, fit).height, 0.5);
}

TEST(DamBreak, a_run_that_ends_too_soon_is_no_comparison) {
  EXPECT_FALSE(std::isfinite(
      compare_with_martin_moyce(run_of(front_like_theirs, height_like_theirs, 0.1), a, g, fit).front));
  EXPECT_FALSE(std::isfinite(compare_with_martin_moyce({}, a, g, fit).front));
}

}  // namespace
}  // namespace oilskin::demo
