#include "sensor.h"

#include <algorithm>

#include "core/assert.h"
#include "shape_mesh.h"

namespace oilskin::bullet {

namespace {

double volume_of(const World& world, std::size_t particle) {
  const Span<const float> ratios = world.mass_ratios();
  const double ratio = ratios.empty() ? 1 : static_cast<double>(ratios[particle]);
  return ratio * world.particle_mass() / world.fluid_settings().rest_density;
}

}  // namespace

btFluidFlow& btFluidFlow::operator+=(const btFluidFlow& o) {
  m_entered += o.m_entered;
  m_left += o.m_left;
  m_passed += o.m_passed;
  m_appeared += o.m_appeared;
  m_vanished += o.m_vanished;
  m_enteredVolume += o.m_enteredVolume;
  m_leftVolume += o.m_leftVolume;
  return *this;
}

ParticlesBefore::ParticlesBefore(const World& world) {
  const Span<const std::uint64_t> ids = world.ids();
  sorted_.reserve(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) sorted_.emplace_back(ids[i], world.positions()[i]);
  std::sort(sorted_.begin(), sorted_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
}

std::vector<const Vec3*> ParticlesBefore::positions_of(const World& world) const {
  std::vector<const Vec3*> positions;
  positions.reserve(world.particle_count());
  for (const std::uint64_t id : world.ids()) {
    const auto it =
        std::lower_bound(sorted_.begin(), sorted_.end(), id,
                         [](const auto& entry, std::uint64_t value) { return entry.first < value; });
    positions.push_back(it != sorted_.end() && it->first == id ? &it->second : nullptr);
  }
  return positions;
}

bool Sensor::is_sensor(const btCollisionObject& object) {
  return object.getInternalType() != btCollisionObject::CO_SOFT_BODY && !object.hasContactResponse();
}

Status Sensor::read() {
  const btCollisionShape* shape = object_->getCollisionShape();
  if (!shape) return Status::refused("a sensor has no collision shape: call setCollisionShape() first");
  std::vector<double> signature = shape_signature(*shape);
  if (!region_ || signature != signature_) {
    region_ = ShapeRegion::of(*shape);
    signature_ = std::move(signature);
  }
  if (!region_)
    return Status::refused(
        "a sensor (CF_NO_CONTACT_RESPONSE) needs a shape with a volume: convex, or a compound of convex "
        "shapes");
  if (!inverse_of(object_->getWorldTransform()))
    return Status::refused("a sensor has a transform that is not finite, or that has no inverse");
  return Status::accepted();
}

void Sensor::begin(Span<World* const> worlds) {
  const bool is_first = !to_local_;
  if (is_first) to_local_ = inverse_of(object_->getWorldTransform());
  OILSKIN_ASSERT(inside_.size() <= worlds.size());
  while (inside_.size() < worlds.size()) {
    const World& world = *worlds[inside_.size()];
    Inside& inside = inside_.emplace_back();
    for (std::size_t i = 0; i < world.particle_count(); ++i)
      if (region_->contains(*to_local_ * world.positions()[i])) inside.push_back(world.ids()[i]);
    std::sort(inside.begin(), inside.end());
    if (!is_first) reading_.m_flow.m_appeared += inside.size();
  }
}

void Sensor::forget_fluid(std::size_t k, bool is_last) {
  if (k >= inside_.size()) return;
  if (is_last) {
    *this = Sensor(object_);
    return;
  }
  reading_.m_flow.m_vanished += inside_[k].size();
  inside_.erase(inside_.begin() + static_cast<std::ptrdiff_t>(k));
}

void Sensor::set_state(State state) {
  to_local_ = state.to_local;
  teleported_ = state.teleported;
  inside_ = std::move(state.inside);
  reading_ = state.reading;
}

btFluidFlow Sensor::end(Span<World* const> worlds, const std::vector<std::vector<const Vec3*>>& starts) {
  const Eigen::Affine3d now = *inverse_of(object_->getWorldTransform());
  const Eigen::Affine3d then = teleported_ ? now : *to_local_;
  OILSKIN_ASSERT(worlds.size() == inside_.size() && worlds.size() == starts.size());
  teleported_ = false;
  btFluidFlow flow;
  reading_.m_volume = 0;
  reading_.m_particles = 0;
  for (std::size_t k = 0; k < worlds.size(); ++k)
    add_flow_of(*worlds[k], starts[k], then, now, inside_[k], flow);
  to_local_ = now;
  reading_.m_flow += flow;
  return flow;
}

/// Particles whose path has no point of the region's box change nothing, but for those that were inside.
void Sensor::add_flow_of(const World& world, const std::vector<const Vec3*>& starts,
                         const Eigen::Affine3d& then, const Eigen::Affine3d& now, Inside& remembered,
                         btFluidFlow& flow) {
  OILSKIN_ASSERT(starts.size() == world.particle_count());
  Inside inside;
  std::size_t still_here = 0;  // of those inside before
  const Box bounds = region_->bounds();
  for (std::size_t i = 0; i < world.particle_count(); ++i) {
    const Vec3* start = starts[i];
    const Vec3 x_t1 = now * world.positions()[i];
    const Vec3 x_t0 = start ? Vec3(then * *start) : x_t1;
    const bool is_near = bounds.overlaps({x_t0.cwiseMin(x_t1), x_t0.cwiseMax(x_t1)});
    if (!is_near && remembered.empty()) continue;
    const std::uint64_t id = world.ids()[i];
    const bool was_remembered = std::binary_search(remembered.begin(), remembered.end(), id);
    if (!is_near && !was_remembered) continue;
    const double volume = volume_of(world, i);
    const bool was_inside = start && region_->contains(x_t0), is_inside = region_->contains(x_t1);
    still_here += was_remembered;
    flow.m_vanished += was_remembered && !was_inside;
    flow.m_appeared += start ? was_inside && !was_remembered : is_inside;
    const bool passed = start && !was_inside && !is_inside && region_->meets(x_t0, x_t1);
    const bool entered = start && ((!was_inside && is_inside) || passed);
    const bool left = (was_inside && !is_inside) || passed;
    flow.m_passed += passed;
    flow.m_entered += entered;
    flow.m_left += left;
    if (entered) flow.m_enteredVolume += volume;
    if (left) flow.m_leftVolume += volume;
    if (!is_inside) continue;
    inside.push_back(id);
    reading_.m_volume += volume;
  }
  flow.m_vanished += remembered.size() - still_here;
  std::sort(inside.begin(), inside.end());
  remembered = std::move(inside);
  reading_.m_particles += remembered.size();
}

}  // namespace oilskin::bullet
