#include "fluid/emission/emission.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/refuse.h"
#include "fluid/emission/make_source.h"

namespace oilskin::fluid {

namespace {

/// An emitter that has ended, of which the user has the handle.
struct Ended {
  std::uint64_t id, emitted;
};

Status check_pose(const EmitterPose& pose) {
  if (Status s = check_point("emitter: position", pose.position); !s.ok()) return s;
  const double norm = pose.rotation.norm();
  return norm > 0 && std::isfinite(norm)
             ? Status()
             : refuse_value("emitter: rotation", pose.rotation.coeffs().transpose(),
                            "finite and longer than 0");
}

EmitterPose normalized(const EmitterPose& pose) {
  return {pose.position, pose.rotation.normalized()};
}

}  // namespace

struct Emission::Impl {
  struct Origin {
    std::uint32_t source, site;
  };

  /// The state of a source.
  struct Progress {
    bool begun = false;
    std::uint64_t next = 0, emitted = 0;
    std::vector<std::uint8_t> waiting;
  };

  SourceMaterial material;
  std::vector<Source> sources;
  std::vector<Ended> ended;
  std::uint64_t next_id = 1;
  double step_begin = 0, step_length = 0;  // [s]; 0: not in a step
  std::vector<Progress> saved;             // by checkpoint(), one per source
  std::vector<Start> starts;
  std::vector<Origin> origins;

  template <class Emitter>
  Status add(const Emitter& emitter, const EmitterPose* pose, std::uint64_t* id);
  /// Null for an unknown handle.
  Source* find(std::uint64_t id);
  bool has_ended(std::uint64_t id) const { return find_ended(id) != ended.end(); }
  std::vector<Ended>::const_iterator find_ended(std::uint64_t id) const {
    return std::find_if(ended.begin(), ended.end(), [id](const Ended& e) { return e.id == id; });
  }
  /// Calls change(source), which returns a Status, unless the emitter has ended.
  template <class Change>
  Status change(std::uint64_t id, Change change);

