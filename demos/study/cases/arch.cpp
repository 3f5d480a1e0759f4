/// A dry arch under water.
#include <cmath>

#include "study/cases/case_table.h"
#include "study/cases/measures.h"
#include "study/cases/parts.h"
#include "study/cases/shapes.h"

namespace oilskin::demo {
namespace {

constexpr double radius = 0.04, half_width = 0.08, depth = 0.1, breadth = 0.03;  // [m]
constexpr int segments = 32;
constexpr double settled = 0.4;  // [s]
constexpr double pi = 3.14159265358979323846;

/// From the foot at +radius over the top to that at −radius.
std::vector<Point2> arc() {
  std::vector<Point2> line;
  for (int i = 0; i <= segments; ++i)
    line.push_back({radius * std::cos(pi * i / segments), radius * std::sin(pi * i / segments)});
  return line;
}

/// Between the chords and the floor [m²].
double dry_area() {
  return 0.5 * segments * radius * radius * std::sin(pi / segments);
}

class Load : public Probe {
 public:
  void after_step(const Moment& now) override {
    if (now.t < settled) return;
    const Vec3 force = impulse_on(now.simulation.body(1)) / now.dt;
    down_.add(-force.y(), now.dt);
    sideways_.add(force.x(), now.dt);
  }

  std::vector<Quantity> quantities(const Moment& end) override {
    const World& world = end.simulation.world();
    const double area = depth_of(world, world.fluid_mass(), breadth) + dry_area();
    const double level = area / (2 * half_width);
    const double exact = water_density * earth * breadth * (2 * radius * level - dry_area());
    return {{"force down [N]", down_.value(), exact, 0, 0, 0.03},
            {"sideways force / force down", sideways_.value() / exact, 0, 1, 0, 0.03},
            {"particles inside", inside(world), 0, 1, 0, 0}};
  }

 private:
  static double inside(const World& world) {
    double count = 0;
    for (const Vec3& x : world.positions())
      count += x.y() > 0 && std::hypot(x.x(), x.y()) < radius * std::cos(0.5 * pi / segments) ? 1 : 0;
    return count;
  }

  TimeMean down_, sideways_;  // [N]
};

std::vector<Point2> water_outline() {
  std::vector<Point2> line = {{half_width, 0}, {half_width, depth}, {-half_width, depth}, {-half_width, 0}};
  const std::vector<Point2> arch = arc();
  line.insert(line.end(), arch.rbegin(), arch.rend());
  return line;
}

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, 0.8);
  scene.emitters = {water_in(prism_mesh(water_outline(), 0, breadth))};
  scene.bodies = {tank_body(Vec3(-half_width, 0, 0), Vec3(half_width, 1.5 * depth, breadth)),
                  mesh_body(swept_sheet(arc(), 0, breadth, 2))};
  return scene;
}

}  // namespace

ValidationCase arch_case() {
  return {"arch",
          "dry half cylinder of 40 mm radius on the floor under 100 mm of water",
          "hydrostatics: the weight of the water above it; depth from the mass of the water",
          {0.01, 0.005, 0.0025},
          scene_at,
          [](const Scene&) { return std::make_unique<Load>(); }};
}

}  // namespace oilskin::demo
