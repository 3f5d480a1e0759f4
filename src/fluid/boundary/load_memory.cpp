#include "fluid/boundary/load_memory.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/body_motion.h"
#include "core/unit_vector.h"

namespace oilskin::fluid {

namespace {

/// t_m of (B.26) [s]. A shorter mean follows the oscillations of the host, and the water rebounds; a longer
/// one follows a load that is gone, and the water is compressed more.
constexpr double memory_time = 0.1;

/// A host that lets a fifth of loads move the body, as a soft spring does, takes up none at once (B.45).
constexpr double doubt = 5;

double weight_of_new_value(double dt) {
  return -std::expm1(-dt / memory_time);
}

/// Along the axes that the host does not lock [kg].
Vec3 mass_of(const BodyMotion& body) {
  return (body.inverse_mass.array() > 0).select(body.inverse_mass.cwiseInverse(), 0);
}

/// A body has two: of its centre of mass, and of its rotation.
std::size_t memories_of(const SurfaceMotion& s) {
  return s.body ? 2 : s.x_t0.size();
}

}  // namespace

void LoadMemory::prepare(Span<SurfaceMotion* const> surfaces) {
  for (const SurfaceMotion* s : surfaces) {
    if (s->still != 0) {
      of_surface_.erase(s->id);
      continue;
    }
    std::vector<NodeMemory>& nodes = of_surface_[s->id];
    if (nodes.size() != memories_of(*s)) nodes.assign(memories_of(*s), {});
  }
}

void LoadMemory::forget_others(Span<SurfaceMotion* const> surfaces) {
  std::vector<std::uint64_t> present;
  for (const SurfaceMotion* s : surfaces) present.push_back(s->id);
  std::sort(present.begin(), present.end());
  for (auto it = of_surface_.begin(); it != of_surface_.end();) {
    const bool is_present = std::binary_search(present.begin(), present.end(), it->first);
    it = is_present ? std::next(it) : of_surface_.erase(it);
  }
}

const std::vector<LoadMemory::NodeMemory>* LoadMemory::find(const SurfaceMotion& surface) const {
  if (surface.still != 0) return nullptr;
  const auto found = of_surface_.find(surface.id);
  return found != of_surface_.end() && found->second.size() == memories_of(surface) ? &found->second
                                                                                    : nullptr;
}

void LoadMemory::record_host_response(double dt, const Vec3& gravity, Span<SurfaceMotion* const> surfaces) {
  forget_others(surfaces);
  const double fresh = weight_of_new_value(dt);
  for (const SurfaceMotion* s : surfaces) {
    std::vector<NodeMemory>* nodes = find(*s);
    if (nodes == nullptr) continue;
    if (s->body) {
      const Vec3 mass = mass_of(*s->body);
      NodeMemory &center = (*nodes)[0], &rotation = (*nodes)[1];
      if (!(center.weight > 0)) continue;
      const double f = center.fresh_of_body(fresh);
      const Vec3 response =
          mass.cwiseProduct((s->body->velocity - center.velocity_left) / dt - s->body->gravity);
      center.respond(f, response);
      center.respond_to_push(f, response.dot(unit_or_zero(s->body->gravity)));
      rotation.respond(rotation.fresh_of_body(fresh),
                       inertia_of(*s->body) * (s->body->angular_velocity - rotation.velocity_left) / dt);
      continue;
    }
    for (std::size_t i = 0; i < nodes->size(); ++i) {
      if (s->inverse_mass[i] == 0) continue;
      NodeMemory& m = (*nodes)[i];
      const Vec3 force = ((s->velocity[i] - m.velocity_left) / dt - gravity) / s->inverse_mass[i];
      m.respond(fresh, force);
    }
  }
}

void LoadMemory::record_load(double dt, Span<SurfaceMotion* const> surfaces,
                             Span<const std::vector<Vec3>> of_others) {
  OILSKIN_ASSERT(of_others.empty() || of_others.size() == surfaces.size());
  const double fresh = weight_of_new_value(dt);
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const SurfaceMotion& s = *surfaces[k];
    std::vector<NodeMemory>* nodes = find(s);
    if (nodes == nullptr) continue;
    const Span<const Vec3> others = of_others.empty() ? Span<const Vec3>() : Span<const Vec3>(of_others[k]);
    OILSKIN_ASSERT(others.empty() || others.size() == s.x_t0.size());
    if (s.body) {
      Vec3 impulse = Vec3::Zero(), moment = Vec3::Zero();
      for (std::size_t i = 0; i < others.size(); ++i) {
        impulse += others[i];
        moment += (s.x_t0[i] - s.body->center_t0).cross(others[i]);
      }
      (*nodes)[0].record_body(fresh, s.body->velocity, s.body->impulse / dt, impulse / dt);
      const Vec3 all = s.body->impulse / dt + mass_of(*s.body).cwiseProduct(s.body->gravity);
      (*nodes)[0].pushed = all.dot(unit_or_zero(s.body->gravity));
      (*nodes)[1].record_body(fresh, s.body->angular_velocity, s.body->angular_impulse / dt, moment / dt);
      continue;
    }
    for (std::size_t i = 0; i < nodes->size(); ++i)
      (*nodes)[i].record(fresh, s.velocity[i], s.impulse[i] / dt,
                         others.empty() ? Vec3::Zero() : Vec3(others[i] / dt));
  }
}

