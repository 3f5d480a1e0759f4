/// One coupled step, in order. docs/architecture.md has the table of what each stage reads and writes.
#include <algorithm>
#include <cmath>
#include <optional>

#include "contact/verify.h"
#include "core/assert.h"
#include "core/body_motion.h"
#include "world/absorption.h"
#include "world/carried_mass.h"
#include "world/gap_pressure.h"
#include "world/numeric_range.h"
#include "world/relocation.h"
#include "world/roll_back.h"
#include "world/world_impl.h"

namespace oilskin {

using world::IntervalContext;
using world::StepContext;

namespace {

constexpr std::size_t chunk_size = 2048;

[[maybe_unused]] bool all_finite(Span<const Vec3> values) {
  return std::all_of(values.begin(), values.end(), [](const Vec3& x) { return x.allFinite(); });
}

std::uint32_t flags_of(const StepReport& r, const ContactSettings& contact) {
  std::uint32_t flags = r.flags;
  if (!r.fluid.converged) flags |= flag_pressure_not_converged;
  if (r.fluid.diverged) flags |= flag_pressure_diverged;
  if (r.contact.allowed > 0) flags |= flag_leaked;
  if (r.contact.stalled > 0) flags |= flag_stalled;
  if (r.contact.removed > 0) flags |= flag_removed_by_contact;
  if (r.removed_invalid > 0) flags |= flag_removed_invalid;
  if (r.contact.held > 0) flags |= flag_many_holds;
  if (r.substeps_left_out > 0 || (r.iteration_limit > 0 && !r.fluid.converged)) flags |= flag_budget_limited;
  if (!contact.ccd || !contact.zones || r.contact.started_too_close > 0) flags |= flag_no_promise;
  return flags;
}

}  // namespace

void World::Impl::run_step(StepContext& step) {
  OILSKIN_ASSERT(step.dt > 0 && fluid && emission);
  world::RollBack<Impl> roll_back_on_exception(*this);
  step.contact = &contact_settings;
  begin_step(step);
  step.count(step.surfaces);
  choose_substeps(step);
  const double part = step.dt / step.report.substeps;
  step.paths.begin(step.surfaces.motion, step.report.substeps, part);
  emission->begin_step(state.time, step.dt);
  for (int k = 0; k < step.report.substeps; ++k) {
    IntervalContext interval(step, state.time + k * part, part, k);
    run_interval(interval);
  }
  step.paths.end();
  scatter(step);
  finish(step);
  roll_back_on_exception.dismiss();
  emission->commit(state.time);
}

void World::Impl::begin_step(StepContext& step) {
  book_withdrawn(step);
  state.particles.new_end = state.time + state.max_age;
  gather(step);  // surfaces: x_t0 → proposed x_t1
  remove_invalid_particles(step);
}

/// What is certified at once: a step, or one of its sub-steps.
void World::Impl::run_interval(IntervalContext& interval) {
  StepContext& step = interval.step;
  step.paths.next();  // surfaces: the next part of their motion
  step.count_before(step.paths, interval.is_first, state.last_dt);
  begin_interval(interval);  // x_t1 without pressure, to find contacts
  ParticleMotion motion = motion_of(interval);
  contact::ContactPass pass(interval.dt, contact_settings, *workers, motion, step.surfaces.motion,
                            step.surfaces.geometry, contact_buffers, interval.report, step.report.seconds);
  pass.find();
  propose(interval, pass);
  pass.set_start_velocity(state.particles.velocity);
  if (fluid_settings.boundary == BoundaryModel::mirrored) {
    state.particles.let_load_be_spared();
    pass.set_wall_impulses(fluid->wall_impulses(), state.particles.spare_load);
  }
  find_hosts(interval);
  pass.set_hosts(step.hosts);
  pass.solve();  // impulses, impacts, zones → certificate
  interval.removed_by_contact = interval.report.removed;
  step.contacts = pass.take_contacts();
  end_interval(interval, motion);
}

/// From the start of the step to the end of the interval [s].
double World::Impl::passed(const IntervalContext& interval) const {
  return (interval.begin - state.time) + interval.dt;  // at least dt, rounded or not
}

/// What friction may expect of them (C.43), (C.44).
void World::Impl::find_hosts(IntervalContext& interval) const {
  StepContext& step = interval.step;
  for (std::size_t k = 0; k < step.hosts.size(); ++k)
    if (!step.hosts[k].velocity.empty())
      fluid->load_memory().find_carried(*step.surfaces.motion[k], passed(interval), step.hosts[k].carried);
}

void World::Impl::begin_interval(IntervalContext& interval) {
  fluid->prepare(state.particles, interval.step.report.seconds);  // cell order, neighbours
  emit(interval);                                                 // starts of this interval, or blocked
  predict_motion(interval);
}

/// After pass.find(): where the fluid would go without contact.
void World::Impl::propose(IntervalContext& interval, contact::ContactPass& pass) {
  apply_surfaces(interval, pass);    // hidden neighbours, boundary terms
  act(interval);                     // forces of effects
  predict_contacts(interval, pass);  // bounds for the pressure solver
  propose_motion(interval);          // pressure, viscosity → x_t1
}

/// After the certificate.
void World::Impl::end_interval(IntervalContext& interval, const ParticleMotion& motion) {
  verify(interval, motion);                    // an independent check, when asked for
  exchange(interval, interval.step.contacts);  // of effects
  notify_observer(interval);
  commit(interval);  // no live particle has moved since the certificate
}

void World::Impl::gather(StepContext& step) {
  StageTimer timer(step.report.seconds.gather);
  step.surfaces = attachments.gather(step.dt, settings, fluid_settings, step.report);
  for (const world::Attachment* a : step.surfaces.attachment) step.contact_surfaces.push_back({a->handle});
  for (const SurfaceMotion* s : step.surfaces.motion) {
    step.hosts.emplace_back();
    if (s->still != 0 || !friction_follows_host(*s)) continue;
    std::vector<Vec3>& velocity = step.hosts.back().velocity;
    if (s->body)
      velocity = {s->body->velocity, s->body->angular_velocity};
    else
      velocity = s->velocity;
  }
  fluid->record_host_response(step.dt, settings.gravity, step.surfaces.motion);
  world::relocate_particles(step.surfaces, state.particles, state.next_particle_id, *workers, step.report,
                            step.ledger);
}

void World::Impl::apply_surfaces(IntervalContext& interval, contact::ContactPass& pass) {
  StepContext& step = interval.step;
  const bool needed = fluid_settings.occlusion || fluid_settings.boundary == BoundaryModel::mirrored ||
                      effects.wall_reach() > 0;
  if (!needed || step.surfaces.size() == 0) return;
  {
    StageTimer timer(step.report.seconds.proximity);
    interval.near = pass.find_triangles_near(fluid->boxes(state.particles), fluid->support_radius());
  }
  fluid->apply_surfaces(passed(interval), interval.dt, settings.gravity, state.particles,
                        step.surfaces.motion, step.surfaces.topology, interval.near, step.report.seconds);
}

void World::Impl::act(IntervalContext& interval) {
  if (effects.empty()) return;
  StageTimer timer(interval.step.report.seconds.effects);
  world::ActiveSurfaces& surfaces = interval.step.surfaces;
  for (world::Attachment* a : surfaces.attachment) effects.fill(*a);
  std::optional<world::VisibleWalls> walls;
  if (const double reach = effects.wall_reach(); reach > 0)
    walls.emplace(
        fluid->find_visible_walls(reach * fluid_settings.spacing, interval.dt, settings.gravity,
                                  state.particles, surfaces.motion, surfaces.topology, interval.near),
        surfaces.motion, fluid->support_radius());
  effects.act({interval, state.particles, *fluid, fluid_settings, settings.gravity, *workers,
               walls ? &*walls : nullptr});
  for (std::size_t i = 0; i < interval.live; ++i)
    interval.step.ledger.effect(state.particles.relative_mass(i), interval.dt, interval.acceleration[i]);
}

void World::Impl::exchange(IntervalContext& interval, Span<const Contact> near) {
  if (effects.empty()) return;
  StageTimer timer(interval.step.report.seconds.effects);
  effects.exchange({interval, state.particles, *fluid, fluid_settings, settings.gravity, *workers, nullptr},
                   near);
}

void World::Impl::predict_motion(IntervalContext& interval) const {
  const fluid::Particles& particles = state.particles;
  const std::size_t n = particles.size();
  OILSKIN_ASSERT(interval.live + interval.of_starts.size() == n);
  interval.velocity.resize(n);
  interval.inverse_mass.resize(n);
  interval.removed.assign(n, 0);
  interval.x_t1.resize(n);
  const double inverse_mass = 1 / fluid->particle_mass();
  workers->for_each(n, chunk_size, [&](std::size_t i) {
    const double t = interval.remaining(i);
    interval.velocity[i] = particles.velocity[i];
    interval.inverse_mass[i] = inverse_mass;
    if (particles.mass_varies) interval.inverse_mass[i] /= particles.relative_mass(i);
    interval.x_t1[i] = particles.position[i] + t * (particles.velocity[i] + t * settings.gravity);
  });
}

/// Refers to the arrays of the interval and of the particles, which must stay where they are.
ParticleMotion World::Impl::motion_of(IntervalContext& interval) {
  ParticleMotion motion;
  motion.id = state.particles.id;
  motion.x_t0 = state.particles.position;
  motion.x_t1 = interval.x_t1;
  motion.velocity = interval.velocity;
  motion.inverse_mass = interval.inverse_mass;
  motion.removed = interval.removed;
  motion.spacing = fluid_settings.spacing;
  motion.rest_density = fluid_settings.rest_density;
  motion.viscosity = fluid_settings.viscosity;
  return motion;
}

void World::Impl::predict_contacts(IntervalContext& interval, contact::ContactPass& pass) const {
  if (!fluid_settings.contact_aware) return;
  const std::vector<SurfaceMotion*>& surfaces = interval.step.surfaces.motion;
  for (const Contact& c : pass.select_contacts()) {
    if (c.particle >= interval.live) continue;  // emitted: not in the pair sums yet
    OILSKIN_ASSERT(c.surface < surfaces.size() && c.distance >= 0);
    const SurfaceMotion& s = *surfaces[c.surface];
    Vec3 wall = Vec3::Zero();
    for (int k = 0; k < 3; ++k) wall += c.weights[k] * (s.x_t1[c.nodes[k]] - s.x_t0[c.nodes[k]]);
    const double free_distance = std::max(0.0, c.distance - s.thickness);
    interval.prediction.push_back({c.particle, c.normal, (wall.dot(c.normal) - free_distance) / interval.dt});
  }
}

void World::Impl::propose_motion(IntervalContext& interval) {
  StepContext& step = interval.step;
  FluidReport found;
  fluid->propose(interval.dt, settings.gravity, state.particles, interval.prediction, interval.acceleration,
                 interval.velocity, found, step.report.seconds);
  step.report.fluid = interval.is_first ? found : worst_of(step.report.fluid, found);
  press_gaps(interval);
  StageTimer timer(step.report.seconds.other_fluid);
  struct Proposed {
    double change = 0;  // the largest, squared
    std::uint64_t removed = 0;
    void operator+=(const Proposed& o) {
      change = std::max(change, o.change);
      removed += o.removed;
    }
  };
  const Proposed all = workers->ordered_sum(
      interval.velocity.size(), chunk_size, Proposed(), [&](std::size_t begin, std::size_t end) {
        Proposed part;
        for (std::size_t i = begin; i < end; ++i)
          if (propose_end(interval, i)) {
            if (i < interval.live)
              part.change =
                  std::max(part.change, (interval.velocity[i] - state.particles.velocity[i]).squaredNorm());
          } else {
            ++part.removed;
          }
        return part;
      });
  step.report.removed_invalid += all.removed;
  OILSKIN_ASSERT(all_finite(interval.x_t1) && all_finite(interval.velocity));
  state.max_acceleration = std::sqrt(all.change) / interval.dt;
}

/// With contact alone, water has no pressure at walls.
void World::Impl::press_gaps(IntervalContext& interval) {
  if (fluid_settings.boundary != BoundaryModel::mirrored) return;
  StepContext& step = interval.step;
  StageTimer timer(step.report.seconds.boundary);
  world::GapWater water;
  water.position = {state.particles.position.data(), interval.live};
  water.pressure = {state.particles.pressure.data(), interval.live};
  water.given = fluid->body_impulses();
  water.spacing = fluid_settings.spacing;
  water.rest_density = fluid_settings.rest_density;
  water.gravity = settings.gravity;
  step.energy.drive(
      world::press_gaps(water, step.surfaces.motion, step.surfaces.geometry, interval.dt, *workers));
}

/// Whether its numbers are in range; otherwise the particle stays and is removed.
bool World::Impl::propose_end(IntervalContext& interval, std::size_t i) const {
  const Vec3& x_t0 = state.particles.position[i];
  Vec3 &x_t1 = interval.x_t1[i], &velocity = interval.velocity[i];
  const Vec3 ballistic = state.particles.velocity[i] + interval.remaining(i) * settings.gravity;
  if (i >= interval.live) velocity = ballistic;
  x_t1 = x_t0 + interval.remaining(i) * velocity;
  if (world::is_in_range(x_t1) && world::is_in_range(velocity)) return true;
  x_t1 = x_t0;
  if (!velocity.allFinite()) velocity = ballistic;  // the momentum that the ledger counts as removed
  interval.removed[i] = 1;
  return false;
}

void World::Impl::verify(IntervalContext& interval, const ParticleMotion& motion) const {
  if (!interval.step.contact->verify) return;
  StageTimer timer(interval.step.report.seconds.verify);
  interval.report.crossings_found_by_verify = contact::count_crossings(
      motion, interval.step.surfaces.motion, *workers, &interval.report.verified_pairs);
}

void World::Impl::notify_observer(IntervalContext& interval) {
  const std::uint64_t number = state.interval_count++;
  if (!observer) return;
  std::vector<std::uint64_t> id;
  std::vector<Vec3> x_t0, x_t1;
  for (std::size_t i = 0; i < interval.x_t1.size(); ++i) {
    if (interval.removed[i]) continue;
    id.push_back(state.particles.id[i]);
    x_t0.push_back(state.particles.position[i]);
    x_t1.push_back(interval.x_t1[i]);
  }
  Interval certified;
  certified.number = number;
  certified.length = interval.dt;
  certified.id = id;
  certified.x_t0 = x_t0;
  certified.x_t1 = x_t1;
  certified.surfaces = interval.step.surfaces.motion;
  observer->on_interval(certified);
}

void World::Impl::commit(IntervalContext& interval) {
  StepContext& step = interval.step;
  StageTimer timer(step.report.seconds.other_fluid);
  fluid::Particles& particles = state.particles;
  OILSKIN_ASSERT(interval.x_t1.size() == particles.size() && interval.velocity.size() == particles.size());
  OILSKIN_ASSERT(all_finite(interval.x_t1) && all_finite(interval.velocity));
  std::vector<std::uint8_t> keep(particles.size(), 1);
  if (state.sinks.act()) interval.taken_by.assign(particles.size(), world::Sinks::none);
  step.energy.touch(step.counted, interval.dt, step.counted_before,
                    interval.is_first ? state.last_dt : interval.dt);
  const world::EndSums all = workers->ordered_sum(particles.size(), chunk_size, world::EndSums(),
                                                  [&](std::size_t begin, std::size_t end) {
                                                    world::EndSums sums;
                                                    for (std::size_t i = begin; i < end; ++i) {
                                                      particles.velocity[i] = interval.velocity[i];
                                                      keep[i] = commit_particle(interval, i, sums);
                                                      const double ratio = particles.relative_mass(i);
                                                      if (keep[i])
                                                        sums.ledger.stays(ratio, particles.velocity[i]);
                                                      else
                                                        sums.ledger.leaves(ratio, particles.velocity[i]);
                                                    }
                                                    return sums;
                                                  });
  step.ledger.end_interval(all.ledger);
  step.energy.end_interval(all.energy, state.next_particle_id, interval.dt);
  step.report.removed += interval.removed_by_contact + all.removed;
  step.report.removed_by_age += all.removed_by_age;
  step.report.removed_too_fast += all.removed_too_fast;
  step.report.absorbed += all.absorbed;
  step.report.contact.add(interval.report);
  count_taken(interval, keep);
  particles.compress(keep);
  step.report.alive = particles.size();
}

/// Whether the particle remains.
bool World::Impl::commit_particle(IntervalContext& interval, std::size_t i, world::EndSums& sums) {
  fluid::Particles& particles = state.particles;
  const world::EnergyBalance& energy = interval.step.energy;
  const Vec3 start = particles.position[i];
  particles.position[i] = interval.x_t1[i];
  const bool inside = settings.kill_box.contains(particles.position[i]);
  if (interval.removed[i]) {
    energy.lose(particles, i, start, interval.dt, sums.energy);
    return false;
  }
  const Vec3 motion_before = particles.motion[i];
  world::EnergyBalance::move(particles, i, start, interval.remaining(i), interval.dt);
  if (!interval.acceleration.empty() && i < interval.live)
    energy.drive(particles.relative_mass(i), interval.driving_acceleration(i),
                 0.5 * (motion_before + particles.motion[i]), interval.dt, sums.energy);
  if (!interval.mass_left.empty() && !keep_mass(interval, i, sums)) return false;
  if (inside && !takes(interval, i, sums)) {
    energy.stay(particles, i, interval.dt, sums.energy);
    return true;
  }
  energy.leave(particles, i, interval.dt, sums.energy);
  ++sums.removed;
  if (!inside && energy.is_too_fast(particles, i)) ++sums.removed_too_fast;
  return false;
}

/// What surfaces absorbed leaves particle i. Whether it has any mass left.
bool World::Impl::keep_mass(IntervalContext& interval, std::size_t i, world::EndSums& sums) {
  fluid::Particles& particles = state.particles;
  float& mass = particles.mass_ratio[i];
  const float left = interval.mass_left[i];
  interval.step.energy.absorb(particles, i, static_cast<double>(mass) - static_cast<double>(left),
                              interval.dt, sums.energy);
  mass = left;
  if (left > 0) return true;
  ++sums.absorbed;
  return false;
}

void World::Impl::release(StepContext& step) {
  if (step.releases.empty()) return;
  StageTimer timer(step.report.seconds.effects);
  world::release_particles(step.releases, step.surfaces, settings, fluid_settings.spacing,
                           fluid_settings.rest_density, fluid->particle_mass(), *workers, state.particles,
                           state.next_particle_id, step.ledger);
  step.report.alive = state.particles.size();
}

void World::Impl::scatter(StepContext& step) {
  StageTimer timer(step.report.seconds.gather);
  state.particles.new_end = state.time + step.dt + state.max_age;
  release(step);
  fluid->record_load(step.dt, step.surfaces.motion);
  for (world::Attachment* a : step.surfaces.attachment)
    world::update_carried_mass(step.dt, fluid_settings, *a, *workers, step.report);
  std::vector<std::vector<Vec3>> impulses;  // of contact and pressure alone
  for (world::Attachment* a : step.surfaces.attachment)
    impulses.push_back(world::add_momentum_of_liquid(*a, a->motion));
  world::Attachments::scatter(step.surfaces, step.report);
  for (std::size_t s = 0; s < impulses.size(); ++s)
    if (!impulses[s].empty()) step.surfaces.motion[s]->impulse.swap(impulses[s]);
  for (const world::Attachment* a : step.surfaces.attachment)
    step.energy.end_surface(a->motion, step.dt, world::Attachments::before(*a), state.last_dt, *workers);
}

void World::Impl::finish(StepContext& step) {
  OILSKIN_ASSERT(all_finite(state.particles.position) && all_finite(state.particles.velocity));
  OILSKIN_ASSERT(step.report.alive == state.particles.size());
  step.report.energy = step.energy.finish(state.particles.sum_of_relative_masses(), step.mass_of_others,
                                          step.dt, fluid_settings.spacing);
  state.time += step.dt;
  state.last_dt = step.dt;
  ++state.step_count;
  step.report.time = state.time;
  if (step.report.contact.crossings_found_by_verify > 0 && step.contact->ccd && step.contact->zones)
    step.report.messages.push_back("verify found particles that crossed a surface or ended nearer than δ");
  step.report.flags = flags_of(step.report, *step.contact);
  if (settings.step_budget > 0) budget.learn(step.report);
  if (step.report.energy.risen > energy_made_limit * step.report.energy.scale) advise_on_energy(step);
}

}  // namespace oilskin
