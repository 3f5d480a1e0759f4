#include "fluid/boundary/load_memory.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

/// t_m of (B.26) [s]. A shorter mean follows the oscillations of the host, and the water rebounds; a longer
/// one follows a load that is gone, and the water is compressed more.
constexpr double memory_time = 0.1;

double weight_of_new_value(double dt) {
  return -std::expm1(-dt / memory_time);
}

}  // namespace

void LoadMemory::prepare(Span<SurfaceMotion* const> surfaces) {
  for (const SurfaceMotion* s : surfaces) {
    if (s->still != 0) {
      of_surface_.erase(s->id);
      continue;
    }
    std::vector<NodeMemory>& nodes = of_surface_[s->id];
    if (nodes.size() != s->x_t0.size()) nodes.assign(s->x_t0.size(), {});
  }
}

void LoadMemory::forget_others(Span<SurfaceMotion* const> surfaces) {
  for (auto it = of_surface_.begin(); it != of_surface_.end();) {
    const bool is_present = std::any_of(surfaces.begin(), surfaces.end(),
                                        [&](const SurfaceMotion* s) { return s->id == it->first; });
    it = is_present ? std::next(it) : of_surface_.erase(it);
  }
}

std::vector<LoadMemory::NodeMemory>* LoadMemory::find(const SurfaceMotion& surface) {
  if (surface.still != 0) return nullptr;
  const auto found = of_surface_.find(surface.id);
  return found != of_surface_.end() && found->second.size() == surface.velocity.size() ? &found->second
                                                                                       : nullptr;
}

void LoadMemory::record_host_response(double dt, const Vec3& gravity, Span<SurfaceMotion* const> surfaces) {
  forget_others(surfaces);
  const double fresh = weight_of_new_value(dt);
  for (const SurfaceMotion* s : surfaces) {
    std::vector<NodeMemory>* nodes = find(*s);
    if (nodes == nullptr) continue;
    for (std::size_t i = 0; i < nodes->size(); ++i) {
      if (s->inverse_mass[i] == 0) continue;
      NodeMemory& m = (*nodes)[i];
      const Vec3 force = ((s->velocity[i] - m.velocity_left) / dt - gravity) / s->inverse_mass[i];
      m.response += fresh * (force - m.response);
    }
  }
}

void LoadMemory::record_load(double dt, Span<SurfaceMotion* const> surfaces) {
  const double fresh = weight_of_new_value(dt);
  for (const SurfaceMotion* s : surfaces) {
    std::vector<NodeMemory>* nodes = find(*s);
    if (nodes == nullptr) continue;
    for (std::size_t i = 0; i < nodes->size(); ++i) {
      NodeMemory& m = (*nodes)[i];
      m.velocity_left = s->velocity[i];
      m.load += fresh * (s->impulse[i] / dt - m.load);
    }
  }
}

Vec3 LoadMemory::carried_impulse(std::uint64_t surface_id, std::uint32_t node, double dt) const {
  OILSKIN_ASSERT(of_surface_.count(surface_id) == 1 && dt > 0);
  const NodeMemory& m = of_surface_.at(surface_id)[node];
  const double load2 = m.load.squaredNorm();
  if (!(load2 > 0)) return Vec3::Zero();
  const double carried = std::clamp(-m.response.dot(m.load) / load2, 0.0, 1.0);  // χ_c (B.27)
  return carried * dt * m.load;
}

void LoadMemory::visit(Archive& archive) {
  std::vector<std::uint64_t> ids;
  for (const auto& [id, nodes] : of_surface_) ids.push_back(id);
  archive.value(ids);
  for (std::uint64_t id : ids)
    archive.list(of_surface_[id], sizeof(NodeMemory),
                 [&](NodeMemory& m) { archive.values(m.velocity_left, m.load, m.response); });
}

}  // namespace oilskin::fluid