Vec3 LoadMemory::carried_impulse(std::uint64_t surface_id, std::uint32_t node, double dt) const {
  OILSKIN_ASSERT(of_surface_.count(surface_id) == 1 && dt > 0);
  const NodeMemory& m = of_surface_.at(surface_id)[node];
  return m.without_others(m.carried(dt), dt);
}

/// Along gravity the host carries at most load and weight together, across it a share of the load.
Vec3 LoadMemory::NodeMemory::carried_with_weight(double dt, const Vec3& gravity_force) const {
  if (gravity_force.isZero(0)) return carried(dt);
  const Vec3 down = gravity_force.normalized();
  const double all = (load + gravity_force).dot(down), support = -response.dot(down);
  const double along = std::clamp(support, std::min(0.0, all), std::max(0.0, all));
  NodeMemory across = *this;
  across.load -= across.load.dot(down) * down;
  return dt * along * down + across.carried(dt);
}

LoadMemory::OfBody LoadMemory::carried_of_body(const SurfaceMotion& surface, double passed, double dt) const {
  OILSKIN_ASSERT(surface.body && of_surface_.count(surface.id) == 1 && dt > 0 && passed >= dt);
  const std::vector<NodeMemory>& m = of_surface_.at(surface.id);
  const Vec3 weight = mass_of(*surface.body).cwiseProduct(surface.body->gravity);
  return {m[0].without_others(m[0].carried_with_weight(passed, weight), dt),
          m[1].without_others(m[1].carried(passed), dt), m[0].firmness()};
}

double LoadMemory::NodeMemory::firmness() const {
  return pushed2 > 0 ? std::max(0.0, 1 - doubt * std::sqrt(moved2 / pushed2)) : 0;
}

Vec3 LoadMemory::NodeMemory::without_others(Vec3 carried, double dt) const {
  if (!of_others.isZero(0)) carried -= dt * of_others;
  return carried;
}

Vec3 LoadMemory::NodeMemory::carried(double dt, const Vec3& constant) const {
  const double load2 = load.squaredNorm();
  if (!(load2 > 0)) return Vec3::Zero();
  const double share = std::clamp(-(response + constant).dot(load) / load2, 0.0, 1.0);
  return share * dt * load;
}

void LoadMemory::find_carried(const SurfaceMotion& surface, double dt, std::vector<Vec3>& change) const {
  change.clear();
  const std::vector<NodeMemory>* nodes = find(surface);
  if (nodes == nullptr) return;
  if (surface.body) {
    const BodyMotion& body = *surface.body;
    change = {
        body.inverse_mass.cwiseProduct((*nodes)[0].carried(dt, mass_of(body).cwiseProduct(body.gravity))),
        body.inverse_inertia * (*nodes)[1].carried(dt)};
    return;
  }
  for (std::size_t i = 0; i < nodes->size(); ++i)
    change.push_back(surface.inverse_mass[i] * (*nodes)[i].carried(dt));
}

void LoadMemory::visit(Archive& archive) {
  std::vector<std::uint64_t> ids;
  for (const auto& [id, nodes] : of_surface_) ids.push_back(id);
  archive.value(ids);
  for (std::uint64_t id : ids)
    archive.list(of_surface_[id], sizeof(NodeMemory), [&](NodeMemory& m) {
      archive.values(m.velocity_left, m.load, m.of_others, m.response, m.weight, m.pushed, m.pushed2,
                     m.moved2);
    });
}

}  // namespace oilskin::fluid
