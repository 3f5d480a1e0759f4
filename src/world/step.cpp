/// One coupled step, in order. docs/architecture.md has the table of what each stage reads and writes.
#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "world/numeric_range.h"
#include "world/world_impl.h"

namespace oilskin {

namespace {

[[maybe_unused]] bool all_finite(Span<const Vec3> values) {
  return std::all_of(values.begin(), values.end(), [](const Vec3& x) { return x.allFinite(); });
}

}  // namespace

void World::Impl::run_step(double dt) {
  OILSKIN_ASSERT(dt > 0 && fluid && emission && contact);
  gather(dt);  // surfaces: x_t0 → proposed x_t1
  remove_invalid_particles();
  choose_substeps(dt);  // how many sub-steps
  const double begin = time, part = dt / report.substeps;
  for (substep = 0; substep < report.substeps; ++substep) {
    time = begin + substep * part;
    run_interval(part);
  }
  scatter();
  OILSKIN_ASSERT(all_finite(particles.position) && all_finite(particles.velocity));
  OILSKIN_ASSERT(report.alive == particles.size());
  time = begin + dt;
  last_dt = dt;
  ++step_count;
}

/// What is certified at once: a step, or one of its sub-steps.
void World::Impl::run_interval(double dt) {
  paths.next();                               // surfaces: a part of their way
  fluid->prepare(particles, report.seconds);  // cell order, neighbours
  emit(dt);                                   // starts of this interval, or blocked
  predict_motion();                           // x_t1 without pressure, to find contacts
  contact_report = {};
  contact->begin(dt, contact_settings, motion, surfaces, contact_report, report.seconds);
  // hidden neighbours, boundary terms
  fluid->apply_surfaces(dt, settings.gravity, particles, surfaces, report.seconds);
  predict_contacts(dt);  // bounds for the pressure solver
  propose_motion(dt);    // pressure, viscosity → x_t1
  contact->run();        // impulses, meetings, zones → certificate
  certify();             // an independent check, when asked for
  notify_observer(dt);
  commit();  // nothing live has moved since the certificate
}

void World::Impl::gather(double dt) {
  contact::StageTimer timer(report.seconds.gather);
  std::vector<std::uint64_t> stale;
  attachments.gather(dt, settings, fluid_settings, report, surfaces, stale);
  for (std::uint64_t id : stale) {
    contact->forget(id);
    fluid->forget(id);
  }
  fluid->record_host_response(dt, settings.gravity, surfaces);
  attachments.relocate_particles(surfaces, particles, fluid->particle_mass(), next_particle_id, *workers,
                                 report);
}

void World::Impl::remove_invalid_particles() {
  std::vector<std::uint8_t> keep(particles.size(), 1);
  bool any = false;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (world::is_in_range(particles.position[i]) && world::is_in_range(particles.velocity[i])) continue;
    keep[i] = 0;
    any = true;
    ++report.removed_invalid;
    report.mass_removed += fluid->particle_mass();
  }
  if (any) particles.compress(keep);
  OILSKIN_ASSERT(all_finite(particles.position) && all_finite(particles.velocity));
}

void World::Impl::emit(double dt) {
  contact::StageTimer timer(report.seconds.other_fluid);
  const std::size_t live = particles.size();
  OILSKIN_ASSERT(substep < report.substeps && dt > 0);
  const std::vector<fluid::Start>& starts = emission->due(time, dt);
  std::vector<Vec3> points;
  points.reserve(starts.size());
  for (const fluid::Start& s : starts) points.push_back(s.position);
  std::vector<std::uint8_t> blocked;
  world::ClearanceTest(surfaces, *workers).run(points, blocked);
  for (std::size_t k = 0; k < starts.size(); ++k)  // outside the kill box nothing starts
    if (!settings.kill_box.contains(points[k])) blocked[k] = 1;
  std::size_t emitted = 0;
  for (std::uint8_t b : blocked) emitted += b == 0;

  now.resize(live + emitted);
  const double mass = fluid->particle_mass();
  std::fill(now.inverse_mass.begin(), now.inverse_mass.end(), 1 / mass);
  for (std::size_t i = 0; i < live; ++i) {
    now.id[i] = particles.id[i];
    now.x_t0[i] = particles.position[i];
    now.velocity[i] = particles.velocity[i];
    now.remaining[i] = dt;
    if (substep == 0) report.momentum_before += mass * particles.velocity[i];
  }
  std::size_t at = live;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    if (blocked[k]) continue;
    now.id[at] = next_particle_id++;
    now.x_t0[at] = starts[k].position;
    now.velocity[at] = starts[k].velocity;
    now.remaining[at] = starts[k].remaining;
    OILSKIN_ASSERT(starts[k].remaining >= 0 && starts[k].remaining <= dt);
    report.momentum_emitted += mass * starts[k].velocity;
    report.momentum_gravity += mass * starts[k].remaining * settings.gravity;
    ++at;
  }
  OILSKIN_ASSERT(at == now.id.size());
  report.blocked_starts += emission->settle(blocked);
  report.emitted += emitted;
  report.mass_emitted += static_cast<double>(emitted) * mass;
  report.momentum_gravity += static_cast<double>(live) * mass * dt * settings.gravity;
}