  /// Between two steps.
  EmitterPose pose_at(const Source& source, double time) const;
  /// The source at `time` of an interval of dt.
  PlacedSource at(const Source& source, double time, double dt) const;
  void emit(std::size_t source, const PlacedSource& placed, std::size_t site, double remaining) {
    const Source& s = sources[source];
    const auto number = static_cast<std::uint32_t>(source + 1);
    starts.push_back({placed.place_of(site), placed.velocity_of(site), remaining, s.max_age,
                      s.kind == Source::Kind::volume ? number : 0});
    origins.push_back({static_cast<std::uint32_t>(source), static_cast<std::uint32_t>(site)});
  }
  /// Whether a box or a mesh starts before `end` [s].
  static bool starts_volume(const Source& s, double end) {
    return !s.begun && s.enabled && s.schedule.start < end;
  }
  void emit_waiting(std::size_t source, double time, double dt);
  void emit_series(std::size_t source, double time, double dt);
  void emit_volume(std::size_t source, double time, double dt);
};

Emission::Emission(double spacing, double rest_density, double particle_mass)
    : impl_(std::make_unique<Impl>()) {
  OILSKIN_ASSERT(spacing > 0 && rest_density > 0 && particle_mass > 0);
  impl_->material = {spacing, rest_density, particle_mass};
}

Emission::~Emission() = default;

template <class Emitter>
Status Emission::Impl::add(const Emitter& emitter, const EmitterPose* pose, std::uint64_t* id) {
  if (pose)
    if (Status s = check_pose(*pose); !s.ok()) return s;
  Source source;
  if (Status s = make_source(emitter, material, source); !s.ok()) return s;
  source.from = source.to = pose ? normalized(*pose) : EmitterPose{source.center, Rotation::Identity()};
  source.placed = pose != nullptr;
  source.id = next_id;
  source.is_held = id != nullptr;
  sources.push_back(std::move(source));
  ++next_id;
  if (id) *id = sources.back().id;
  return {};
}

void Emission::translate(const Vec3& offset) {
  for (Source& source : impl_->sources) {
    source.from.position += offset;
    source.to.position += offset;
    source.placed = true;
  }
}

Status Emission::add(const DiscEmitter& e, const EmitterPose* pose, std::uint64_t* id) {
  return impl_->add(e, pose, id);
}
Status Emission::add(const BoxEmitter& e, const EmitterPose* pose, std::uint64_t* id) {
  return impl_->add(e, pose, id);
}
Status Emission::add(const MeshEmitter& e, const EmitterPose* pose, std::uint64_t* id) {
  return impl_->add(e, pose, id);
}
Status Emission::add(const RainEmitter& e, const EmitterPose* pose, std::uint64_t* id) {
  return impl_->add(e, pose, id);
}

Source* Emission::Impl::find(std::uint64_t id) {
  const auto it = std::find_if(sources.begin(), sources.end(), [id](const Source& s) { return s.id == id; });
  return it == sources.end() ? nullptr : &*it;
}

template <class Change>
Status Emission::Impl::change(std::uint64_t id, Change change) {
  if (Source* source = find(id)) return change(*source);
  return has_ended(id) ? Status() : refuse("there is no emitter ", id);
}

Status Emission::move(std::uint64_t id, const EmitterPose& pose, const Motion& motion) {
  return impl_->change(id, [&](Source& s) {
    if (Status status = check_pose(pose); !status.ok()) return status;
    if (!within(motion.duration, 0, max_move))
      return refuse_value("emitter: duration", motion.duration, "0 … 1e6 s");
    s.from = motion.jumps ? normalized(pose) : impl_->pose_at(s, motion.begin);
    s.to = normalized(pose);
    s.placed = true;
    s.move_begin = motion.begin;
    s.move_length = motion.duration;
    return Status();
  });
}

Status Emission::aim(std::uint64_t id, const Vec3& center, const Vec3& direction, const Motion& motion) {
  return impl_->change(id, [&](Source& s) {
    if (s.kind != Source::Kind::nozzle) return refuse("emitter ", id, " is no nozzle: it has no axis to aim");
    if (!direction.allFinite() || !(direction.stableNorm() > 0))
      return refuse_value("emitter: direction", direction.transpose(), "finite and longer than 0");
    const Rotation& present = s.to.rotation;
    const Rotation turn(
        Eigen::Quaterniond::FromTwoVectors(present * s.direction, direction.stableNormalized()));
    return move(id, {center, turn * present}, motion);
  });
}

Status Emission::set_speed(std::uint64_t id, double speed, double time) {
  return impl_->change(id, [&](Source& s) {
    Status status = check_speed("emitter: speed", speed);
    if (status.ok() && s.kind == Source::Kind::nozzle)
      status = check_nozzle_speed("emitter: speed", speed, s.layer);
    if (status.ok() && speed > 0 && s.direction.isZero(0))
      status = refuse("emitter ", id, " was given no velocity, so its speed has no direction");
    if (status.ok()) s.set_speed(speed, time);
    return status;
  });
}

Status Emission::set_drops_per_second(std::uint64_t id, double rate, double time) {
  return impl_->change(id, [&](Source& s) {
    if (s.kind != Source::Kind::rain) return refuse("emitter ", id, " is no rain: it has no drops");
    if (Status status = check_drop_rate("emitter: drops_per_second", rate); !status.ok()) return status;
    s.schedule.rebase(time);
    s.schedule.period = 1 / rate;
    return Status();
  });
}

Status Emission::set_enabled(std::uint64_t id, bool enabled, double time) {
  return impl_->change(id, [&](Source& s) {
    s.schedule.rebase(time);
    s.enabled = enabled;
    s.update_running();
    if (!enabled) std::fill(s.waiting.begin(), s.waiting.end(), std::uint8_t{0});
    return Status();
  });
}

Status Emission::set_inherited_velocity(std::uint64_t id, const Vec3& velocity) {
  return impl_->change(id, [&](Source& s) {
    Status status = check_point("emitter: inherited velocity", velocity);
    if (status.ok()) s.inherited_velocity = velocity;
    return status;
  });
}

Status Emission::set_max_age(std::uint64_t id, double seconds) {
  return impl_->change(id, [&](Source& s) {
    s.max_age = seconds;
    return Status();
  });
}

bool Emission::remove(std::uint64_t id) {
  const auto has_id = [id](const auto& e) { return e.id == id; };
  const auto erase = [&](auto& all) {
    const auto it = std::find_if(all.begin(), all.end(), has_id);
    if (it == all.end()) return false;
    all.erase(it);
    return true;
  };
  return erase(impl_->sources) || erase(impl_->ended);
}

std::optional<EmitterState> Emission::state(std::uint64_t id) const {
  const Source* source = impl_->find(id);
  const auto ended = impl_->find_ended(id);
  if (!source && ended == impl_->ended.end()) return {};
  EmitterState state;
  state.ended = !source;
  state.particles = source ? source->emitted : ended->emitted;
  state.volume =
      static_cast<double>(state.particles) * impl_->material.particle_mass / impl_->material.rest_density;
  if (!source) return state;
  state.enabled = source->enabled;
  state.pose = source->to;
  state.speed = source->velocity.norm();
  state.inherited_velocity = source->inherited_velocity;
  state.max_age = source->max_age;
  return state;
}

void Emission::begin_step(double time, double dt) {
  OILSKIN_ASSERT(dt > 0);
  impl_->step_begin = time;
  impl_->step_length = dt;
}

const std::vector<Start>& Emission::due(double time, double dt) {
  OILSKIN_ASSERT(dt > 0);
  impl_->starts.clear();
  impl_->origins.clear();
  for (std::size_t s = 0; s < impl_->sources.size(); ++s) impl_->emit_waiting(s, time, dt);
  for (std::size_t s = 0; s < impl_->sources.size(); ++s) {
    if (impl_->sources[s].kind == Source::Kind::volume)
      impl_->emit_volume(s, time, dt);
    else
      impl_->emit_series(s, time, dt);
  }
  return impl_->starts;
}

std::size_t Emission::due_count() const {
  return impl_->starts.size();
}

double Emission::fastest_due(double time, double dt) const {
  double fastest = 0;
  for (const Source& s : impl_->sources) {
    const bool waits = std::find(s.waiting.begin(), s.waiting.end(), 1) != s.waiting.end();
    const bool starts = s.schedule.runs && !s.is_over(time) && s.schedule.start < time + dt;
    if (waits || starts) fastest = std::max(fastest, s.fastest + speed_by_motion(s, dt));
  }
  return fastest;
}

Box Emission::due_volumes(double time, double dt) const {
  Box bounds;
  for (const Source& s : impl_->sources) {
    if (s.kind != Source::Kind::volume || !impl_->starts_volume(s, time + dt)) continue;
    const PlacedSource placed = impl_->at(s, time, dt);
    for (std::size_t k = 0; k < s.sites.size(); ++k) bounds.add(placed.place_of(k));
  }
  return bounds;
}

EmitterPose Emission::Impl::pose_at(const Source& s, double time) const {
  return pose_of(s, s.move_length > 0 ? std::clamp((time - s.move_begin) / s.move_length, 0.0, 1.0) : 0);
}

PlacedSource Emission::Impl::at(const Source& s, double time, double dt) const {
  const bool in_step = s.move_length == 0 && step_length > 0;
  const double begin = in_step ? step_begin : s.move_begin, length = in_step ? step_length : s.move_length;
  if (length == 0) return {s, 0, dt};
  return {s, std::clamp((time - begin) / length, 0.0, 1.0), length};
}

void Emission::Impl::emit_waiting(std::size_t source, double time, double dt) {
  const Source& s = sources[source];
  OILSKIN_ASSERT(s.waiting.empty() || s.waiting.size() == s.sites.size());
  if (std::find(s.waiting.begin(), s.waiting.end(), 1) == s.waiting.end()) return;
  const PlacedSource placed = at(s, time, dt);
  for (std::size_t k = 0; k < s.waiting.size(); ++k)
    if (s.waiting[k]) emit(source, placed, k, dt);
}

void Emission::Impl::emit_series(std::size_t index, double time, double dt) {
  Source& s = sources[index];
  OILSKIN_ASSERT(s.schedule.period >= min_period);
  if (!s.begun) s.begin(time);
  for (double t = s.time_of(s.next); t < time + dt && t < s.schedule.stop; t = s.time_of(++s.next)) {
    const PlacedSource placed = at(s, t, dt);
    const double remaining = std::min(dt, time + dt - t);
    // A start that waited leaves at `time`. One of the same site within half a period after it would overlap
    // it.
    const bool behind = t - time < 0.5 * s.schedule.period;
    for (std::size_t k = 0; k < s.sites.size(); ++k)
      if (!(behind && !s.waiting.empty() && s.waiting[k])) emit(index, placed, k, remaining);
  }
  std::fill(s.waiting.begin(), s.waiting.end(), std::uint8_t{0});
}

void Emission::Impl::emit_volume(std::size_t index, double time, double dt) {
  Source& s = sources[index];
  if (!starts_volume(s, time + dt)) return;
  s.begun = true;
  const double remaining = std::min(dt, time + dt - s.schedule.start);
  const PlacedSource placed = at(s, time + dt - remaining, dt);
  for (std::size_t k = 0; k < s.sites.size(); ++k) emit(index, placed, k, remaining);
}

std::uint64_t Emission::settle(Span<const Outcome> outcomes) {
  OILSKIN_ASSERT(outcomes.size() == impl_->starts.size());
  std::uint64_t blocked = 0;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    Source& s = impl_->sources[impl_->origins[i].source];
    if (outcomes[i] == Outcome::emitted) ++s.emitted;
    if (outcomes[i] != Outcome::blocked) continue;
    ++blocked;
    if (s.kind == Source::Kind::nozzle) s.waiting[impl_->origins[i].site] = 1;
  }
  return blocked;
}

