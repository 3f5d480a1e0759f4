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
  NodeVectors last_drag, mean_drag, mean_support, last_velocity;

  Memory(EffectForces& f, std::size_t surface)
      : last_drag(f, surface, 0),
        mean_drag(f, surface, 3),
        mean_support(f, surface, 6),
        last_velocity(f, surface, 9) {}
};

void learn_surface(EffectForces& f, std::size_t surface) {
  const SurfaceMotion& s = *f.surfaces[surface];
  const Memory memory(f, surface);
  const double fresh = -std::expm1(-f.dt / memory_time);
  f.for_each(s.x_t1.size(), [&](std::size_t i) {
    if (!(s.inverse_mass[i] > 0)) return;
    const Vec3 velocity = (s.x_t1[i] - s.x_t0[i]) / f.dt, drag = memory.last_drag.get(i);
    const Vec3 support = (velocity - memory.last_velocity.get(i)) / (f.dt * s.inverse_mass[i]) - drag;
    const Vec3 mean_drag = memory.mean_drag.get(i), mean_support = memory.mean_support.get(i);
    memory.mean_drag.set(i, mean_drag + fresh * (drag - mean_drag));
    memory.mean_support.set(i, mean_support + fresh * (support - mean_support));
    memory.last_velocity.set(i, velocity);
    memory.last_drag.set(i, Vec3::Zero());
  });
}

}  // namespace

void SupportMemory::learn(EffectForces& forces) {
  for (std::size_t s = 0; s < forces.surfaces.size(); ++s) learn_surface(forces, s);
}

Vec3 SupportMemory::support(EffectForces& forces, std::size_t surface, std::uint32_t node) {
  const Memory memory(forces, surface);
  const Vec3 drag = memory.mean_drag.get(node);
  const double square = drag.squaredNorm();
  if (!(square > 0)) return Vec3::Zero();
  return -std::clamp(-memory.mean_support.get(node).dot(drag) / square, 0.0, 1.0) * drag;
}

void SupportMemory::record(EffectForces& forces, std::size_t surface, std::uint32_t node, const Vec3& drag) {
  Memory(forces, surface).last_drag.set(node, drag);
}

}  // namespace oilskin::effects
