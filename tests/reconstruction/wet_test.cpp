// Mode `wet`: the mesh touches an obstacle where it is wet, keeps the gap where it is dry, and has no step
// between them.
#include <gtest/gtest.h>

#include <cmath>

#include "reconstruction/promise.h"

namespace oilskin {
namespace {

using test::position;
using test::WaterScene;

/// The layer lies on a tilted plane, so that the grid sees it at all heights.
constexpr double slope_x = 0.11, slope_y = 0.07;
double height(double x, double y) {
  return slope_x * x + slope_y * y;
}
/// Vertical over normal distance from the sheet.
const double stretch = std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);

/// Three layers of particles on a sheet of 12 × 8 cm, the lowest 0.9 spacings above it.
WaterScene layer() {
  WaterScene s;
  s.add_sheet(24, [](double u, double v) { return Vec3(0.12 * u, 0.08 * v, height(0.12 * u, 0.08 * v)); });
  for (int k = 0; k < 3; ++k)
    for (double y = 0.01; y < 0.07; y += s.spacing)
      for (double x = 0.01; x < 0.11; x += s.spacing)
        s.particles.push_back(Vec3(x, y, height(x, y) + (0.9 + k) * s.spacing * stretch));
  return s;
}

/// 1 up to x = 4 cm, 0 from 8 cm on.
double ramp(const Vec3& x) {
  return std::min(1.0, std::max(0.0, (0.08 - x.x()) / 0.04));
}

ReconstructionOptions options_for(const WaterScene& s, ObstacleMode mode, double cell = 0.5,
                                  double gap = 0.1) {
  return test::options_for(s, cell, gap, mode);
}

/// Is the vertex on the side that faces the sheet, away from the borders of the layer?
bool is_below(const WaterMesh& mesh, std::uint32_t v) {
  const Vec3 x = position(mesh, v), n(mesh.normals[v][0], mesh.normals[v][1], mesh.normals[v][2]);
  return x.x() > 0.018 && x.x() < 0.102 && x.y() > 0.018 && x.y() < 0.062 && n.z() < -0.3;
}

double above_sheet(const Vec3& x) {
  return (x.z() - height(x.x(), x.y())) / stretch;
}

/// Mean distance of the lower side from the sheet, low_x < x < high_x [m].
double mean_distance(const WaterMesh& mesh, double low_x, double high_x) {
  double sum = 0;
  int count = 0;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 x = position(mesh, v);
    if (!is_below(mesh, v) || x.x() < low_x || x.x() > high_x) continue;
    sum += above_sheet(x);
    ++count;
  }
  EXPECT_GT(count, 50);
  return sum / count;
}

/// The steepest edge of the lower side, relative to the sheet.
double steepest(const WaterMesh& mesh) {
  double steepest = 0;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (!is_below(mesh, a) || !is_below(mesh, b)) continue;
      const Vec3 e = position(mesh, b) - position(mesh, a);
      if (e.norm() < 2e-4) continue;
      steepest = std::max(
          steepest, std::abs(above_sheet(position(mesh, b)) - above_sheet(position(mesh, a))) / e.norm());
    }
  return steepest;
}

TEST(WetMesh, touches_the_sheet_over_its_wet_half_as_touch_and_keeps_the_gap_over_its_dry_half) {
  WaterScene s = layer();
  s.wet(ramp);
  for (const double cell : {0.5, 0.8}) {
    const auto mesh = [&](ObstacleMode mode) {
      return test::reconstruct(s.input(), options_for(s, mode, cell, 0.1));
    };
    const WaterMesh wet = mesh(ObstacleMode::wet), touch = mesh(ObstacleMode::touch),
                    gap = mesh(ObstacleMode::gap);
    const double at_wet = mean_distance(wet, 0.018, 0.05), at_dry = mean_distance(wet, 0.08, 0.102);
    RecordProperty("wet_half", std::to_string(at_wet / s.spacing));
    RecordProperty("dry_half", std::to_string(at_dry / s.spacing));
    EXPECT_LE(at_wet, mean_distance(touch, 0.018, 0.05) + 1e-7);
    EXPECT_GE(at_dry, mean_distance(gap, 0.08, 0.102) - 1e-7);
    EXPECT_GT(at_dry, at_wet + 0.1 * s.spacing) << "the two modes must differ here";
    test::expect_promise(s, wet, 0.1 * s.spacing);
  }
}

TEST(WetMesh, wet_all_over_is_touch_and_dry_or_unknown_is_gap_bit_by_bit) {
  WaterScene s = test::wavy_scene(false);
  const auto positions = [&](ObstacleMode mode) {
    return test::reconstruct(s.input(), options_for(s, mode)).positions;
  };
  const auto touch = positions(ObstacleMode::touch), gap = positions(ObstacleMode::gap);
  EXPECT_NE(touch, gap);
  EXPECT_EQ(positions(ObstacleMode::wet), gap) << "without saturations";
  for (const double saturation : {0.5, 1.0, 1.3, -1e-6, 0.0, 0.25}) {
    s.wet([=](const Vec3&) { return saturation; });
    EXPECT_EQ(positions(ObstacleMode::wet), saturation < 0.5 ? gap : touch) << saturation;
  }
  ReconstructionOptions options = options_for(s, ObstacleMode::wet);
  s.wet([](const Vec3&) { return 1; });
  options.touch_range = 0;
  EXPECT_EQ(test::reconstruct(s.input(), options).positions, gap) << "without a range nothing is drawn";
}

