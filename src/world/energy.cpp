#include "world/energy.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/body_motion.h"
#include "core/inverse_mass.h"

namespace oilskin::world {

namespace {

/// Shortest stretch of time over which EnergyReport::risen looks back [s].
constexpr double window = 0.1;

/// A particle is too fast beyond this multiple of the energy that explains it: where streams collide, a small
/// part of the water has more than its share.
constexpr double focus = 4;

constexpr std::size_t chunk_size = 4096, node_chunk = 512;

/// The speed of a node over a step or an interval [m/s]; 0 before the first.
Vec3 speed(const SurfaceMotion& m, std::size_t node, double dt) {
  return dt > 0 ? Vec3((m.x_t1[node] - m.x_t0[node]) / dt) : Vec3::Zero();
}

}  // namespace

/// The middle of the interval (F.57), as if particle i had moved for all of it; x is its end.
Vec3 EnergyBalance::middle(const fluid::Particles& particles, std::size_t i, const Vec3& x, double dt) const {
  const double length = particles.id[i] >= state_.first_new_id ? dt : state_.interval;
  return x - 0.5 * length * particles.motion[i];
}

/// A particle that has not moved yet has brought no energy, and takes none away.
void EnergyState::withdraw(const fluid::Particles& particles, std::size_t i, double mass) {
  if (particles.id[i] >= first_new_id) return;
  const Vec3& u = particles.motion[i];
  withdrawn.add(mass, u, particles.position[i] - 0.5 * interval * u);
}

void EnergyBalance::begin(const fluid::Particles& particles, double dt, const Workers& workers) {
  const bool turned = gravity_ != state_.gravity;
  if (turned) state_.max_specific = 0;
  start_ = left_ = state_.withdrawn;
  state_.withdrawn = Energy();
  struct Begin {
    Energy start, entered;
    double max_specific, lowest;
    void operator+=(const Begin& o) {
      start += o.start;
      entered += o.entered;
      max_specific = std::max(max_specific, o.max_specific);
      lowest = std::min(lowest, o.lowest);
    }
  };
  const Begin none = {{}, {}, state_.max_specific, lowest_};
  const Begin all =
      workers.ordered_sum(particles.size(), chunk_size, none, [&](std::size_t first, std::size_t end) {
        Begin sums = none;
        for (std::size_t i = first; i < end; ++i) {
          const Vec3 &x = particles.position[i], &u = particles.motion[i];
          const bool is_new = particles.id[i] >= state_.first_new_id;
          (is_new ? sums.entered : sums.start).add(mass_of(particles, i), u, middle(particles, i, x, dt));
          sums.lowest = std::min(sums.lowest, -gravity_.dot(x));
          if (is_new || turned)
            sums.max_specific = std::max(sums.max_specific, 0.5 * u.squaredNorm() - gravity_.dot(x));
        }
        return sums;
      });
  start_ += all.start;
  entered_ += all.entered;
  state_.max_specific = all.max_specific;
  lowest_ = all.lowest;
}

void EnergyBalance::enter(const Vec3& x, const Vec3& velocity, double dt) {
  entered_.add(mass_, velocity, x - 0.5 * dt * velocity);
  state_.max_specific = std::max(state_.max_specific, 0.5 * velocity.squaredNorm() - gravity_.dot(x));
  lowest_ = std::min(lowest_, -gravity_.dot(x));
}

namespace {

/// Of a body in an interval of dt, but for impulses.
Vec3 velocity_of(const BodyMotion& body, double dt) {
  return dt > 0 ? Vec3((body.center_t1 - body.center_t0) / dt) : body.velocity;
}

/// With which its host turns it in a step, before the impulses of the step [rad/s].
Vec3 spin_of(const BodyMotion& body) {
  return body.angular_velocity - body.inverse_inertia * body.angular_impulse;
}

}  // namespace

/// Of its impulses in the interval that ends. On the chords of its nodes centripetal forces would do work.
double EnergyBalance::transfer_to_body(const BodyMotion& body, double dt, BodyLoad& so_far) const {
  const BodyLoad load = {body.impulse - so_far.impulse, body.angular_impulse - so_far.moment};
  so_far = {body.impulse, body.angular_impulse};
  return load.impulse.dot(velocity_of(body, dt)) + load.moment.dot(spin_of(body));
}

/// (F.59). Nodes that are not prescribed get the impulse after their motion: (F.60).
void EnergyBalance::touch(Span<SurfaceMotion* const> surfaces, double dt,
                          Span<const SurfaceMotion* const> before, double dt_before) {
  OILSKIN_ASSERT(dt > 0 && before.size() == surfaces.size());
  body_loads_.resize(surfaces.size());
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const SurfaceMotion* s = surfaces[k];
    const bool goes_on =
        before[k] != nullptr && before[k]->id == s->id && before[k]->x_t1.size() == s->x_t1.size();
    if (s->body) transfer_ += transfer_to_body(*s->body, dt, body_loads_[k]);
    for (std::uint32_t j : s->touched) {
      if (s->impulse[j].isZero(0)) continue;
      const Vec3 u = speed(*s, j, dt);
      state_.max_node_speed = std::max(state_.max_node_speed, u.norm());
      if (s->body) continue;
      if (s->inverse_mass[j] == 0)
        on_prescribed_ += s->impulse[j].dot(goes_on ? Vec3(0.5 * (speed(*before[k], j, dt_before) + u)) : u);
      else
        transfer_ += s->impulse[j].dot(u);
    }
  }
}