void Emission::checkpoint() {
  impl_->saved.resize(impl_->sources.size());
  for (std::size_t k = 0; k < impl_->saved.size(); ++k) {
    const Source& s = impl_->sources[k];
    impl_->saved[k].begun = s.begun;
    impl_->saved[k].next = s.next;
    impl_->saved[k].emitted = s.emitted;
    impl_->saved[k].waiting = s.waiting;
  }
  impl_->ended.reserve(impl_->ended.size() + impl_->sources.size());  // for commit()
}

void Emission::roll_back() noexcept {
  for (std::size_t k = 0; k < impl_->saved.size(); ++k) {
    Source& s = impl_->sources[k];
    s.begun = impl_->saved[k].begun;
    s.next = impl_->saved[k].next;
    s.emitted = impl_->saved[k].emitted;
    s.waiting.swap(impl_->saved[k].waiting);
  }
  impl_->step_length = 0;
}

void Emission::commit(double time) noexcept {
  impl_->step_length = 0;
  for (Source& s : impl_->sources) {
    if (s.move_begin + s.move_length <= time) {
      s.from = s.to;
      s.move_length = 0;
    }
    if (s.is_held && s.is_over(time)) impl_->ended.push_back({s.id, s.emitted});
  }
  impl_->sources.erase(std::remove_if(impl_->sources.begin(), impl_->sources.end(),
                                      [time](const Source& s) { return s.is_over(time); }),
                       impl_->sources.end());
}

void Emission::visit(Archive& archive, double time) {
  constexpr std::size_t min_bytes = 200;  // of a source without sites
  std::uint64_t& next_id = impl_->next_id;
  archive.value(next_id);
  std::uint64_t last = 0;
  const auto check_id = [&](std::uint64_t id) {
    archive.require(id > last && id < next_id, "the handle of an emitter");
    last = id;
  };
  archive.list(impl_->sources, min_bytes, [&](Source& s) {
    fluid::visit(archive, s);
    archive.require(is_in_range(s, time), "an emitter");
    check_id(s.id);
  });
  archive.list(impl_->ended, sizeof(Ended), [&](Ended& e) {
    archive.values(e.id, e.emitted);
    archive.require(e.id > 0 && e.id < next_id, "the handle of an emitter");
  });
}

}  // namespace oilskin::fluid