TEST(WetMesh, has_no_step_between_wet_and_dry) {
  WaterScene s = layer();
  s.wet(ramp);
  const auto steepest_of = [&](ObstacleMode mode, double blend) {
    ReconstructionOptions options = options_for(s, mode);
    options.wet_blend = blend;
    options.keep_volume = false;  // the fit moves the dry part of the lower side
    return steepest(test::reconstruct(s.input(), options));
  };
  const double alone = std::max(steepest_of(ObstacleMode::gap, 0.5), steepest_of(ObstacleMode::touch, 0.5)),
               blended = steepest_of(ObstacleMode::wet, 0.5), step = steepest_of(ObstacleMode::wet, 0);
  RecordProperty("steepest_edges",
                 std::to_string(alone) + " " + std::to_string(blended) + " " + std::to_string(step));
  // The transition is 1 cm long here, the lower side falls by 1.2 mm.
  EXPECT_LT(blended, alone + 1.5 * 1.2e-3 / 0.01);
  EXPECT_GT(step, alone + 0.3) << "without the transition there is one";
}

TEST(WetMesh, of_two_layers_the_wet_one_is_met_and_the_dry_one_is_not) {
  WaterScene s;
  const double floor = 0.0102, ceiling = 0.0291;
  for (const double z : {floor, ceiling})
    s.add_sheet(8, [=](double u, double v) { return Vec3(0.08 * u, 0.08 * v, z); });
  for (int k = 0; k < 3; ++k)
    for (double y = 0.01; y < 0.07; y += s.spacing)
      for (double x = 0.01; x < 0.07; x += s.spacing)
        s.particles.push_back(Vec3(x, y, floor + (0.9 + k) * s.spacing));
  s.wet([=](const Vec3& x) { return x.z() < 0.02 ? 1 : 0; });
  const auto thickness = [&](ObstacleMode mode, bool lower) {
    ReconstructionOptions options = options_for(s, mode);
    options.keep_volume = false;  // the fit moves all of the water's sides
    const WaterMesh mesh = test::reconstruct(s.input(), options);
    test::expect_promise(s, mesh, 0.1 * s.spacing);
    double nearest = 1;
    for (const auto& p : mesh.positions)
      nearest = std::min(nearest, lower ? double(p[2]) - floor : ceiling - double(p[2]));
    return nearest;
  };
  EXPECT_EQ(thickness(ObstacleMode::wet, true), thickness(ObstacleMode::touch, true));
  EXPECT_EQ(thickness(ObstacleMode::wet, false), thickness(ObstacleMode::gap, false));
  EXPECT_GT(thickness(ObstacleMode::gap, false), 0.3 * s.spacing);
  EXPECT_LT(thickness(ObstacleMode::touch, false), 0.2 * s.spacing);
}

/// Saturations of which neighbours differ by up to 1: worse than any cloth.
void wet_at_random(WaterScene& s, std::uint64_t seed) {
  test::Random random(seed);
  s.wet([&](const Vec3&) { return random.uniform(0, 1); });
}

TEST(WetMesh, keeps_the_promise_at_any_saturation) {
  std::uint64_t seed = 0;
  for (WaterScene s :
       {test::wavy_scene(true), test::wavy_scene(false), test::vee_scene(), test::crumple_scene()})
    for (const double cell : {0.5, 0.8}) {
      const bool at_random = (++seed / 2) % 2 == 0;  // for each scene at one of the cells
      if (at_random)
        wet_at_random(s, seed);
      else
        s.wet([](const Vec3& x) { return x.x() < 0.05 ? 1 : 0; });
      const double gap = at_random ? 0.1 : 0;
      ReconstructionOptions options = options_for(s, ObstacleMode::wet, cell, gap);
      options.smoothing_iterations = cell < 0.6 ? 6 : 0;
      SCOPED_TRACE(seed);
      test::expect_promise(s, test::reconstruct(s.input(), options), gap * s.spacing);
    }
}

TEST(WetMesh, does_not_depend_on_the_number_of_threads) {
  WaterScene s = test::crumple_scene();
  wet_at_random(s, 5);
  ReconstructionOptions options = options_for(s, ObstacleMode::wet, 0.8);
  options.threads = 1;
  const WaterMesh one = test::reconstruct(s.input(), options);
  for (const int threads : {2, 4}) {
    options.threads = threads;
    const WaterMesh mesh = test::reconstruct(s.input(), options);
    EXPECT_EQ(mesh.positions, one.positions);
    EXPECT_EQ(mesh.triangles, one.triangles);
  }
}

}  // namespace
}  // namespace oilskin
