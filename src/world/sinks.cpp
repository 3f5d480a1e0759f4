/// Sinks of a world, and the age at which particles end.
#include "world/sinks.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/refuse.h"
#include "core/region_archive.h"
#include "world/world_impl.h"

namespace oilskin {

namespace world {

bool Sinks::act() const {
  return std::any_of(list_.begin(), list_.end(), [](const Sink& s) { return s.enabled; });
}

std::uint32_t Sinks::find(const Vec3& x) const {
  for (std::size_t k = 0; k < list_.size(); ++k)
    if (list_[k].enabled && list_[k].region.contains(x)) return static_cast<std::uint32_t>(k);
  return none;
}

void Sinks::take(std::uint32_t sink, double mass_ratio) {
  OILSKIN_ASSERT(sink < list_.size());
  ++list_[sink].particles;
  list_[sink].mass_ratio += mass_ratio;
}

Status Sinks::add(const Region& region, std::uint64_t* id) {
  if (Status s = region.validate(); !s.ok()) return s;
  Sink sink;
  sink.id = next_id_;
  sink.region = region;
  list_.push_back(std::move(sink));
  ++next_id_;
  if (id) *id = list_.back().id;
  return {};
}

Sinks::Sink* Sinks::with_id(std::uint64_t id) {
  const auto it = std::find_if(list_.begin(), list_.end(), [id](const Sink& s) { return s.id == id; });
  return it == list_.end() ? nullptr : &*it;
}

const Sinks::Sink* Sinks::with_id(std::uint64_t id) const {
  return const_cast<Sinks*>(this)->with_id(id);
}

bool Sinks::remove(std::uint64_t id) {
  const Sink* sink = with_id(id);
  if (sink) list_.erase(list_.begin() + (sink - list_.data()));
  return sink != nullptr;
}

void Sinks::visit(Archive& archive) {
  constexpr std::size_t min_bytes = 80;  // of a region that is all of space
  archive.value(next_id_);
  std::uint64_t last = 0;
  archive.list(list_, min_bytes, [&](Sink& sink) {
    auto& [id, region, enabled, particles, mass_ratio] = sink;
    archive.value(id);
    oilskin::visit(archive, region);
    archive.values(enabled, particles, mass_ratio);
    archive.require(id > last && id < next_id_, "the handle of a sink");
    archive.require(mass_ratio >= 0 && std::isfinite(mass_ratio), "what a sink has taken");
    last = id;
  });
}

}  // namespace world

namespace {

Status no_sink(SinkId id) {
  return refuse("there is no sink ", id.value);
}

Status check_age(double seconds) {
  return seconds > 0 ? Status() : refuse_value("max_age", seconds, "> 0 s; infinity for no limit");
}

}  // namespace

Status World::add_sink(const Region& region, SinkId* id) {
  if (!impl_->status.ok()) return impl_->status;
  return impl_->state.sinks.add(region, id ? &id->value : nullptr);
}

Status World::set_sink_region(SinkId id, const Region& region) {
  world::Sinks::Sink* sink = impl_->state.sinks.with_id(id.value);
  if (!sink) return no_sink(id);
  if (Status s = region.validate(); !s.ok()) return s;
  sink->region = region;
  return {};
}

Status World::move_sink(SinkId id, const EmitterPose& pose) {
  const world::Sinks::Sink* sink = impl_->state.sinks.with_id(id.value);
  if (!sink) return no_sink(id);
  Region moved = sink->region;
  moved.pose = pose;
  return set_sink_region(id, moved);
}

Status World::set_sink_enabled(SinkId id, bool enabled) {
  world::Sinks::Sink* sink = impl_->state.sinks.with_id(id.value);
  if (!sink) return no_sink(id);
  sink->enabled = enabled;
  return {};
}

bool World::remove_sink(SinkId id) {
  return impl_->state.sinks.remove(id.value);
}

std::optional<SinkState> World::sink(SinkId id) const {
  const world::Sinks::Sink* sink = impl_->state.sinks.with_id(id.value);
  if (!sink) return {};
  SinkState state;
  state.region = sink->region;
  state.enabled = sink->enabled;
  state.particles = sink->particles;
  state.volume = sink->mass_ratio * particle_mass() / fluid_settings().rest_density;
  return state;
}

Status World::set_max_age(double seconds) {
  if (!impl_->status.ok()) return impl_->status;
  if (Status s = check_age(seconds); !s.ok()) return s;
  fluid::Particles& particles = impl_->state.particles;
  if (std::isinf(seconds) && !particles.ends) return {};
  particles.let_end();
  const double end = time() + seconds;
  for (double& t : particles.end_time) t = end;
  impl_->state.max_age = seconds;
  return {};
}

double World::max_age() const {
  return impl_->state.max_age;
}

Status World::set_emitter_max_age(EmitterId id, double seconds) {
  if (!impl_->status.ok()) return impl_->status;
  if (Status s = check_age(seconds); !s.ok()) return s;
  Status status = impl_->emission->set_max_age(id.value, seconds);
  if (status.ok() && !std::isinf(seconds)) impl_->state.particles.let_end();
  return status;
}

/// Whether the particle ends in a sink, or by age.
bool World::Impl::takes(world::IntervalContext& interval, std::size_t particle, world::EndSums& sums) const {
  const fluid::Particles& particles = state.particles;
  if (!interval.taken_by.empty()) {
    std::uint32_t& sink = interval.taken_by[particle];
    sink = state.sinks.find(particles.position[particle]);
    if (sink != world::Sinks::none) return true;
  }
  if (!particles.ends) return false;
  const double now = interval.begin + interval.dt, rounding = 1e-9 * interval.dt;
  if (particles.end_time[particle] > now + rounding) return false;
  ++sums.removed_by_age;
  return true;
}

/// Those with keep = 0 that a sink has taken.
void World::Impl::count_taken(world::IntervalContext& interval, Span<const std::uint8_t> keep) {
  for (std::size_t i = 0; i < interval.taken_by.size(); ++i) {
    const std::uint32_t sink = interval.taken_by[i];
    if (keep[i] || sink == world::Sinks::none) continue;
    state.sinks.take(sink, state.particles.relative_mass(i));
    ++interval.step.report.removed_by_sinks;
  }
}

}  // namespace oilskin
