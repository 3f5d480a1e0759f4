#include "oilskin/world.h"

#include <cmath>
#include <numeric>
#include <utility>

#include "core/hash.h"
#include "core/simd.h"
#include "fluid/neighbours.h"
#include "fluid/pairs/pair_kernels.h"
#include "world/absorption.h"
#include "world/carried_mass.h"
#include "world/numeric_range.h"
#include "world/particle_limit.h"
#include "world/world_impl.h"

namespace oilskin {

SurfaceLoad load_of(const SurfaceMotion& surface) {
  SurfaceLoad load;
  if (surface.impulse.size() != surface.x_t1.size()) return load;
  if (surface.still != 0)
    for (const std::uint32_t j : surface.touched) load.impulse += surface.impulse[j];
  else
    for (const Vec3& impulse : surface.impulse) load.impulse += impulse;
  load.angular_impulse = surface.angular_impulse;
  return load;
}

World::Impl::Impl(const WorldSettings& world, const FluidSettings& fluid_in,
                  const ContactSettings& contact_in, std::shared_ptr<Workers> given)
    : settings(world), fluid_settings(fluid_in), contact_settings(contact_in) {
  for (const Status& s : {settings.validate(), fluid_settings.validate(), contact_settings.validate()})
    if (status.ok() && !s.ok()) status = s;
  if (!status.ok()) return;
  set_smoothing(fluid_settings, settings.gravity.norm());
  workers = given ? std::move(given) : std::make_shared<Workers>(settings.threads);
  fluid = std::make_unique<fluid::FluidSolver>(fluid_settings, workers);
  emission = std::make_unique<fluid::Emission>(fluid_settings.spacing, fluid_settings.rest_density,
                                               fluid->particle_mass());
}

void World::Impl::checkpoint() {
  state.copy_to(saved_state, *workers);
  emission->checkpoint();
  fluid->checkpoint();
  attachments.checkpoint();
  effects.checkpoint();
}

void World::Impl::roll_back() noexcept {
  std::swap(state, saved_state);
  emission->roll_back();
  fluid->roll_back();
  attachments.roll_back();
  effects.roll_back();
}

World::World(const WorldSettings& world, const FluidSettings& fluid, const ContactSettings& contact)
    : impl_(std::make_unique<Impl>(world, fluid, contact)) {}
World::~World() = default;

Status World::status() const {
  return impl_->status;
}
const WorldSettings& World::settings() const {
  return impl_->settings;
}
const FluidSettings& World::fluid_settings() const {
  return impl_->fluid_settings;
}
const ContactSettings& World::contact_settings() const {
  return impl_->contact_settings;
}

Status World::set_gravity(const Vec3& gravity) {
  WorldSettings changed = impl_->settings;
  changed.gravity = gravity;
  Status s = changed.validate();
  if (s.ok()) impl_->settings = changed;
  return s;
}

Status World::set_contact_settings(const ContactSettings& settings) {
  Status s = settings.validate();
  if (s.ok()) impl_->contact_settings = settings;
  return s;
}

void World::set_max_particles(std::uint64_t count) {
  impl_->settings.max_particles = count;
}

Status World::set_step_budget(double seconds) {
  WorldSettings changed = impl_->settings;
  changed.step_budget = seconds;
  Status s = changed.validate();
  if (s.ok()) impl_->settings = changed;
  return s;
}

Status World::attach(SurfaceHost& host, const SurfaceSettings& settings, SurfaceId* id) {
  if (!impl_->status.ok()) return impl_->status;
  SurfaceSettings complete = settings;
  if (!complete.thickness) complete.thickness = default_thickness(impl_->fluid_settings.spacing);
  std::uint64_t handle = 0;
  Status s = impl_->attachments.attach(host, complete, impl_->settings, &handle);
  if (s.ok() && id) id->value = handle;
  return s;
}

void World::detach(SurfaceId id) {
  impl_->attachments.detach(id.value);
}

std::size_t World::surface_count() const {
  return impl_->attachments.all().size();
}

const SurfaceMotion* World::surface(SurfaceId id) const {
  const world::Attachment* a = impl_->attachments.find(id.value);
  return a ? &a->motion : nullptr;
}

void World::reset_motion(SurfaceId id) {
  // A refused surface remains refused until its next gather: its present motion is invalid.
  world::Attachment* a = impl_->attachments.find(id.value);
  if (!a) return;
  a->teleported = true;
  world::forget_load(*a);
}

Status World::set_slip(SurfaceId id, const SlipSettings& slip) {
  return set_slip(id, slip, slip);
}

Status World::set_slip(SurfaceId id, const SlipSettings& front, const SlipSettings& back) {
  world::Attachment* a = impl_->attachments.find(id.value);
  if (!a) return Status::refused("there is no surface " + std::to_string(id.value));
  SurfaceSettings changed = a->settings;
  changed.slip = front;
  changed.slip_back = back;
  Status s = changed.validate();
  if (s.ok()) a->settings = changed;
  return s;
}

Status World::add_particles(Span<const Vec3> given_positions, Span<const Vec3> given_velocities,
                            std::uint64_t* blocked) {
  if (!impl_->status.ok()) return impl_->status;
  // They may be spans of this world, whose arrays are about to grow.
  const std::vector<Vec3> positions(given_positions.begin(), given_positions.end()),
      velocities(given_velocities.begin(), given_velocities.end());
  if (positions.size() != velocities.size())
    return Status::refused("there are " + std::to_string(positions.size()) + " positions and " +
                           std::to_string(velocities.size()) + " velocities; they must be as many");
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (!world::is_in_range(positions[i]) || !world::is_in_range(velocities[i]))
      return Status::refused("particle " + std::to_string(i) + " is not finite");
  const std::vector<std::uint8_t> is_blocked = world::find_blocked_points(
      impl_->attachments.between_steps(impl_->fluid_settings), positions, *impl_->workers);
  impl_->state.particles.new_end = time() + impl_->state.max_age;
  impl_->state.particles.reserve_more(positions.size());
  const std::uint64_t limit = world::particle_limit(impl_->settings);
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (is_blocked[i] || !impl_->settings.kill_box.contains(positions[i]) || particle_count() >= limit) {
      ++count;
      continue;
    }
    impl_->state.particles.push_back(impl_->state.next_particle_id++, positions[i], velocities[i],
                                     impl_->fluid_settings.rest_density);
  }
  if (blocked) *blocked = count;
  return {};
}