void EnergyBalance::move(fluid::Particles& particles, std::size_t i, const Vec3& start, double time,
                         double dt) {
  OILSKIN_ASSERT(time >= 0 && time <= dt);
  // Shorter times have rounding instead of a displacement.
  if (time > 1e-9 * dt) particles.motion[i] = (particles.position[i] - start) / time;
}

void EnergyBalance::stay(const fluid::Particles& particles, std::size_t i, double dt, Sums& sums) const {
  const Vec3& u = particles.motion[i];
  sums.water.add(mass_of(particles, i), u, particles.position[i] - 0.5 * dt * u);
  sums.max_speed = std::max(sums.max_speed, u.squaredNorm());
}

void EnergyBalance::leave(const fluid::Particles& particles, std::size_t i, double dt, Sums& sums) const {
  sums.left.add(mass_of(particles, i), particles.motion[i],
                particles.position[i] - 0.5 * dt * particles.motion[i]);
}

void EnergyBalance::lose(const fluid::Particles& particles, std::size_t i, const Vec3& start, double dt,
                         Sums& sums) const {
  sums.left.add(mass_of(particles, i), particles.motion[i], middle(particles, i, start, dt));
}

void EnergyBalance::absorb(const fluid::Particles& particles, std::size_t i, double mass_ratio, double dt,
                           Sums& sums) const {
  const Vec3& u = particles.motion[i];
  sums.left.add(mass_ratio * mass_, u, particles.position[i] - 0.5 * dt * u);
}

bool EnergyBalance::is_too_fast(const fluid::Particles& particles, std::size_t i) const {
  const double walls = 0.5 * state_.max_node_speed * state_.max_node_speed;
  const double height = -gravity_.dot(particles.position[i]) - lowest_;  // in J/kg
  const double available = state_.max_specific - lowest_ + walls;
  return 0.5 * particles.motion[i].squaredNorm() + height > focus * std::max(available, 0.0);
}

void EnergyBalance::end_interval(const Sums& sums, std::uint64_t next_id, double dt) {
  left_ += sums.left;
  by_effects_ += sums.by_effects;
  state_.max_specific += sums.most_by_effects;
  state_.water = sums.water;
  state_.report.max_speed = std::sqrt(sums.max_speed);
  state_.interval = dt;
  state_.first_new_id = next_id;
}

/// Of a body, by its motion over a step of dt, or by its velocity where it was attached last: along axes in
/// which it may move, and its rotation.
Energy energy_of_body(const SurfaceMotion& m, double dt) {
  Energy energy;
  if (!m.body) return energy;
  const BodyMotion& body = *m.body;
  const Vec3 u = velocity_of(body, dt);
  const Vec3 middle = body.center_t1 - 0.5 * dt * u;
  for (int k = 0; k < 3; ++k) {
    if (!(body.inverse_mass[k] > 0)) continue;
    energy.kinetic += 0.5 * u[k] * u[k] / body.inverse_mass[k];
    energy.moment[k] = middle[k] / body.inverse_mass[k];
  }
  const Vec3 spin = spin_of(body);
  energy.kinetic += 0.5 * spin.dot(inertia_of(body) * spin);
  return energy;
}

