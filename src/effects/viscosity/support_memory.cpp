#include "effects/viscosity/support_memory.h"

#include <cmath>

#include "core/clamped_part.h"

namespace oilskin::effects {

namespace {

/// The nodes of a body's surface that keep its numbers: those of its velocity and of its angular velocity,
/// like those of a node with a mass of 1, and as mean_drag what gravity takes back of loads [m/s²].
constexpr std::size_t linear = 0, angular = 1, taken_back = 2, nodes_of_body = 3;

bool has_memory(const SurfaceMotion& s) {
  return s.body && s.x_t1.size() >= nodes_of_body;
}

struct Memory {
  ChannelVectors drag;  // the impulse in this step [N s]
  ChannelVectors mean_drag, mean_support, last_velocity;
  Span<double> time;  // of the drag [s]

  Memory(EffectForces& f, std::size_t surface)
      : drag(ChannelVectors::of_nodes(f, surface, 0)),
        mean_drag(ChannelVectors::of_nodes(f, surface, 3)),
        mean_support(ChannelVectors::of_nodes(f, surface, 6)),
        last_velocity(ChannelVectors::of_nodes(f, surface, 9)),
        time(f.of_nodes(surface, 12)) {}

  void learn(std::size_t node, const Vec3& velocity, double inverse_mass) const {
    if (time[node] > 0) {
      const double fresh = -std::expm1(-time[node] / memory_time);
      const Vec3 force = drag.get(node) / time[node],
                 held = (velocity - last_velocity.get(node)) / (time[node] * inverse_mass) - force;
      mean_drag.set(node, mean_drag.get(node) + fresh * (force - mean_drag.get(node)));
      mean_support.set(node, mean_support.get(node) + fresh * (held - mean_support.get(node)));
    }
    last_velocity.set(node, velocity);
    drag.set(node, Vec3::Zero());
    time[node] = 0;
  }
  void learn_body(const BodyMotion& body, bool is_first, double dt) const {
    if (is_first) {
      learn(linear, body.velocity, 1);
      learn(angular, body.angular_velocity, 1);
    } else {
      const Vec3 by_loads = (body.velocity - last_velocity.get(linear)) / time[linear];
      const Vec3 mean = mean_drag.get(taken_back);
      mean_drag.set(taken_back, mean - std::expm1(-dt / memory_time) *
                                           (clamped_part(-by_loads, body.gravity, 0, 1) - mean));
    }
    for (std::size_t node : {linear, angular}) time[node] += dt;
  }
  /// The force by which the host is expected to hold a node [N].
  Vec3 support(std::size_t node) const {
    return -clamped_part(-mean_support.get(node), mean_drag.get(node), 0, 1);
  }
  /// SupportMemory::given()
  Vec3 given(std::size_t node) const { return drag.get(node) + time[node] * support(node); }
  void add_drag(std::size_t node, const Vec3& more) const { drag.set(node, drag.get(node) + more); }
};

void learn_surface(EffectForces& f, std::size_t surface) {
  const SurfaceMotion& s = *f.surfaces[surface];
  const Memory memory(f, surface);
  if (has_memory(s)) {
    memory.learn_body(*s.body, f.is_first, f.dt);
    return;
  }
  f.for_each(s.x_t1.size(), [&](std::size_t i) {
    if (!(s.inverse_mass[i] > 0)) return;
    // Hosts move their nodes in straight lines through a step, whatever acts on them.
    if (f.is_first) memory.learn(i, (s.x_t1[i] - s.x_t0[i]) / f.dt, s.inverse_mass[i]);
    memory.time[i] += f.dt;
  });
}

}  // namespace

void SupportMemory::learn(EffectForces& forces) {
  for (std::size_t s = 0; s < forces.surfaces.size(); ++s) learn_surface(forces, s);
}

Vec3 SupportMemory::given(EffectForces& forces, std::size_t surface, std::uint32_t node) {
  return Memory(forces, surface).given(node);
}

void SupportMemory::record(EffectForces& forces, std::size_t surface, std::uint32_t node, const Vec3& drag) {
  Memory(forces, surface).add_drag(node, drag);
}

RigidVelocity SupportMemory::expected_of_body(EffectForces& forces, std::size_t surface) {
  const BodyMotion& body = *forces.surfaces[surface]->body;
  RigidVelocity velocity{body.velocity, body.angular_velocity};
  if (!has_memory(*forces.surfaces[surface])) return velocity;
  const Memory memory(forces, surface);
  velocity.linear += (memory.time[linear] - forces.dt) * memory.mean_drag.get(taken_back) +
                     forces.dt * memory.support(linear);
  velocity.angular += forces.dt * memory.support(angular);
  return velocity;
}

void SupportMemory::record_of_body(EffectForces& forces, std::size_t surface, const RigidVelocity& change) {
  if (!has_memory(*forces.surfaces[surface])) return;
  const Memory memory(forces, surface);
  memory.add_drag(linear, change.linear);
  memory.add_drag(angular, change.angular);
}

}  // namespace oilskin::effects
