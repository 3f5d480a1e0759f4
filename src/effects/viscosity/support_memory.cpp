#include "effects/viscosity/support_memory.h"

#include <algorithm>
#include <cmath>

namespace oilskin::effects {

namespace {

/// t_s of (V.10) [s].
constexpr double memory_time = 0.02;

/// Three channels of the nodes of a surface, as vectors.
class NodeVectors {
 public:
  NodeVectors(EffectForces& f, std::size_t surface, std::size_t first)
      : component_{f.of_nodes(surface, first), f.of_nodes(surface, first + 1),
                   f.of_nodes(surface, first + 2)} {}

  Vec3 get(std::size_t node) const { return {component_[0][node], component_[1][node], component_[2][node]}; }
  void set(std::size_t node, const Vec3& v) const {
    const bool finite = v.allFinite();  // the world saves them
    for (std::size_t c = 0; c < 3; ++c) component_[c][node] = finite ? v[static_cast<Eigen::Index>(c)] : 0;
  }

 private:
  std::array<Span<double>, 3> component_;
};

struct Memory {
  NodeVectors drag;  // the impulse in this step [N s]
  NodeVectors mean_drag, mean_support, last_velocity;
  Span<double> time;  // of the drag [s]

  Memory(EffectForces& f, std::size_t surface)
      : drag(f, surface, 0),
        mean_drag(f, surface, 3),
        mean_support(f, surface, 6),
        last_velocity(f, surface, 9),
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
  /// The force by which the host is expected to hold a node [N].
  Vec3 support(std::size_t node) const {
    const Vec3 mean = mean_drag.get(node);
    const double square = mean.squaredNorm();
    if (!(square > 0)) return Vec3::Zero();
    return -std::clamp(-mean_support.get(node).dot(mean) / square, 0.0, 1.0) * mean;
  }
};

void learn_surface(EffectForces& f, std::size_t surface) {
  const SurfaceMotion& s = *f.surfaces[surface];
  const Memory memory(f, surface);
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
  const Memory memory(forces, surface);
  return memory.drag.get(node) + memory.time[node] * memory.support(node);
}

void SupportMemory::record(EffectForces& forces, std::size_t surface, std::uint32_t node, const Vec3& drag) {
  const Memory memory(forces, surface);
  memory.drag.set(node, memory.drag.get(node) + drag);
}

}  // namespace oilskin::effects
