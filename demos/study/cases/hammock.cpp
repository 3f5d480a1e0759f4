/// A trough of cloth between two rims, with water.
#include <algorithm>
#include <cmath>

#include "checks/pin_impulse.h"
#include "study/cases/case_table.h"
#include "study/cases/lintearia.h"
#include "study/cases/measures.h"
#include "study/cases/parts.h"

namespace oilskin::demo {
namespace {

constexpr double length = 0.24, gap = 0.7 * length, breadth = 0.04;  // [m]
// Of the water at the start [m²]. Filled to its rims the trough holds 0.155 L², and waves would spill.
constexpr double area = 0.11 * length * length;
constexpr int segments = 8;                       // of half the strip
constexpr double cell = 0.5 * length / segments;  // [m]
constexpr double areal_density = 0.5;             // [kg/m²]
constexpr double window = 0.4;                    // means over the end of the run [s]
constexpr int columns = 2 * segments + 1;         // nodes along the strip

TroughShape start_shape() {
  const double weight = areal_density / (water_density * length);
  return trough_shape({gap / length, area / (length * length), weight}, segments);
}

/// Means over the rows of nodes that the water touches.
struct StripMeasures {
  double lowest = 0, length = 0, end_slope = 0;

  explicit StripMeasures(const SurfaceMotion& strip) {
    const std::vector<Vec3>& x = strip.x_t1;
    int rows = 0;
    for (std::size_t first = 0; first + columns <= x.size(); first += columns) {
      if (x[first].z() < 0 || x[first].z() > breadth) continue;
      ++rows;
      const auto row = x.begin() + static_cast<std::ptrdiff_t>(first);
      lowest += std::min_element(row, row + columns, [](const Vec3& a, const Vec3& b) {
                  return a.y() < b.y();
                })->y();
      for (int i = 0; i + 1 < columns; ++i) length += (row[i + 1] - row[i]).norm();
      for (const Vec3& end : {Vec3(row[columns - 1] - row[columns - 2]), Vec3(row[0] - row[1])})
        end_slope += 0.5 * end.y() / std::abs(end.x());
    }
    for (double* sum : {&lowest, &length, &end_slope}) *sum /= rows;
  }
};

class Shape : public Probe {
 public:
  void after_step(const Moment& now) override {
    pins_.after_step(now);
    const SurfaceMotion* strip = now.simulation.cloth(0);
    if (strip == nullptr) return;
    const World& world = now.simulation.world();
    if (!in_last(window, now)) {
      momentum_ = fluid_momentum(world).y();
      return;
    }
    const StripMeasures m(*strip);
    lowest_.add(m.lowest, now.dt);
    length_.add(m.length, now.dt);
    slope_.add(m.end_slope, now.dt);
    level_.add(level_within(world, {Vec3::Constant(-1), Vec3::Constant(1)}), now.dt);
    force_.add(pins_.last().y() / now.dt, now.dt);
    weight_.add((pins_.free_mass() + world.fluid_mass()) * earth, now.dt);
  }

  /// The reference is that of the strip as long as it is stretched, with the water that is in it. A sheet
  /// without stiffness pulls along itself, so the pull follows from the vertical reaction and the angle at
  /// the rims. That is measured over the last cell, which the water bends: the ratio of both slopes is that
  /// of the reference.
  std::vector<Quantity> quantities(const Moment& end) override {
    const double l = length_.value(),
                 water = depth_of(end.simulation.world(), end.simulation.world().fluid_mass(), breadth);
    const TroughShape exact =
        trough_shape({gap / l, water / (l * l), areal_density / (water_density * l)}, segments);
    // What the water's own momentum still changes does not hang on the rims.
    const double gained = (fluid_momentum(end.simulation.world()).y() - momentum_) / window;
    const Point2 &rim = exact.points.back(), &next = exact.points[exact.points.size() - 2];
    const double bend = std::tan(exact.end_angle) * (rim[0] - next[0]) / (rim[1] - next[1]);
    const double reaction = force_.value() - gained, pull = 0.5 * reaction / (slope_.value() * bend);
    const double exact_pull = 0.5 * weight_.value() / std::tan(exact.end_angle);
    return {{"depth of the water / L", (level_.value() - lowest_.value()) / l, exact.depth, 0, 0, 0.03, 1},
            {"sag / L", (rim_ - lowest_.value()) / l, exact.sag, 0, 0, 0.02, 1},
            {"horizontal pull [N]", pull, exact_pull, 0, 0, 0.05, 1},
            {"vertical reaction [N]", reaction, weight_.value(), 0, 0, 0.005},
            {"length / length at rest", l / length, 1, 0, 0, 0.01}};
  }

 private:
  double rim_ = length * start_shape().sag;  // height [m]
  PinImpulse pins_;
  double momentum_ = 0;                       // of the water, upwards, before the window [N s]
  TimeMean lowest_, length_, slope_, level_;  // [m], [m], , [m]
  TimeMean force_, weight_;                   // [N]
};

/// Cloth that goes on by a cell behind the walls at both ends.
Cloth strip_of(const std::vector<Point2>& line) {
  const int cells = static_cast<int>(std::lround(breadth / cell)) + 2;
  Cloth strip = mesh_cloth(swept_sheet(line, -cell, breadth + cell, cells), areal_density);
  strip.iterations = 10;
  const double side = 0.5 * gap - 0.01 * cell;
  pin(strip, {Vec3::Constant(-1), Vec3(-side, 1, 1)});
  pin(strip, {Vec3(side, -1, -1), Vec3::Constant(1)});
  return strip;
}

std::vector<Point2> below(const std::vector<Point2>& line, double level) {
  std::vector<Point2> wet;
  for (const Point2& p : line)
    if (p[1] < level) wet.push_back(p);
  const double right = wet.back()[0];
  wet.push_back({right, level});
  wet.push_back({-right, level});
  return wet;
}

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, 1);
  const TroughShape shape = start_shape();
  std::vector<Point2> line = shape.points;
  for (Point2& p : line) p = {length * p[0], length * p[1]};
  scene.cloth = {strip_of(line)};
  scene.emitters = {water_in(prism_mesh(below(line, length * shape.depth), 0, breadth))};
  for (const double z : {0.0, breadth})
    scene.bodies.push_back(
        mesh_body(sheet_mesh(Vec3(-gap, -0.5 * length, z), Vec3(2 * gap, 0, 0), Vec3(0, length, 0))));
  return scene;
}

}  // namespace

ValidationCase hammock_case() {
  return {
      "hammock",
      "trough of cloth, 240 mm from rim to rim along it, with water, between walls without friction",
      "the strip under hydrostatic pressure (lintearia), integrated for the water and the length of the run",
      {0.01, 0.005, 0.004},
      scene_at,
      [](const Scene&) { return std::make_unique<Shape>(); }};
}

}  // namespace oilskin::demo
