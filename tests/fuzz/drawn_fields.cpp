// Sinks, ages and force fields of a random world: drawn from numbers of their own, so that worlds without
// them are those that they were.
#include <algorithm>

#include "fuzz/drawn_world.h"

namespace oilskin::test {

Vec3 DrawnWorld::place_of_field() {
  return arena_.center + fields_random_.in_cube(0.5 * arena_.half);
}

Region DrawnWorld::draw_region() {
  const Vec3 at = place_of_field();
  const double size = dx_ * fields_random_.log_uniform(0.5, 10);
  Region region;
  const std::uint32_t kind = fields_random_.below(4);
  if (kind != 1) region.box = Box{at - Vec3::Constant(size), at + Vec3::Constant(size)};
  if (kind == 1 || kind == 2) region.capsule = Capsule{at, place_of_field(), size};
  if (kind == 3) region.half_spaces.push_back({at, fields_random_.direction()});
  return region;
}

Force DrawnWorld::draw_force() {
  const double size = fields_random_.log_uniform(0.1, 1e4);
  Region region;
  if (chance(fields_random_, 0.6)) region = draw_region();
  switch (fields_random_.below(3)) {
    case 0:
      return UniformForce{region, size * fields_random_.direction()};
    case 1: {
      VortexForce vortex{region, place_of_field(), fields_random_.direction()};
      vortex.radius = dx_ * fields_random_.log_uniform(0.1, 20);
      vortex.strength = chance(fields_random_, 0.5) ? size : -size;
      return vortex;
    }
    default: {
      WindForce wind;
      wind.region = region;
      wind.velocity = fields_random_.direction() * dx_ / dt_ * fields_random_.log_uniform(0.01, 30);
      wind.air_density = one_of(fields_random_, {1.2, 0.0, 1000.0});
      return wind;
    }
  }
}

/// Three worlds in ten have them.
void DrawnWorld::add_fields() {
  if (!chance(fields_random_, 0.3)) return;
  for (std::uint32_t k = fields_random_.below(3); k > 0; --k) {
    Drain drain;
    drain.region = draw_region();
    expect(world_->add_sink(drain.region, &drain.id).ok(), "add_sink");
    drains_.push_back(drain);
  }
  if (chance(fields_random_, 0.4)) {
    max_age_ = dt_ * fields_random_.uniform(1, 6);
    expect(world_->set_max_age(max_age_).ok(), "set_max_age");
  }
  forces_.resize(fields_random_.below(3));
  for (ForceId& id : forces_) expect(fields_.add(draw_force(), &id).ok(), "add a force");
  if (!forces_.empty()) expect(world_->add_effect(fields_).ok(), "add_effect");
  note_births(world_->time());
}

/// What a user does with them between two steps.
void DrawnWorld::disturb_fields() {
  for (Drain& drain : drains_) {
    if (chance(fields_random_, 0.1)) {
      drain.region = draw_region();
      expect(world_->set_sink_region(drain.id, drain.region).ok(), "set_sink_region");
    }
    if (chance(fields_random_, 0.1)) {
      drain.enabled = !drain.enabled;
      expect(world_->set_sink_enabled(drain.id, drain.enabled).ok(), "set_sink_enabled");
    }
  }
  for (ForceId id : forces_) {
    if (chance(fields_random_, 0.1)) expect(fields_.set(id, draw_force()).ok(), "set a force");
    if (chance(fields_random_, 0.1))
      expect(fields_.set_enabled(id, chance(fields_random_, 0.5)).ok(), "set_enabled");
  }
  note_births(world_->time());
}

/// No particle that is not known yet began after `time`.
void DrawnWorld::note_births(double time) {
  if (std::isinf(max_age_)) return;
  for (std::uint64_t id : world_->ids()) latest_birth_.emplace(id, time);
}

void DrawnWorld::check_fields(const StepReport& r) {
  expect(r.contact.removed + r.removed_by_sinks + r.removed_by_age <= r.removed,
         "removed by contact, sinks and age");
  expect(r.removed_by_age == 0 || !std::isinf(max_age_), "ended without a largest age");
  std::uint64_t taken = 0;
  for (const Drain& drain : drains_) {
    taken += world_->sink(drain.id)->particles;
    if (!drain.enabled) continue;
    for (const Vec3& x : world_->positions()) expect(!drain.region.contains(x), "a particle is in a sink");
  }
  expect(taken == verdict_.drained + r.removed_by_sinks, "sinks count what the report does not");
  note_births(r.time);
  if (!std::isinf(max_age_))
    for (std::uint64_t id : world_->ids())
      expect(r.time < latest_birth_[id] + max_age_ * (1 + 1e-9), "a particle is too old");
  verdict_.drained += r.removed_by_sinks;
  verdict_.aged += r.removed_by_age;
  verdict_.forced += !r.momentum_effects.isZero(0);
}

}  // namespace oilskin::test
