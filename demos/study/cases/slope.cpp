/// Blocks of water on an incline of 30°, each with its slip law, as dry blocks would slide; and the film of a
/// viscous liquid that runs down an incline from rest.
#include <cmath>

#include "study/cases/case_table.h"
#include "study/cases/parts.h"

namespace oilskin::demo {
namespace {

// --- blocks. Gravity is inclined, so the floor is y = 0.

constexpr double angle = M_PI / 6;
constexpr double block_length = 0.032, block_height = 0.016, lane_width = 0.032;  // [m]
constexpr double landed = 0.12;                                                   // [s]

struct Lane {
  const char* name;
  SlipModel model;
  double friction;
  double acceleration;  // of a dry block, over g
  double height;        // [m]; 0: one layer. The upper layers of a higher block slide on one that sticks
};
const Lane lanes[] = {
    {"free slip", SlipModel::free, 0, std::sin(angle), block_height},
    {"Coulomb 0.3", SlipModel::coulomb, 0.3, std::sin(angle) - 0.3 * std::cos(angle), block_height},
    {"Coulomb 1, one layer", SlipModel::coulomb, 1, 0, 0}};

class Blocks : public Probe {
 public:
  void after_step(const Moment& now) override {
    const bool begins = now.t >= landed && from_ == 0;
    for (std::size_t k = 0; k < std::size(lanes); ++k) {
      const double speed = lane_speed(now.simulation.world(), k);
      if (begins) start_[k] = speed;
      end_[k] = speed;
      if (from_ > 0) impulse_[k] += impulse_on(now.simulation.body(k));
    }
    if (begins) from_ = now.t;
  }

  std::vector<Quantity> quantities(const Moment& end) override {
    std::vector<Quantity> all;
    for (std::size_t k = 0; k < std::size(lanes); ++k) {
      const Lane& lane = lanes[k];
      const double a = (end_[k] - start_[k]) / (end.t - from_), scale = earth * std::sin(angle);
      all.push_back({std::string(lane.name) + ": acceleration [m/s²]", a, earth * lane.acceleration,
                     lane.acceleration > 0 ? 0 : scale, 0, 0.03});
      if (lane.acceleration > 0)
        all.push_back({std::string(lane.name) + ": tangential / normal impulse",
                       impulse_[k].x() / -impulse_[k].y(), lane.friction, 1, 0, 0.01});
    }
    return all;
  }

 private:
  static double lane_speed(const World& world, std::size_t lane) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < world.particle_count(); ++i) {
      if (static_cast<std::size_t>(world.positions()[i].z() / lane_width) != lane) continue;
      sum += world.velocities()[i].x();
      ++count;
    }
    return sum / count;
  }

  double from_ = 0;
  double start_[std::size(lanes)] = {}, end_[std::size(lanes)] = {};
  Vec3 impulse_[std::size(lanes)] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
};

Scene blocks_at(double spacing) {
  Scene scene = empty_scene(spacing, 0.35);
  scene.world.gravity = earth * Vec3(std::sin(angle), -std::cos(angle), 0);
  const double count = static_cast<double>(std::size(lanes));
  for (std::size_t k = 0; k < std::size(lanes); ++k) {
    const double z = static_cast<double>(k) * lane_width;
    Body floor = mesh_body(sheet_mesh({-0.2, 0, z}, {0, 0, lane_width}, {1.2, 0, 0}));
    floor.surface.slip = {lanes[k].model, lanes[k].friction, 0};
    scene.bodies.push_back(floor);
    const double height = lanes[k].height > 0 ? lanes[k].height : spacing;
    scene.emitters.push_back(water_box({0, 0, z}, {block_length, height, z + lane_width}));
  }
  Mesh sides;
  for (int k = 0; k <= static_cast<int>(count); ++k)
    append(sides, sheet_mesh({-0.2, -0.1, k * lane_width}, {1.2, 0, 0}, {0, 0.3, 0}));
  scene.bodies.push_back(mesh_body(sides));
  return scene;
}

// --- the film

constexpr double film_depth = 0.016, film_length = 0.16, film_width = 0.02;  // [m]
constexpr double film_viscosity = 3e-3;                                      // [m²/s]

/// (F.51) of a channel of twice the depth.
double film_speed(double y, double t) {
  const double along = earth * std::sin(angle);
  double v = along / film_viscosity * y * (film_depth - 0.5 * y);
  for (int n = 0; n < 200; ++n) {
    const double k = (2 * n + 1) * M_PI / (2 * film_depth);
    v -= 2 * along / (film_viscosity * film_depth * k * k * k) * std::sin(k * y) *
         std::exp(-film_viscosity * k * k * t);
  }
  return v;
}

class Film : public Probe {
 public:
  void after_step(const Moment&) override {}

  std::vector<Quantity> quantities(const Moment& end) override {
    const World& world = end.simulation.world();
    const double middle = mean_position(world).x(), spacing = end.scene.fluid.spacing;
    double top = 0, top_exact = 0, squares = 0, count = 0;
    for (std::size_t i = 0; i < world.particle_count(); ++i) {
      const Vec3& x = world.positions()[i];
      if (std::abs(x.x() - middle) > 0.15 * film_length) continue;
      const double v = world.velocities()[i].x(), exact = film_speed(x.y(), end.t);
      squares += (v - exact) * (v - exact);
      ++count;
      if (x.y() < film_depth - spacing) continue;
      top += v;
      top_exact += exact;
    }
    const double largest = film_speed(film_depth, end.t);
    return {{"speed of the top / exact", top / top_exact, 1, 0, 0.01, 0.1, 1},
            {"rms difference / largest speed", std::sqrt(squares / count) / largest, 0, 1, 0.01, 0.1, 1}};
  }
};

Scene film_at(double spacing) {
  Scene scene = empty_scene(spacing, 0.06);
  scene.dt = 0.1 * spacing;
  scene.fluid.viscosity = film_viscosity;
  scene.fluid.xsph_rate = 0;
  scene.world.gravity = earth * Vec3(std::sin(angle), -std::cos(angle), 0);
  Body floor = mesh_body(sheet_mesh({-0.2, 0, -0.02}, {0, 0, film_width + 0.04}, {1, 0, 0}));
  floor.surface.slip.model = SlipModel::sticking;
  Mesh sides;
  for (const double z : {0.0, film_width}) append(sides, sheet_mesh({-0.2, -0.1, z}, {1, 0, 0}, {0, 0.3, 0}));
  scene.bodies = {floor, mesh_body(sides)};
  scene.emitters = {water_box({0, 0, 0}, {film_length, film_depth, film_width})};
  return scene;
}

}  // namespace

ValidationCase slope_case() {
  return {"slope",        "blocks of water on an incline of 30° with three slip laws",
          "dry friction", {0.008, 0.004, 0.002},
          blocks_at,      [](const Scene&) { return std::make_unique<Blocks>(); }};
}

ValidationCase film_case() {
  return {"film",
          "a viscous film runs down an incline of 30° from rest, no slip",
          "series (F.51) of a channel of twice the depth",
          {0.004, 0.002, 0.001},
          film_at,
          [](const Scene&) { return std::make_unique<Film>(); }};
}

}  // namespace oilskin::demo
