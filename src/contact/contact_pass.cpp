#include "contact/contact_pass.h"

#include <algorithm>

#include "contact/friction.h"
#include "contact/impacts.h"
#include "contact/wall_friction.h"
#include "contact/zones.h"
#include "core/assert.h"
#include "core/body_motion.h"

namespace oilskin::contact {

ContactPass::ContactPass(double dt, const ContactSettings& settings, const Workers& workers,
                         ParticleMotion& particles, Span<SurfaceMotion* const> surfaces,
                         Span<SurfaceGeometry* const> geometry, ContactBuffers& buffers,
                         ContactReport& report, StageSeconds& seconds)
    : candidates_(buffers.candidates), contacts_(buffers.contacts), near_(buffers.near) {
  OILSKIN_ASSERT(dt > 0 && geometry.size() == surfaces.size());
  context_.dt = dt;
  context_.settings = &settings;
  context_.workers = &workers;
  context_.particles = &particles;
  context_.liquids.emplace_back(particles);
  context_.surfaces = surfaces;
  context_.geometry = geometry;
  context_.report = &report;
  context_.seconds = &seconds;
}

void ContactPass::find() {
  StageTimer timer(context_.seconds->proximity);
  const ParticleMotion& particles = *context_.particles;
  const std::size_t n = particles.id.size();
  OILSKIN_ASSERT(particles.x_t0.size() == n && particles.x_t1.size() == n && particles.velocity.size() == n);
  OILSKIN_ASSERT(particles.inverse_mass.size() == n && particles.removed.size() == n);
  OILSKIN_ASSERT(context_.liquid_index.empty() || context_.liquid_index.size() == n);
  OILSKIN_ASSERT(std::all_of(context_.liquids.begin(), context_.liquids.end(),
                             [](const Liquid& liquid) { return liquid.spacing > 0; }));
  context_.epoch = 1;
  context_.particle_stamp.assign(n, 0);
  context_.out_of_play.assign(n, 0);
  reset_surfaces();
  candidates_.collect(context_);
  contacts_.find(context_, candidates_);
}

namespace {

void clear_impulses(SurfaceMotion& s) {
  const std::size_t nodes = s.x_t0.size();
  if (s.still != 0 && s.impulse.size() == nodes && s.moved.size() == nodes) {
    for (std::uint32_t node : s.touched) {
      s.impulse[node].setZero();
      s.moved[node] = 0;
    }
  } else {
    s.impulse.assign(nodes, Vec3::Zero());
    s.moved.assign(nodes, 0);
  }
  s.touched.clear();
}

/// Ascending, each once, without nodes whose impulses cancel.
void sort_touched(SurfaceMotion& s) {
  const auto is_left_alone = [&](std::uint32_t i) { return s.impulse[i].isZero(0) && s.moved[i] == 0; };
  std::vector<std::uint32_t>& nodes = s.touched;
  nodes.erase(std::remove_if(nodes.begin(), nodes.end(), is_left_alone), nodes.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
}

}  // namespace

void ContactPass::reset_surfaces() {
  const std::size_t count = context_.surfaces.size();
  context_.node_stamp.resize(count);
  context_.surface_stamp.assign(count, 0);
  for (std::size_t k = 0; k < count; ++k) {
    SurfaceMotion& s = *context_.surfaces[k];
    const std::size_t nodes = s.x_t0.size();
    OILSKIN_ASSERT(s.id != 0 && context_.geometry[k]->id == s.id);
    OILSKIN_ASSERT(context_.geometry[k]->topology.triangle_count() == s.triangles.size());
    OILSKIN_ASSERT(s.delta > 0 && s.thickness >= 4 * s.delta);
    OILSKIN_ASSERT(s.holdable.empty() || s.holdable.size() == nodes);
    OILSKIN_ASSERT(s.x_t1.size() == nodes && s.velocity.size() == nodes && s.inverse_mass.size() == nodes);
    context_.node_stamp[k].clear();
    clear_impulses(s);
  }
}

const std::vector<Contact>& ContactPass::select_contacts() {
  StageTimer timer(context_.seconds->impulses);
  contacts_.select_active(context_, active_);
  return active_;
}

void ContactPass::solve() {
  OILSKIN_ASSERT(context_.particle_stamp.size() == context_.particle_count());  // find() comes first
  update_contacts();
  const double energy_before = kinetic_energy();
  bodies_before_.clear();
  for (const SurfaceMotion* s : context_.surfaces) bodies_before_.push_back(s->body);
  select_contacts();
  solve_contacts();
  const bool certified = solve_impacts();
  if (context_.settings->zones && !certified) run_zones(context_, candidates_);
  record_impulses();
  context_.report->kinetic_energy_change = kinetic_energy() - energy_before + body_energy_change();
}

// Every end may have changed since find(), and particles may have been removed.
void ContactPass::update_contacts() {
  StageTimer timer(context_.seconds->proximity);
  std::fill(context_.particle_stamp.begin(), context_.particle_stamp.end(), context_.epoch);
  for (std::size_t p = 0; p < context_.particle_count(); ++p)
    if (context_.particles->removed[p]) context_.out_of_play[p] = 1;
  contacts_.update(context_, candidates_, candidates_.refresh(context_, 1));
  context_.report->candidates = candidates_.size();
}

void ContactPass::solve_contacts() {
  StageTimer timer(context_.seconds->impulses);
  std::vector<ContactConstraint> constraints;
  constraints.reserve(active_.size());
  for (const Contact& c : active_) constraints.push_back(make_constraint(context_, c));
  split_gap_between_opposing_contacts(context_, constraints);
  add_wall_impulses(context_, constraints);
  distribute_wall_area(context_, constraints);
  solve_constraints(context_, constraints);
  keep_spare_load(context_, constraints);
  context_.report->contacts = active_.size();
  for (const Contact& c : active_)
    context_.report->started_too_close += c.distance < context_.surfaces[c.surface]->delta;
}

// True: a detection found nothing, which is the certificate.
bool ContactPass::solve_impacts() {
  const ContactSettings& settings = *context_.settings;
  for (int round = 0; settings.ccd && round < settings.ccd_iterations; ++round) {
    std::vector<Violation> violations;
    {
      StageTimer timer(context_.seconds->ccd);
      violations = find_violations(context_, candidates_);
    }
    if (violations.empty()) return true;
    solve_impacts_of_round(violations, round);
  }
  return false;
}

void ContactPass::solve_impacts_of_round(const std::vector<Violation>& violations, int round) {
  StageTimer timer(context_.seconds->impulses);
  ++context_.report->ccd_iterations;
  context_.report->impacts += violations.size();
  std::vector<ContactConstraint> constraints = impact_constraints(context_, violations, round);
  OILSKIN_ASSERT(constraints.size() == violations.size());
  solve_constraints(context_, constraints);
}

double ContactPass::kinetic_energy() const {
  const ParticleMotion& particles = *context_.particles;
  constexpr std::size_t chunk = 1024;
  double energy =
      context_.workers->ordered_sum(particles.id.size(), chunk, 0.0, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t p = begin; p < end; ++p)
          if (particles.inverse_mass[p] > 0)
            sum += 0.5 * particles.velocity[p].squaredNorm() / particles.inverse_mass[p];
        return sum;
      });
  for (const SurfaceMotion* s : context_.surfaces) {
    const std::size_t moved = s->still == 0 ? s->velocity.size() : 0;
    energy += context_.workers->ordered_sum(moved, chunk, 0.0, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t i = begin; i < end; ++i)
        if (s->inverse_mass[i] > 0) sum += 0.5 * s->velocity[i].squaredNorm() / s->inverse_mass[i];
      return sum;
    });
  }
  return energy;
}