std::size_t World::particle_count() const {
  return impl_->state.particles.size();
}
double World::particle_mass() const {
  return impl_->fluid ? impl_->fluid->particle_mass() : 0;
}
Span<const float> World::mass_ratios() const {
  return impl_->state.particles.mass_ratio;
}
double World::fluid_mass() const {
  return particle_mass() * impl_->state.particles.sum_of_relative_masses();
}
Span<const std::uint64_t> World::ids() const {
  return impl_->state.particles.id;
}
Span<const Vec3> World::positions() const {
  return impl_->state.particles.position;
}
Span<const Vec3> World::velocities() const {
  return impl_->state.particles.velocity;
}
Span<const Vec3> World::motions() const {
  return impl_->state.particles.motion;
}
Span<const double> World::densities() const {
  return impl_->state.particles.density;
}
Span<const double> World::pressures() const {
  return impl_->state.particles.pressure;
}

Status World::add_velocities(Span<const Vec3> dv) {
  if (dv.size() != impl_->state.particles.size())
    return Status::refused("there are " + std::to_string(dv.size()) + " values for " +
                           std::to_string(impl_->state.particles.size()) + " particles");
  for (std::size_t i = 0; i < dv.size(); ++i) {
    const Vec3 changed = impl_->state.particles.velocity[i] + dv[i];
    impl_->state.particles.motion[i] += dv[i];  // `dv` may be these, or the velocities of this world
    impl_->state.particles.velocity[i] = changed;
  }
  return {};
}

Status World::add_effect(Effect& effect) {
  if (!impl_->status.ok()) return impl_->status;
  return impl_->effects.add(effect, impl_->state.particles, impl_->attachments);
}

void World::remove_effect(const Effect& effect) {
  impl_->effects.remove(effect, impl_->state.particles, impl_->attachments);
}

std::vector<double>* World::Impl::particle_values(const Effect& effect, std::size_t channel) {
  const world::Effects::Slot* slot = effects.find(effect);
  if (slot == nullptr || channel >= slot->particle_start.size()) return nullptr;
  return &state.particles.values[slot->first_particle_value + channel];
}

/// A surface that was attached after the effect may not have its start values yet.
std::vector<double>* World::Impl::node_values(const Effect& effect, SurfaceId id, std::size_t channel) {
  const world::Effects::Slot* slot = effects.find(effect);
  world::Attachment* a = attachments.find(id.value);
  if (slot == nullptr || a == nullptr || channel >= slot->node_start.size()) return nullptr;
  effects.fill(*a);
  return &a->values[slot->first_node_value + channel];
}