void World::Impl::predict_motion() {
  motion.id = now.id;
  motion.x_t0 = now.x_t0;
  motion.x_t1 = now.x_t1;
  motion.velocity = now.velocity;
  motion.inverse_mass = now.inverse_mass;
  motion.removed = now.removed;
  motion.spacing = fluid_settings.spacing;
  motion.rest_density = fluid_settings.rest_density;
  motion.viscosity = fluid_settings.viscosity;
  for (std::size_t i = 0; i < now.id.size(); ++i) {
    const double t = now.remaining[i];
    now.x_t1[i] = now.x_t0[i] + t * (now.velocity[i] + t * settings.gravity);
  }
}

void World::Impl::predict_contacts(double dt) {
  prediction.clear();
  if (!fluid_settings.contact_aware) return;
  for (const Contact& r : contact->select_contacts()) {
    if (r.particle >= particles.size()) continue;  // emitted: not in the pair sums yet
    OILSKIN_ASSERT(r.surface < surfaces.size() && r.distance >= 0);
    const SurfaceMotion& s = *surfaces[r.surface];
    Vec3 wall = Vec3::Zero();
    for (int k = 0; k < 3; ++k) wall += r.weights[k] * (s.x_t1[r.nodes[k]] - s.x_t0[r.nodes[k]]);
    const double free_distance = std::max(0.0, r.distance - s.thickness);
    prediction.push_back({r.particle, r.normal, (wall.dot(r.normal) - free_distance) / dt});
  }
}

void World::Impl::propose_motion(double dt) {
  FluidReport found;
  fluid->propose(dt, settings.gravity, particles, prediction, found, report.seconds);
  report.fluid = substep == 0 ? found : worst_of(report.fluid, found);
  contact::StageTimer timer(report.seconds.other_fluid);
  const std::size_t live = particles.size();
  OILSKIN_ASSERT(live <= now.id.size() && now.x_t1.size() == now.id.size());
  double change = 0;  // squared
  for (std::size_t i = 0; i < now.id.size(); ++i) {
    const Vec3 before = now.velocity[i], ballistic = before + now.remaining[i] * settings.gravity;
    now.velocity[i] = i < live ? particles.velocity[i] : ballistic;
    now.x_t1[i] = now.x_t0[i] + now.remaining[i] * now.velocity[i];
    if (world::is_in_range(now.x_t1[i]) && world::is_in_range(now.velocity[i])) {
      if (i < live) change = std::max(change, (now.velocity[i] - before).squaredNorm());
      continue;
    }
    now.x_t1[i] = now.x_t0[i];
    if (!now.velocity[i].allFinite()) now.velocity[i] = ballistic;  // it leaves with what it is booked with
    now.removed[i] = 1;
    ++report.removed_invalid;
  }
  OILSKIN_ASSERT(all_finite(now.x_t1) && all_finite(now.velocity));
  max_acceleration = std::sqrt(change) / dt;
}

void World::Impl::certify() {
  if (!contact_settings.verify) return;
  contact::StageTimer timer(report.seconds.verify);
  contact_report.crossings_found_by_verify =
      ContactSolver::count_crossings(motion, surfaces, &contact_report.verified_pairs);
}

void World::Impl::notify_observer(double dt) {
  const std::uint64_t number = interval_count++;
  if (!observer) return;
  Interval interval;
  interval.number = number;
  interval.length = dt;
  interval.surfaces = surfaces;
  std::vector<std::uint64_t> id;
  std::vector<Vec3> x_t0, x_t1;
  for (std::size_t i = 0; i < now.id.size(); ++i) {
    if (now.removed[i]) continue;
    id.push_back(now.id[i]);
    x_t0.push_back(now.x_t0[i]);
    x_t1.push_back(now.x_t1[i]);
  }
  interval.id = id;
  interval.x_t0 = x_t0;
  interval.x_t1 = x_t1;
  observer->on_interval(interval);
}

void World::Impl::commit() {
  contact::StageTimer timer(report.seconds.other_fluid);
  const double mass = fluid->particle_mass();
  OILSKIN_ASSERT(mass > 0 && now.removed.size() == now.id.size());
  OILSKIN_ASSERT(all_finite(now.x_t1) && all_finite(now.velocity));
  for (std::size_t i = particles.size(); i < now.id.size(); ++i)
    particles.push_back(now.id[i], now.x_t0[i], now.velocity[i], fluid_settings.rest_density);
  std::vector<std::uint8_t> keep(particles.size(), 1);
  report.momentum_after.setZero();
  for (std::size_t i = 0; i < particles.size(); ++i) {
    particles.position[i] = now.x_t1[i];
    particles.velocity[i] = now.velocity[i];
    const bool left = !settings.kill_box.contains(now.x_t1[i]);
    if (!now.removed[i] && !left) {
      report.momentum_after += mass * now.velocity[i];
      continue;
    }
    keep[i] = 0;
    report.momentum_removed += mass * now.velocity[i];
    report.mass_removed += mass;
    if (!now.removed[i]) ++report.removed;
  }
  report.removed += contact_report.removed;
  report.contact.add(contact_report);
  particles.compress(keep);
  report.alive = particles.size();
}

void World::Impl::scatter() {
  contact::StageTimer timer(report.seconds.gather);
  paths.end();
  fluid->record_load(report.dt, surfaces);
  attachments.scatter(surfaces, report);
}

}  // namespace oilskin