// Work of the impulses at the mean of the velocities before and after.
double ContactPass::body_energy_change() const {
  double energy = 0;
  for (std::size_t k = 0; k < bodies_before_.size(); ++k) {
    if (!bodies_before_[k]) continue;
    const BodyMotion &before = *bodies_before_[k], &now = *context_.surfaces[k]->body;
    const Vec3 impulse = now.impulse - before.impulse, moment = now.angular_impulse - before.angular_impulse;
    energy += 0.5 * impulse.dot(before.velocity + now.velocity) +
              0.5 * moment.dot(before.angular_velocity + now.angular_velocity);
  }
  return energy;
}

void ContactPass::record_impulses() {
  ContactReport& report = *context_.report;
  for (std::uint32_t k = 0; k < context_.surfaces.size(); ++k) {
    SurfaceMotion& s = *context_.surfaces[k];
    OILSKIN_ASSERT(s.impulse.size() == s.inverse_mass.size());
    sort_touched(s);
    for (std::uint32_t i : s.touched)
      if (s.body)
        record_on_body(report, *s.body, s.impulse[i]);
      else
        (s.inverse_mass[i] > 0 ? report.impulse_on_free_nodes : report.impulse_on_prescribed) += s.impulse[i];
  }
  OILSKIN_ASSERT(report.impulse_on_free_nodes.allFinite() && report.impulse_on_prescribed.allFinite());
  report.min_distance = std::min(report.min_distance, candidates_.min_end_distance(context_));
}

}  // namespace oilskin::contact
