/// A film without friction that a half pipe turns by 180° leaves with the energy that it came with.
///
/// In the pipe it is shallow water under the gravity v²/R, in which waves travel at c = v √(depth/R). So its
/// ends spread as those of a dam that breaks: the tip leaves at up to v + 2 c, the tail at v − 2 c or more,
/// and the run lasts until that has left. The mean speed, and with it the impulse on the pipe, are smaller
/// than those of a film without ends.
#include <cmath>

#include "study/cases/case_table.h"
#include "study/cases/parts.h"

namespace oilskin::demo {
namespace {

constexpr double radius = 0.05, depth = 0.01, speed = 2;  // [m], [m], [m/s]
constexpr double length = 0.15, breadth = 0.04;           // of the film, of the pipe [m]
constexpr double approach = 0.05;                         // from the film's tip to the pipe [m]
constexpr int facets = 24;
constexpr double room = 4;  // for the tip on its way out [m]

class Turn : public Probe {
 public:
  void after_step(const Moment& now) override {
    if (start_ == 0) start_ = now.simulation.world().fluid_mass() * speed;
    impulse_ += impulse_on(now.simulation.body(0));
  }

  std::vector<Quantity> quantities(const Moment& end) override {
    const World& world = end.simulation.world();
    double left = 0, squares = 0;
    for (std::size_t i = 0; i < world.particle_count(); ++i) {
      const Vec3 &x = world.positions()[i], &v = world.velocities()[i];
      left += x.x() < -0.5 * approach && v.x() < 0;
      squares += v.squaredNorm();
    }
    const double all = static_cast<double>(world.particle_count());
    return {
        {"fraction of the film that has left", left / all, 1, 0, 0, 0.01},
        {"rms speed at the exit / speed at the entry", std::sqrt(squares / all) / speed, 1, 0, 0, 0.03, 1},
        {"impulse on the pipe / (2 m v)", impulse_.x() / (2 * start_), 1, 0, 0, 0.03, 1}};
  }

 private:
  double start_ = 0;  // momentum of the film [N s]
  Vec3 impulse_ = Vec3::Zero();
};

/// Open towards −x, with a sheet that leads to it and one that leads away.
Mesh pipe() {
  Mesh mesh;
  std::vector<Vec3> line = {Vec3(-room, -radius, 0)};
  for (int k = 0; k <= facets; ++k) {
    const double turned = M_PI * k / facets - M_PI / 2;
    line.push_back({radius * std::cos(turned), radius * std::sin(turned), 0});
  }
  line.push_back(Vec3(-room, radius, 0));
  for (const Vec3& x : line)
    for (const double z : {-0.01, breadth + 0.01}) mesh.vertices.push_back({x.x(), x.y(), z});
  for (std::uint32_t a = 0; a + 2 < mesh.vertices.size(); a += 2) {
    mesh.triangles.push_back({a, a + 1, a + 3});
    mesh.triangles.push_back({a, a + 3, a + 2});
  }
  return mesh;
}

Scene scene_at(double spacing) {
  const double slowest = speed * (1 - 2 * std::sqrt(depth / radius));
  Scene scene = empty_scene(spacing, (length + approach) / speed + M_PI * radius / slowest + 0.1);
  scene.world.kill_box.min.x() = -room;
  scene.dt = 0.1 * spacing;
  scene.world.gravity = Vec3::Zero();
  scene.fluid.xsph_rate = 0;
  Body turn = mesh_body(pipe());
  turn.surface.smooth = true;
  Mesh sides;
  for (const double z : {0.0, breadth})
    append(sides, sheet_mesh({-room, -0.1, z}, {room + 0.2, 0, 0}, {0, 0.2, 0}));
  scene.bodies = {turn, mesh_body(sides)};
  FilledBox film = water_box({-approach - length, -radius, 0}, {-approach, depth - radius, breadth});
  film.velocity = Vec3(speed, 0, 0);
  scene.emitters = {film};
  return scene;
}

}  // namespace

ValidationCase half_pipe_case() {
  return {"half_pipe",
          "a half pipe of 24 facets turns a film of 10 mm without friction by 180°",
          "energy and momentum of an inviscid film",
          {0.005, 0.0033333333, 0.0025},
          scene_at,
          [](const Scene&) { return std::make_unique<Turn>(); }};
}

}  // namespace oilskin::demo
