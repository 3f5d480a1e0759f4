#include "oilskin/force_fields.h"

#include <algorithm>
#include <cmath>

#include "core/refuse.h"
#include "core/region_archive.h"
#include "effects/forces/exposure.h"

namespace oilskin {

namespace {

Status check(const UniformForce& f) {
  return check_point("force: acceleration", f.acceleration);
}

Status check(const VortexForce& f) {
  if (Status s = check_point("force: center", f.center); !s.ok()) return s;
  if (!f.axis.allFinite() || !(f.axis.stableNorm() > 0))
    return refuse_value("force: axis", f.axis.transpose(), "finite and longer than 0");
  if (!(f.radius > 0 && std::isfinite(f.radius)))
    return refuse_value("force: radius", f.radius, "finite and > 0 m");
  return std::isfinite(f.strength) ? Status() : refuse_value("force: strength", f.strength, "finite");
}

Status check(const WindForce& f) {
  if (Status s = check_point("force: velocity", f.velocity); !s.ok()) return s;
  const std::pair<const char*, double> all[] = {{"force: air_density", f.air_density},
                                                {"force: drag_coefficient", f.drag_coefficient},
                                                {"force: friction_coefficient", f.friction_coefficient}};
  for (const auto& [field, value] : all)
    if (!(value >= 0 && std::isfinite(value))) return refuse_value(field, value, "finite and ≥ 0");
  return {};
}

/// Calls change(i) for each particle in the region.
template <class Change>
void for_each_in(const Region& region, const EffectForces& f, Change change) {
  f.for_each(f.id.size(), [&](std::size_t i) {
    if (region.contains(f.position[i])) change(i);
  });
}

void act(const UniformForce& field, EffectForces& f) {
  for_each_in(field.region, f, [&](std::size_t i) { f.acceleration[i] += field.acceleration; });
}

/// (G.1)
void act(const VortexForce& field, EffectForces& f) {
  const Vec3 axis = field.axis.stableNormalized();
  for_each_in(field.region, f, [&](std::size_t i) {
    const Vec3 around = axis.cross(f.position[i] - field.center);
    const double distance = around.norm();
    f.acceleration[i] += field.strength / field.radius * around *
                         std::min(1.0, field.radius * field.radius / (distance * distance));
  });
}

/// (G.2), with the velocity that the interval's earlier effects leave.
void act(const WindForce& field, EffectForces& f) {
  for_each_in(field.region, f, [&](std::size_t i) {
    const Vec3 relative = field.velocity - (f.velocity[i] + f.dt * f.acceleration[i]);
    const double speed = relative.stableNorm();
    if (!(speed > 0)) return;
    const effects::Exposure area = effects::exposure(f, i, relative / speed);
    const double rate = 0.5 * field.air_density * speed / f.mass(i) *
                        (field.drag_coefficient * area.facing + field.friction_coefficient * area.whole);
    f.acceleration[i] += rate / (1 + rate * f.dt) * relative;
  });
}

double largest_acceleration(const UniformForce& f) {
  return f.acceleration.stableNorm();
}
double largest_acceleration(const VortexForce& f) {
  return std::abs(f.strength);
}
double largest_acceleration(const WindForce&) {
  return 0;
}

void visit(Archive& archive, UniformForce& f) {
  auto& [region, acceleration] = f;
  visit(archive, region);
  archive.value(acceleration);
}

void visit(Archive& archive, VortexForce& f) {
  auto& [region, center, axis, radius, strength] = f;
  visit(archive, region);
  archive.values(center, axis, radius, strength);
}

void visit(Archive& archive, WindForce& f) {
  auto& [region, velocity, air_density, drag_coefficient, friction_coefficient] = f;
  visit(archive, region);
  archive.values(velocity, air_density, drag_coefficient, friction_coefficient);
}

void visit(Archive& archive, Force& force) {
  auto kind = static_cast<std::uint8_t>(force.index());
  archive.value(kind);
  if (archive.reading()) {
    if (kind == 1)
      force = VortexForce();
    else if (kind == 2)
      force = WindForce();
    else
      archive.require(kind == 0, "the kind of a force");
  }
  std::visit([&](auto& f) { visit(archive, f); }, force);
  archive.require(validate(force).ok(), "a force");
}

Status no_force(ForceId id) {
  return refuse("there is no force ", id.value);
}

}  // namespace

Status validate(const Force& force) {
  return std::visit(
      [](const auto& f) {
        Status s = f.region.validate();
        return s.ok() ? check(f) : s;
      },
      force);
}

ForceFields::ForceFields() = default;

Status ForceFields::add(const Force& force, ForceId* id) {
  if (Status s = validate(force); !s.ok()) return s;
  fields_.push_back({next_id_, true, force});
  if (id) id->value = next_id_;
  ++next_id_;
  return {};
}

ForceFields::Field* ForceFields::find_field(ForceId id) {
  const auto it =
      std::find_if(fields_.begin(), fields_.end(), [id](const Field& f) { return f.id == id.value; });
  return it == fields_.end() ? nullptr : &*it;
}

Status ForceFields::set(ForceId id, const Force& force) {
  Field* field = find_field(id);
  if (!field) return no_force(id);
  Status s = validate(force);
  if (s.ok()) field->force = force;
  return s;
}

Status ForceFields::set_enabled(ForceId id, bool enabled) {
  Field* field = find_field(id);
  if (!field) return no_force(id);
  field->enabled = enabled;
  return {};
}

bool ForceFields::remove(ForceId id) {
  const Field* field = find_field(id);
  if (field) fields_.erase(fields_.begin() + (field - fields_.data()));
  return field != nullptr;
}

std::optional<ForceState> ForceFields::find(ForceId id) const {
  for (const Field& f : fields_)
    if (f.id == id.value) return ForceState{f.force, f.enabled};
  return {};
}

/// Walls shelter from wind alone.
double ForceFields::wall_reach() const {
  const auto is_wind = [](const Field& f) { return f.enabled && std::holds_alternative<WindForce>(f.force); };
  return std::any_of(fields_.begin(), fields_.end(), is_wind) ? 1 : 0;
}

double ForceFields::longest_interval(const FluidSettings& fluid) const {
  struct Strength {
    std::optional<Box> where;  // none: everywhere
    double acceleration;
  };
  std::vector<Strength> all;
  for (const Field& field : fields_)
    if (field.enabled)
      std::visit(
          [&](const auto& f) {
            all.push_back({f.region.bounds(), largest_acceleration(f)});
          },
          field.force);
  const bool has_place =
      std::any_of(all.begin(), all.end(), [](const Strength& s) { return s.where.has_value(); });
  double largest = 0;
  for (const Strength& one : all) {  // at a point of it, those that overlap it may act
    if (!one.where && has_place) continue;
    double sum = 0;
    for (const Strength& other : all)
      if (!one.where || !other.where || one.where->overlaps(*other.where)) sum += other.acceleration;
    largest = std::max(largest, sum);
  }
  return largest > 0 ? 0.25 * std::sqrt(fluid.support_ratio * fluid.spacing / largest)
                     : Effect::longest_interval(fluid);
}

void ForceFields::act(EffectForces& forces) {
  for (const Field& field : fields_)
    if (field.enabled) std::visit([&](const auto& f) { oilskin::act(f, forces); }, field.force);
}

void ForceFields::translate(const Vec3& offset) {
  for (Field& field : fields_) {
    std::visit([&](auto& f) { f.region.pose.position += offset; }, field.force);
    if (auto* vortex = std::get_if<VortexForce>(&field.force)) vortex->center += offset;
  }
}

std::vector<std::uint8_t> ForceFields::save() const {
  std::vector<std::uint8_t> bytes;
  Archive archive(bytes);
  std::uint64_t next_id = next_id_;
  std::vector<Field> fields = fields_;
  archive.value(next_id);
  archive.list(fields, 1, [&](Field& field) {
    archive.values(field.id, field.enabled);
    visit(archive, field.force);
  });
  return bytes;
}

Status ForceFields::restore(Span<const std::uint8_t> saved) {
  constexpr std::size_t min_bytes = 90;
  Archive archive(saved);
  std::uint64_t next_id = 1, last = 0;
  std::vector<Field> fields;
  archive.value(next_id);
  archive.list(fields, min_bytes, [&](Field& field) {
    archive.values(field.id, field.enabled);
    visit(archive, field.force);
    archive.require(field.id > last && field.id < next_id, "the handle of a force");
    last = field.id;
  });
  if (!archive.ok() || archive.left() > 0) return Status::refused("its force fields are damaged");
  fields_ = std::move(fields);
  next_id_ = next_id;
  return {};
}

}  // namespace oilskin