Span<const double> World::absorbed(SurfaceId id) const {
  const world::Attachment* a = impl_->attachments.find(id.value);
  return a ? Span<const double>(a->motion.absorbed_mass) : Span<const double>();
}

double World::absorbed_mass() const {
  double sum = 0;
  for (const auto& a : impl_->attachments.all()) sum += world::absorbed_mass(*a);
  return sum;
}

Span<const double> World::particle_values(const Effect& effect, std::size_t channel) const {
  const std::vector<double>* values = impl_->particle_values(effect, channel);
  return values ? Span<const double>(*values) : Span<const double>();
}

Span<const double> World::node_values(const Effect& effect, SurfaceId id, std::size_t channel) const {
  const std::vector<double>* values = impl_->node_values(effect, id, channel);
  return values ? Span<const double>(*values) : Span<const double>();
}

namespace {

Status set_values(std::vector<double>* values, Span<const double> given) {
  if (values == nullptr) return Status::refused("there is no such effect, channel or surface");
  if (given.size() != values->size())
    return Status::refused("there are " + std::to_string(given.size()) + " values; it takes " +
                           std::to_string(values->size()));
  for (std::size_t i = 0; i < given.size(); ++i)
    if (!std::isfinite(given[i])) return Status::refused("value " + std::to_string(i) + " is not finite");
  std::copy(given.begin(), given.end(), values->begin());
  return {};
}

}  // namespace

Status World::set_particle_values(const Effect& effect, std::size_t channel, Span<const double> values) {
  return set_values(impl_->particle_values(effect, channel), values);
}

Status World::set_node_values(const Effect& effect, SurfaceId id, std::size_t channel,
                              Span<const double> values) {
  return set_values(impl_->node_values(effect, id, channel), values);
}

const StepReport& World::step(double dt) {
  Impl& w = *impl_;
  world::StepContext step(dt, particle_mass(), w.state.energy, w.settings.gravity);
  w.start_report(step.report, dt);
  if (w.status.ok()) step.report.status = world::check_dt(dt);
  if (step.report.status.ok()) w.try_step(step);
  std::swap(w.report, step.report);
  return w.report;
}

void World::Impl::start_report(StepReport& of_step, double dt) const {
  of_step.step = state.step_count;
  of_step.time = state.time;
  of_step.dt = dt;
  of_step.alive = state.particles.size();
  of_step.energy = state.energy.report;
  of_step.status = status;
}

/// Refuses what takes too long.
void World::Impl::try_step(world::StepContext& step) {
  try {
    run_step(step);
    contacts.swap(step.contacts);
    contact_surfaces.swap(step.contact_surfaces);
  } catch (const fluid::TooCrowded& crowd) {
    const double dt = std::exchange(step.report, StepReport()).dt;
    start_report(step.report, dt);
    step.report.status = Status::refused(crowd.what());
  }
}

double World::time() const {
  return impl_->state.time;
}
std::uint64_t World::step_count() const {
  return impl_->state.step_count;
}

const char* World::instruction_set() {
  if (fluid::instruction_set() == fluid::InstructionSet::avx512) return "AVX-512";
  if (fluid::instruction_set() == fluid::InstructionSet::avx2) return "AVX2";
#if defined(OILSKIN_VECTOR_EXTENSIONS) && defined(__SSE2__)
  return "SSE2";
#else
  return "generic";
#endif
}

std::uint64_t World::state_hash() const {
  const fluid::Particles& p = impl_->state.particles;
  std::vector<std::uint32_t> order(p.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return p.id[a] < p.id[b]; });
  Hash64 hash;
  for (std::uint32_t i : order) {
    hash.add(p.id[i]);
    hash.add(p.position[i]);
    hash.add(p.velocity[i]);
  }
  std::uint64_t number = 0;  // not the handle: a restored world has its own handles
  for (const auto& a : impl_->attachments.all()) {
    hash.add(++number);
    if (a->refused) continue;  // its motion is invalid
    for (const Vec3& x : a->motion.x_t1) hash.add(x);
    for (const Vec3& v : a->motion.velocity) hash.add(v);
  }
  return hash.value();
}

void World::set_observer(IntervalObserver* observer) {
  impl_->observer = observer;
}

}  // namespace oilskin
