#include "contact/contact_loop.h"

#include <algorithm>

#include "contact/friction.h"
#include "contact/impacts.h"
#include "contact/zones.h"
#include "core/assert.h"

namespace oilskin::contact {

void ContactLoop::begin(double dt, const ContactSettings& settings, ParticleMotion& particles,
                        Span<SurfaceMotion* const> surfaces, ContactReport& report, StageSeconds& seconds) {
  StageTimer timer(seconds.proximity);
  OILSKIN_ASSERT(dt > 0);
  context_.dt = dt;
  context_.settings = &settings;
  context_.workers = workers_.get();
  context_.particles = &particles;
  context_.surfaces = surfaces;
  context_.report = &report;
  context_.seconds = &seconds;
  context_.epoch = 1;
  OILSKIN_ASSERT(particles.x_t0.size() == particles.id.size() &&
                 particles.x_t1.size() == particles.id.size());
  OILSKIN_ASSERT(particles.velocity.size() == particles.id.size());
  OILSKIN_ASSERT(particles.removed.size() == particles.id.size() && particles.spacing > 0);
  context_.particle_stamp.assign(particles.id.size(), 0);
  context_.out_of_play.assign(particles.id.size(), 0);
  prepare_surfaces();
  candidates_.collect(context_);
  contacts_.find(context_, candidates_);
}

void ContactLoop::prepare_surfaces() {
  const std::size_t count = context_.surfaces.size();
  context_.caches.resize(count);
  context_.node_stamp.resize(count);
  context_.surface_stamp.assign(count, 0);
  for (std::size_t k = 0; k < count; ++k) {
    SurfaceMotion& s = *context_.surfaces[k];
    const std::size_t nodes = s.x_t0.size();
    OILSKIN_ASSERT(s.id != 0 && s.delta > 0);
    OILSKIN_ASSERT(s.thickness >= 4 * s.delta);
    OILSKIN_ASSERT(s.holdable.empty() || s.holdable.size() == nodes);
    OILSKIN_ASSERT(s.x_t1.size() == nodes && s.velocity.size() == nodes && s.inverse_mass.size() == nodes);
    SurfaceCache& cache = caches_[s.id];
    if (cache.id != s.id) {
      cache.id = s.id;
      cache.topology = MeshTopology(s.triangles, nodes);
    }
    context_.caches[k] = &cache;
    context_.node_stamp[k].assign(nodes, 0);
    s.impulse.assign(nodes, Vec3::Zero());
    s.moved.assign(nodes, 0);
  }
}

const std::vector<Contact>& ContactLoop::select_contacts() {
  StageTimer timer(context_.seconds->impulses);
  contacts_.select_active(context_, active_);
  return active_;
}

void ContactLoop::run() {
  OILSKIN_ASSERT(context_.settings != nullptr && context_.dt > 0);  // begin() comes first
  const ContactSettings& settings = *context_.settings;
  {
    StageTimer timer(context_.seconds->proximity);
    std::fill(context_.particle_stamp.begin(), context_.particle_stamp.end(), context_.epoch);
    for (std::size_t p = 0; p < context_.particle_count(); ++p)
      if (context_.particles->removed[p]) context_.out_of_play[p] = 1;  // quarantined since begin()
    contacts_.update(context_, candidates_, candidates_.refresh(context_, 1));
    context_.report->candidates = candidates_.size();
  }
  const double energy_before = kinetic_energy();
  select_contacts();
  {
    StageTimer timer(context_.seconds->impulses);
    std::vector<ContactConstraint> constraints;
    constraints.reserve(active_.size());
    for (const Contact& r : active_) constraints.push_back(make_constraint(context_, r));
    distribute_wall_area(context_, constraints);
    split_gap_between_opposing_contacts(context_, constraints);
    solve_constraints(context_, constraints);
    context_.report->contacts = active_.size();
    for (const Contact& r : active_)
      context_.report->started_too_close += r.distance < context_.surfaces[r.surface]->delta;
  }
  bool certified = false;
  for (int round = 0; settings.ccd && round < settings.ccd_iterations && !certified; ++round) {
    std::vector<Violation> violations;
    {
      StageTimer timer(context_.seconds->ccd);
      violations = find_violations(context_, candidates_);
    }
    certified = violations.empty();
    if (certified) break;
    StageTimer timer(context_.seconds->impulses);
    ++context_.report->ccd_iterations;
    context_.report->impacts += violations.size();
    std::vector<ContactConstraint> constraints = impact_constraints(context_, violations, round);
    OILSKIN_ASSERT(constraints.size() == violations.size());
    solve_constraints(context_, constraints);
  }
  if (settings.zones && !certified) run_zones(context_, candidates_);
  book_impulses();
  context_.report->kinetic_energy_change = kinetic_energy() - energy_before;
}

double ContactLoop::kinetic_energy() const {
  double energy = 0;
  const ParticleMotion& particles = *context_.particles;
  for (std::size_t p = 0; p < particles.id.size(); ++p)
    if (particles.inverse_mass[p] > 0)
      energy += 0.5 * particles.velocity[p].squaredNorm() / particles.inverse_mass[p];
  for (const SurfaceMotion* s : context_.surfaces)
    for (std::size_t i = 0; i < s->velocity.size(); ++i)
      if (s->inverse_mass[i] > 0) energy += 0.5 * s->velocity[i].squaredNorm() / s->inverse_mass[i];
  return energy;
}

void ContactLoop::book_impulses() {
  ContactReport& report = *context_.report;
  for (std::uint32_t k = 0; k < context_.surfaces.size(); ++k) {
    const SurfaceMotion& s = *context_.surfaces[k];
    OILSKIN_ASSERT(s.impulse.size() == s.inverse_mass.size());
    for (std::size_t i = 0; i < s.impulse.size(); ++i)
      (s.inverse_mass[i] > 0 ? report.impulse_on_free_nodes : report.impulse_on_prescribed) += s.impulse[i];
  }
  OILSKIN_ASSERT(report.impulse_on_free_nodes.allFinite() && report.impulse_on_prescribed.allFinite());
  report.min_distance = std::min(report.min_distance, candidates_.min_end_distance(context_));
}

}  // namespace oilskin::contact