/// Where contact gave a free node an impulse at the end of the step before, its speed changed in between:
/// the work is at the mean (F.60).
void EnergyBalance::end_surface(const SurfaceMotion& now, double dt, const SurfaceMotion& before,
                                double dt_before, const Workers& workers) {
  if (before.still != 0 && now.still != 0) return;  // no node is free
  const bool is_same = before.id == now.id && before.x_t1.size() == now.x_t1.size();
  nodes_before_ += energy_of_body(before, dt_before);
  nodes_ += energy_of_body(now, dt);
  if (is_same && before.body && now.body)
    late_ +=
        0.5 * before.body->impulse.dot(velocity_of(*now.body, dt) - velocity_of(*before.body, dt_before)) +
        0.5 * before.body->angular_impulse.dot(spin_of(*now.body) - spin_of(*before.body));
  struct Before {
    Energy nodes;
    double late = 0;
    void operator+=(const Before& o) {
      nodes += o.nodes;
      late += o.late;
    }
  };
  const auto sums_before = [&](std::size_t begin, std::size_t end) {
    Before sums;
    for (std::size_t j = begin; j < end; ++j) {
      if (before.inverse_mass[j] == 0) continue;  // of bodies, too
      const Vec3 u = speed(before, j, dt_before);
      sums.nodes.add(own_mass(before, j), u, before.x_t1[j] - 0.5 * dt_before * u);
      if (before.impulse.size() != before.x_t1.size()) continue;
      if (is_same) sums.late += 0.5 * before.impulse[j].dot(speed(now, j, dt) - u);
    }
    return sums;
  };
  const Before all = workers.ordered_sum(before.x_t1.size(), node_chunk, Before(), sums_before);
  nodes_before_ += all.nodes;
  late_ += all.late;
  nodes_ +=
      workers.ordered_sum(now.x_t1.size(), node_chunk, Energy(), [&](std::size_t begin, std::size_t end) {
        Energy sum;
        for (std::size_t j = begin; j < end; ++j) {
          if (now.inverse_mass[j] == 0) continue;
          const Vec3 u = speed(now, j, dt);
          sum.add(own_mass(now, j), u, now.x_t1[j] - 0.5 * dt * u);
        }
        return sum;
      });
}

void EnergyBalance::include(EnergyBalance& other) {
  OILSKIN_ASSERT(&other != this);
  others_.push_back(&other);
  other.is_included_ = true;
}

void EnergyBalance::share_limits(EnergyBalance& other) {
  state_.max_specific = other.state_.max_specific = std::max(state_.max_specific, other.state_.max_specific);
  state_.max_node_speed = other.state_.max_node_speed =
      std::max(state_.max_node_speed, other.state_.max_node_speed);
}

const EnergyReport& EnergyBalance::finish_water(double mass) {
  EnergyReport& r = state_.report;
  r.water_kinetic = state_.water.kinetic;
  r.water_potential = state_.water.potential(gravity_);
  r.rms_speed = mass > 0 ? std::sqrt(2 * r.water_kinetic / mass) : 0;
  state_.gravity = gravity_;
  return r;
}

const EnergyReport& EnergyBalance::finish(double relative_mass, double mass_of_others, double dt,
                                          double spacing) {
  EnergyReport& r = state_.report;
  const double mass = relative_mass * mass_ + mass_of_others;
  if (is_included_) return finish_water(mass);
  std::vector<const EnergyBalance*> all = {this};
  all.insert(all.end(), others_.begin(), others_.end());
  r.water_kinetic = r.water_potential = 0;
  double start = 0, entered = 0, left = 0, before = 0, by_effects = 0, raised = 0;
  for (const EnergyBalance* e : all) {  // each has its own gravity
    const Vec3& g = e->gravity_;
    r.water_kinetic += e->state_.water.kinetic;
    r.water_potential += e->state_.water.potential(g);
    r.max_speed = std::max(r.max_speed, e->state_.report.max_speed);
    r.entered_kinetic += e->entered_.kinetic;
    r.entered_potential += e->entered_.potential(g);
    r.left_kinetic += e->left_.kinetic;
    r.left_potential += e->left_.potential(g);
    start += e->start_.total(g);
    entered += e->entered_.total(g);
    left += e->left_.total(g);
    before += e->water_before_.total(e->state_.gravity);
    by_effects += e->by_effects_;
    raised += e->state_.water.potential(g) - e->start_.potential(g) - e->entered_.potential(g) +
              e->left_.potential(g);
  }
  r.node_kinetic = nodes_.kinetic;
  r.node_potential = nodes_.potential(gravity_);
  r.rms_speed = mass > 0 ? std::sqrt(2 * r.water_kinetic / mass) : 0;
  r.entered_potential += nodes_before_.total(gravity_) - state_.nodes.total(gravity_);
  r.work_prescribed -= on_prescribed_;
  r.work_host += nodes_.total(gravity_) - nodes_before_.total(gravity_) - r.transfer - late_;
  r.work_outside += by_effects + start - before - (gravity_ - state_.gravity).dot(state_.nodes.moment);
  r.transfer = transfer_;
  r.made_in_step = r.water_kinetic + r.water_potential - start - entered + left + on_prescribed_ + transfer_ +
                   late_ - by_effects;
  r.made += r.made_in_step;
  state_.gravity_work -= raised + nodes_.potential(gravity_) - nodes_before_.potential(gravity_);
  const double slow = spacing / window;
  update_scale(mass * std::max(gravity_.norm() * spacing, 0.5 * slow * slow));
  update_window(dt);
  state_.gravity = gravity_;
  state_.nodes = nodes_;
  return r;
}

