#include "world/save.h"

#include <algorithm>
#include <cmath>

#include "core/body_motion.h"
#include "core/frame.h"
#include "world/carried_mass.h"
#include "world/numeric_range.h"
#include "world/world_impl.h"

// Structured bindings name every member: a new member that is not saved does not compile.

namespace oilskin {

namespace {

void visit(Archive& archive, WorldSettings& settings) {
  auto& [gravity, kill_box, threads, max_particles, step_budget] = settings;
  archive.values(gravity, kill_box, max_particles, step_budget);
  static_cast<void>(threads);  // a property of the machine, not of the state
}

void visit(Archive& archive, FluidSettings& settings) {
  auto& [spacing, rest_density, support_ratio, solver, tolerance, divergence_tolerance, min_iterations,
         max_iterations, gradient_correction, stiffness, viscosity, xsph_rate, xsph_strain, contact_aware,
         occlusion, boundary, cfl, max_substeps, collision_group, collision_mask] = settings;
  double rate = xsph_rate.value_or(0), strain = xsph_strain.value_or(0);  // a world has both
  archive.values(spacing, rest_density, support_ratio, solver, tolerance, divergence_tolerance,
                 min_iterations, max_iterations, gradient_correction, stiffness, viscosity, rate, strain,
                 contact_aware, occlusion, boundary, cfl, max_substeps, collision_group, collision_mask);
  xsph_rate = rate;
  xsph_strain = strain;
}

void visit(Archive& archive, ContactSettings& settings) {
  auto& [repulsion, stiffness, ccd, zones, solver_iterations, ccd_iterations, infeasible, verify, hierarchy] =
      settings;
  archive.values(repulsion, stiffness, ccd, zones, solver_iterations, ccd_iterations, infeasible, verify,
                 hierarchy);
}

void visit(Archive& archive, SlipSettings& settings) {
  auto& [model, friction, slip_length] = settings;
  archive.values(model, friction, slip_length);
}

void visit(Archive& archive, std::optional<SlipSettings>& settings) {
  archive.optional(settings, [&](SlipSettings& slip) { visit(archive, slip); });
}

void visit(Archive& archive, SurfaceSettings& settings) {
  auto& [thickness, slip, slip_back, smooth, solid, collision_group, collision_mask] = settings;
  double value = thickness.value_or(0);  // an attached surface has one
  archive.value(value);
  thickness = value;
  visit(archive, slip);
  visit(archive, slip_back);
  archive.value(smooth);
  archive.optional(solid, [&](bool& is_solid) { archive.value(is_solid); });
  archive.values(collision_group, collision_mask);
}

void visit(Archive& archive, std::optional<BodyMotion>& body) {
  archive.optional(body, [&](BodyMotion& motion) {
    auto& [inverse_mass, inverse_inertia, center_t1, velocity, angular_velocity, gravity, center_t0,
           host_step, impulse, angular_impulse] = motion;
    archive.values(inverse_mass, center_t1, velocity, angular_velocity, gravity, center_t0, host_step,
                   impulse, angular_impulse);
    for (double& entry : inverse_inertia.reshaped()) archive.value(entry);
  });
}

void visit(Archive& archive, SurfaceMotion& motion) {
  auto& [id, triangles, storage, thickness, delta, slip, slip_back, smooth, nodes_movable, solid, x_t0, x_t1,
         velocity, velocity_t0, inverse_mass, holdable, added_mass, body, impulse, angular_impulse, moved,
         touched, revision, still, carried_mass, absorbed_mass] = motion;
  if (archive.reading()) {  // gather() fills them
    velocity_t0.clear();
    revision = still = 0;
  }
  archive.values(id, triangles, storage, thickness, delta);
  visit(archive, slip);
  visit(archive, slip_back);
  archive.values(smooth, nodes_movable, solid, x_t0, x_t1, velocity, inverse_mass, holdable, added_mass,
                 impulse, angular_impulse, moved, carried_mass, absorbed_mass);
  visit(archive, body);
  if (!archive.reading()) return;
  touched.clear();
  for (std::uint32_t i = 0; i < impulse.size(); ++i)
    if (!impulse[i].isZero(0) || (i < moved.size() && moved[i] != 0)) touched.push_back(i);
}

/// Beyond it the squares of distances overflow [m].
constexpr double max_thickness = 1e15;

/// The checks of Attachments::gather(). Meshes are compared with those of the hosts elsewhere.
bool is_in_range(const SurfaceMotion& m) {
  const std::size_t n = m.x_t1.size();
  const auto has = [n](std::size_t size) { return size == n || size == 0; };
  if (m.storage != Storage::float32 && m.storage != Storage::float64) return false;
  if (m.x_t0.size() != n || m.velocity.size() != n || m.inverse_mass.size() != n) return false;
  if (!has(m.holdable.size()) || !has(m.impulse.size()) || !has(m.moved.size())) return false;
  if (!has(m.added_mass.size()) || !has(m.carried_mass.size())) return false;
  if (!has(m.absorbed_mass.size())) return false;
  for (const std::vector<double>* masses : {&m.carried_mass, &m.absorbed_mass})
    for (double mass : *masses)
      if (!(mass >= 0 && std::isfinite(mass))) return false;
  if (!(m.delta > 0 && m.thickness >= 4 * m.delta && m.thickness < max_thickness)) return false;
  for (const Triangle& t : m.triangles)
    if (t[0] >= n || t[1] >= n || t[2] >= n) return false;
  for (std::size_t i = 0; i < n; ++i)
    if (!world::is_in_range(m.x_t0[i]) || !world::is_in_range(m.x_t1[i]) ||
        !world::is_in_range(m.velocity[i]) || stored(m.x_t1[i], m.storage) != m.x_t1[i] ||
        !(m.inverse_mass[i] >= 0))
      return false;
  return check_body(m).ok();
}

/// Are the ids unique, and from a counter whose next value is `next` and cannot overflow?
bool are_given(std::vector<std::uint64_t> ids, std::uint64_t next) {
  if (next == 0 || next >> 63 != 0) return false;
  std::sort(ids.begin(), ids.end());
  return ids.empty() ||
         (ids.front() > 0 && ids.back() < next && std::adjacent_find(ids.begin(), ids.end()) == ids.end());
}

}  // namespace

namespace world {

namespace {

constexpr FrameKind saved_world = {{'O', 'I', 'L', 'S', 'A', 'V', 'E', '\n'}, 15, "saved world"};

}  // namespace

std::vector<std::uint8_t> framed(Span<const std::uint8_t> content) {
  return oilskin::framed(saved_world, content);
}

Status unframe(Span<const std::uint8_t> saved, Span<const std::uint8_t>* content) {
  return oilskin::unframe(saved_world, saved, content);
}

void Attachments::visit(Archive& archive) {
  constexpr std::size_t min_bytes = 200;  // of a surface without nodes
  archive.value(next_id_);
  archive.list(list_, min_bytes, [&](std::unique_ptr<Attachment>& a) {
    if (!a) a = std::make_unique<Attachment>();
    archive.values(a->is_new, a->teleported, a->refused);
    oilskin::visit(archive, a->settings);
    if (archive.ok()) archive.require(a->settings.validate().ok(), "the settings of a surface");
    // The motion of a refused surface is invalid; if it is accepted later, it is a new surface.
    if (a->refused) return archive.value(a->motion.id);
    oilskin::visit(archive, a->motion);
    archive.value(a->mean_load);
    archive.list(a->values, sizeof(std::uint64_t), [&](std::vector<double>& v) { archive.value(v); });
    for (const std::vector<double>& v : a->values)
      archive.require(v.size() == a->motion.x_t1.size(), "the number of values of an effect");
    if (archive.ok())
      archive.require(oilskin::is_in_range(a->motion) && is_mean_load(a->mean_load, a->motion.x_t1.size()),
                      "the state of a surface");
  });
  if (!archive.reading()) return;
  std::vector<std::uint64_t> ids;
  for (const auto& a : list_) ids.push_back(a->motion.id);
  archive.require(are_given(ids, next_id_), "the ids of the surfaces");
}

namespace {

Status compare_meshes(const SurfaceMotion& saved, const SurfaceMotion& here, std::size_t number) {
  const auto refuse = [&](const std::string& what, const std::string& there, const std::string& ours) {
    return Status::refused("surface " + std::to_string(number + 1) + " of the saved world has " + there +
                           " " + what + ", the one attached here " + ours +
                           "; attach the same hosts in the same order");
  };
  const auto precision = [](const SurfaceMotion& m) {
    return m.storage == Storage::float32 ? "single" : "double";
  };
  if (saved.x_t1.size() != here.x_t1.size())
    return refuse("nodes", std::to_string(saved.x_t1.size()), std::to_string(here.x_t1.size()));
  if (saved.triangles.size() != here.triangles.size())
    return refuse("triangles", std::to_string(saved.triangles.size()), std::to_string(here.triangles.size()));
  if (saved.triangles != here.triangles) return refuse("triangles", "other", "has its own");
  if (saved.storage != here.storage) return refuse("precision", precision(saved), precision(here));
  return {};
}

}  // namespace

Status Attachments::take_hosts(Attachments& from) {
  if (list_.size() != from.list_.size())
    return Status::refused("the saved world has " + std::to_string(list_.size()) + " surfaces, this one " +
                           std::to_string(from.list_.size()) + "; attach the same hosts in the same order");
  for (std::size_t k = 0; k < list_.size(); ++k) {
    if (list_[k]->refused) continue;
    if (Status s = compare_meshes(list_[k]->motion, from.list_[k]->motion, k); !s.ok()) return s;
  }
  for (std::size_t k = 0; k < list_.size(); ++k) {
    Attachment &mine = *list_[k], &other = *from.list_[k];
    mine.handle = other.handle;
    mine.host = other.host;
    if (!mine.refused) continue;
    const std::uint64_t id = mine.motion.id;
    mine.motion = other.motion;
    mine.motion.id = id;
    mine.motion.revision = mine.motion.still = 0;  // a number of the other attachments
  }
  next_handle_ = from.next_handle_;
  return {};
}

void Attachments::take_geometry(Attachments& from) {
  OILSKIN_ASSERT(list_.size() == from.list_.size());
  next_still_ = from.next_still_;  // geometry was fitted to numbers before it
  for (std::size_t k = 0; k < list_.size(); ++k) {
    Attachment &mine = *list_[k], &other = *from.list_[k];
    if (mine.refused || other.refused) continue;
    const bool is_analysed = other.geometry.id == other.motion.id;
    mine.geometry = std::move(other.geometry);
    mine.geometry.id = is_analysed ? mine.motion.id : 0;
    if (!stand_alike(mine.motion, other.motion)) {
      mine.geometry.fitted_still = 0;
      continue;
    }
    mine.motion.revision = other.motion.revision;
    mine.motion.still = other.motion.still;
  }
}

}  // namespace world

/// Counters come first: ids are checked against them.
void World::Impl::visit_state(Archive& archive) {
  auto& [particles, next_particle_id, step_count, interval_count, time, last_dt, max_acceleration, energy,
         withdrawn, sinks, max_age] = state;
  archive.values(next_particle_id, step_count, interval_count, time, last_dt, max_acceleration);
  archive.values(withdrawn.count, withdrawn.mass_ratio, withdrawn.momentum);
  archive.require(
      withdrawn.mass_ratio >= 0 && std::isfinite(withdrawn.mass_ratio) && withdrawn.momentum.allFinite(),
      "the particles that were removed since the last step");
  archive.require(max_acceleration >= 0, "the largest acceleration");
  archive.require(time >= 0 && std::isfinite(time) && last_dt >= 0 && std::isfinite(last_dt), "the time");
  energy.visit(archive);
  sinks.visit(archive);
  archive.value(max_age);
  archive.require(max_age > 0, "the largest age");
  effects.visit(archive);
  particles.visit(archive);
  if (archive.reading())
    archive.require(are_given(particles.id, next_particle_id), "the ids of the particles");
  emission->visit(archive, time);
  fluid->visit(archive);
  attachments.visit(archive);
  for (const auto& a : attachments.all())
    archive.require(a->values.empty() || a->values.size() == effects.node_value_count(),
                    "the number of kinds of values of a surface");
}

Status World::Impl::restore(Span<const std::uint8_t> saved) {
  Span<const std::uint8_t> content;
  if (Status s = world::unframe(saved, &content); !s.ok()) return s;
  const auto refuse = [](const Status& s) { return Status::refused("the saved world: " + s.message); };
  Archive archive(content);
  WorldSettings world_settings;
  FluidSettings of_fluid;
  ContactSettings of_contact;
  visit(archive, world_settings);
  visit(archive, of_fluid);
  visit(archive, of_contact);
  if (!archive.ok()) return refuse(archive.status());
  world_settings.threads = settings.threads;

  Impl restored(world_settings, of_fluid, of_contact, workers);
  if (!restored.status.ok()) return refuse(restored.status);
  restored.effects.take_effects(effects);
  restored.state.particles.values.resize(state.particles.values.size());
  restored.state.particles.value_start = state.particles.value_start;
  restored.visit_state(archive);
  if (archive.ok() && archive.left() > 0) archive.refuse("there are more bytes than there is state");
  if (!archive.ok()) return refuse(archive.status());
  if (Status s = restored.attachments.take_hosts(attachments); !s.ok()) return s;
  if (Status s = restored.effects.restore(); !s.ok()) return refuse(s);
  restored.attachments.take_geometry(attachments);
  restored.observer = observer;
  restored.report.step = restored.state.step_count;
  restored.report.time = restored.state.time;
  restored.report.alive = restored.state.particles.size();
  *this = std::move(restored);
  return {};
}

void world::WorldState::copy_to(WorldState& to, const Workers& copiers) const {
  auto& [particles_, next_id, steps, intervals, time_, last_dt_, max_acceleration_, energy_, withdrawn_,
         sinks_, max_age_] = to;
  particles.copy_to(particles_, copiers);
  next_id = next_particle_id;
  steps = step_count;
  intervals = interval_count;
  time_ = time;
  last_dt_ = last_dt;
  max_acceleration_ = max_acceleration;
  energy_ = energy;
  withdrawn_ = withdrawn;
  sinks_ = sinks;
  max_age_ = max_age;
}

Status World::save(std::vector<std::uint8_t>* out) const {
  if (!out) return Status::refused("save() needs a vector to write to, and `out` is null");
  if (!impl_->status.ok()) return impl_->status;
  std::vector<std::uint8_t> content;
  Archive archive(content);
  visit(archive, impl_->settings);
  visit(archive, impl_->fluid_settings);
  visit(archive, impl_->contact_settings);
  impl_->visit_state(archive);
  *out = world::framed(content);
  return {};
}

Status World::restore(Span<const std::uint8_t> saved) {
  return impl_->status.ok() ? impl_->restore(saved) : impl_->status;
}

}  // namespace oilskin