/// (F.62)
void EnergyBalance::update_scale(double least) {
  EnergyReport& r = state_.report;
  r.released_potential = std::max(r.released_potential, state_.gravity_work);
  for (const double work : {r.work_prescribed, r.work_host, r.work_outside})
    state_.max_work = std::max(state_.max_work, work);
  r.scale = std::max({r.scale, r.entered_kinetic, r.released_potential, state_.max_work, least});
}

/// A particle that runs onto a light node stops for the rest of a step, before the node gives way: a dip of
/// one or two steps is none. A particle that does so at the end of a step still has its old displacement, but
/// its impulse is given already: a peak of one step is none, as far as what is given explains it.
void EnergyBalance::update_window(double dt) {
  EnergyReport& r = state_.report;
  const double lately = std::max({r.made, state_.last_made[0], state_.last_made[1]});
  const double lasting = std::max(std::min(r.made, state_.last_made[0]), r.made - std::max(0.0, r.transfer));
  state_.last_made = {r.made, state_.last_made[0]};
  state_.time += dt;
  if (state_.time >= state_.window_end) {
    state_.min_made_before = state_.min_made;
    state_.min_made = lately;
    state_.window_end = state_.time + window;
  }
  state_.min_made = std::min(state_.min_made, lately);
  r.risen = std::max(0.0, lasting - std::min(state_.min_made, state_.min_made_before));
}

namespace {

void visit(Archive& archive, Energy& energy) {
  auto& [kinetic, moment] = energy;
  archive.values(kinetic, moment);
}

void visit(Archive& archive, EnergyReport& r) {
  auto& [water_kinetic, water_potential, node_kinetic, node_potential, transfer, entered_kinetic,
         entered_potential, left_kinetic, left_potential, work_prescribed, work_host, work_outside,
         released_potential, made, made_in_step, risen, scale, rms_speed, max_speed] = r;
  archive.values(water_kinetic, water_potential, node_kinetic, node_potential, transfer, entered_kinetic,
                 entered_potential, left_kinetic, left_potential, work_prescribed, work_host, work_outside,
                 released_potential, made, made_in_step, risen, scale, rms_speed, max_speed);
}

}  // namespace

void EnergyState::visit(Archive& archive) {
  auto& [interval_, first_new_id_, max_specific_, max_node_speed_, gravity_, water_, nodes_, report_,
         gravity_work_, max_work_, time_, window_end_, min_made_, min_made_before_, last_made_, withdrawn_] =
      *this;
  archive.values(interval_, first_new_id_, max_specific_, max_node_speed_, gravity_, gravity_work_, max_work_,
                 time_, window_end_, min_made_, min_made_before_, last_made_[0], last_made_[1]);
  world::visit(archive, water_);
  world::visit(archive, nodes_);
  world::visit(archive, withdrawn_);
  world::visit(archive, report_);
  archive.require(interval_ >= 0 && std::isfinite(interval_), "the length of the last interval");
  archive.require(std::isfinite(withdrawn_.kinetic) && withdrawn_.moment.allFinite(),
                  "the energy of particles that were removed");
}

}  // namespace oilskin::world
