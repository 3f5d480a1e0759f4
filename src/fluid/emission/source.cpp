#include "fluid/emission/source.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/assert.h"
#include "core/refuse.h"
#include "core/unit_vector.h"
#include "fluid/random.h"

namespace oilskin::fluid {

namespace {

/// Each coordinate uniform between ± `amplitude` (F.71).
Vec3 random_vector(std::uint64_t seed, std::uint64_t counter, double amplitude) {
  const auto coordinate = [&](std::uint64_t k) {
    return amplitude * (2 * random_unit(seed, 3 * counter + k) - 1);
  };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

/// Where a particle at x is carried by the field in a unit of time: eight steps of Runge and Kutta (F.71).
/// The flow of a field without divergence keeps volumes, which x + u(x) does not.
Vec3 carried(const VectorField& u, Vec3 x) {
  constexpr int steps = 8;
  constexpr double h = 1.0 / steps;
  for (int k = 0; k < steps; ++k) {
    const Vec3 a = u(x), b = u(x + 0.5 * h * a), c = u(x + 0.5 * h * b), d = u(x + h * c);
    x += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return x;
}

void visit(Archive& archive, EmitterPose& pose) {
  auto& [position, rotation] = pose;
  archive.values(position, rotation.x(), rotation.y(), rotation.z(), rotation.w());
}

bool is_in_range(const EmitterPose& pose) {
  return pose.position.allFinite() && std::abs(pose.rotation.norm() - 1) < 1e-9;
}

void visit(Archive& archive, Schedule& schedule) {
  auto& [start, stop, period, runs, origin, phase] = schedule;
  archive.values(start, stop, period, runs, origin, phase);
}

void visit(Archive& archive, RainEmitter& emitter) {
  auto& [corner, edge_u, edge_v, drops_per_second, drop_radius, velocity, start, stop, seed] = emitter;
  archive.values(corner, edge_u, edge_v, drops_per_second, drop_radius, velocity, start, stop, seed);
}

bool all_finite(const std::vector<Vec3>& values) {
  return std::all_of(values.begin(), values.end(), [](const Vec3& x) { return x.allFinite(); });
}

}  // namespace

void Schedule::begin_at(double from, double to) {
  start = origin = from;
  stop = to;
}

double Schedule::phase_at(double time) const {
  const double passed = std::min(time, stop) - origin;
  return runs && passed > 0 && period > 0 ? phase + passed / period : phase;
}

void Schedule::rebase(double time) {
  phase = phase_at(time);
  origin = std::max(origin, time);
}

double Schedule::time_of(double x) const {
  return runs ? origin + (x - phase) * period : std::numeric_limits<double>::infinity();
}

void Source::begin(double time) {
  begun = true;
  next = static_cast<std::uint64_t>(schedule.phase_at(time));
  while (schedule.runs ? time_of(next) < time : phase_of(next) < schedule.phase) ++next;
}

double Source::phase_of(std::uint64_t k) const {
  // A drop starts at a random time within its period, so that several emitters are not synchronous.
  return static_cast<double>(k) + (kind == Kind::rain ? random_unit(rain.seed, 3 * k + 2) : 0);
}

double Source::time_of(std::uint64_t k) const {
  return schedule.time_of(phase_of(k));
}

Vec3 Source::place_of(std::size_t site) const {
  OILSKIN_ASSERT(site < sites.size());
  if (kind == Kind::rain) {
    const Vec3 middle = rain.corner + random_unit(rain.seed, 3 * next) * rain.edge_u +
                        random_unit(rain.seed, 3 * next + 1) * rain.edge_v;
    return middle + sites[site];
  }
  if (shake == 0) return sites[site];
  return sites[site] + random_vector(seed, next * sites.size() + site, shake);
}

void Source::set_velocity(const Vec3& v) {
  velocity = v;
  fastest = v.norm();
  direction = unit_or_zero(v);
}

void Source::set_speed(double speed, double time) {
  schedule.rebase(time);
  const Vec3 old = velocity;
  velocity = speed * direction;
  fastest = speed;
  for (Vec3& v : velocities) {
    v += velocity - old;
    fastest = std::max(fastest, v.norm());
  }
  if (kind == Kind::nozzle && speed > 0) schedule.period = layer / speed;
  update_running();
}

void Source::update_running() {
  schedule.runs = enabled && (kind != Kind::nozzle || !velocity.isZero(0));
}

bool Source::is_over(double time) const {
  if (kind == Kind::volume) return begun;
  return time >= schedule.stop && std::find(waiting.begin(), waiting.end(), 1) == waiting.end();
}

EmitterPose pose_of(const Source& source, double part) {
  const EmitterPose &a = source.from, &b = source.to;
  return {(1 - part) * a.position + part * b.position, a.rotation.slerp(part, b.rotation).normalized()};
}

PlacedSource::PlacedSource(const Source& source, double part, double length)
    : source_(source), added_velocity_(source.inherited_velocity) {
  if (!source.placed) return;
  const EmitterPose pose = pose_of(source, part);
  position_ = pose.position;
  turn_ = pose.rotation.toRotationMatrix();
  if (source.kind != Source::Kind::nozzle || part >= 1) return;
  // The layers of a nozzle that moves forward faster than its water would lie on top of each other (F.75).
  const Vec3 axis = turn_ * source.direction;
  const Vec3 motion = (source.to.position - source.from.position) / length - source.inherited_velocity;
  added_velocity_ += std::max(0.0, motion.dot(axis)) * axis;
}

Vec3 PlacedSource::place_of(std::size_t site) const {
  const Vec3 x = source_.place_of(site);
  return source_.placed ? Vec3(position_ + turn_ * (x - source_.center)) : x;
}

Vec3 PlacedSource::velocity_of(std::size_t site) const {
  Vec3 v = source_.velocity_of(site);
  if (!source_.placed && added_velocity_.isZero(0)) return v;
  return (source_.placed ? Vec3(turn_ * v) : v) + added_velocity_;
}

double speed_by_motion(const Source& source, double dt) {
  const double inherited = source.inherited_velocity.norm();
  if (!source.placed || source.kind != Source::Kind::nozzle) return inherited;
  const double length = source.move_length > 0 ? source.move_length : dt;
  return 2 * inherited + (source.to.position - source.from.position).norm() / length;
}

Status check_shake(const char* field, double shake) {
  return shake >= 0 && shake <= 0.25 ? Status{}
                                     : refuse_value(field, shake, "0 … 0.25 spacings of the fluid");
}

Status place(const char* emitter, const Vec3& velocity, const InitialState& initial, double spacing,
             Source& source) {
  Status status = check_shake((std::string(emitter) + ": initial.shake").c_str(), initial.shake);
  if (!status.ok()) return status;
  source.set_velocity(velocity);
  for (std::size_t k = 0; k < source.sites.size(); ++k) {
    Vec3& x = source.sites[k];
    if (initial.displacement) x = carried(initial.displacement, x);
    if (initial.shake > 0) x += random_vector(initial.seed, k, initial.shake * spacing);
    if (initial.velocity) source.velocities.push_back(velocity + initial.velocity(x));
    if (!x.allFinite() || (initial.velocity && !source.velocities.back().allFinite())) {
      return refuse(emitter, ": initial: particle ", k, " starts at ", x.transpose(),
                    " m; place and velocity must be "
                    "finite");
    }
    if (initial.velocity) source.fastest = std::max(source.fastest, source.velocities.back().norm());
  }
  return {};
}

void visit(Archive& archive, Source& source) {
  auto& [kind, sites, velocities, velocity, fastest, direction, layer, shake, seed, rain, schedule, enabled,
         begun, next, waiting, placed, center, from, to, move_begin, move_length, inherited_velocity, max_age,
         id, is_held, emitted] = source;
  archive.values(kind, sites, velocities, velocity, fastest, direction, layer, shake, seed);
  visit(archive, rain);
  visit(archive, schedule);
  archive.values(enabled, begun, next, waiting, placed, center);
  visit(archive, from);
  visit(archive, to);
  archive.values(move_begin, move_length, inherited_velocity, max_age, id, is_held, emitted);
}

namespace {

bool is_in_range(const Schedule& s) {
  if (!std::isfinite(s.start) || std::isnan(s.stop) || !std::isfinite(s.origin)) return false;
  return s.origin >= s.start && s.phase >= 0 && s.phase < 0x1p53;
}

/// Nozzles and rain.
bool is_series_in_range(const Source& s, double time) {
  const Schedule& schedule = s.schedule;
  if (s.kind != Source::Kind::nozzle && s.kind != Source::Kind::rain) return false;
  if (s.waiting.size() != (s.kind == Source::Kind::nozzle ? s.sites.size() : 0)) return false;
  if (s.kind == Source::Kind::nozzle && !(s.layer > 0 && std::isfinite(s.layer))) return false;
  if (!s.rain.corner.allFinite() || !s.rain.edge_u.allFinite() || !s.rain.edge_v.allFinite()) return false;
  if (!(schedule.start >= 0 && schedule.stop > schedule.start)) return false;
  if (!(schedule.period >= min_period && std::isfinite(schedule.period))) return false;
  const double due = schedule.phase_at(time);
  return due < 0x1p53 && (!s.begun || static_cast<double>(s.next) >= due - 2);
}

}  // namespace

bool is_in_range(const Source& s, double time) {
  if (!s.velocity.allFinite() || !s.direction.allFinite() || !s.center.allFinite()) return false;
  if (!(s.max_age > 0)) return false;
  if (!(s.fastest >= 0) || !std::isfinite(s.shake) || !s.inherited_velocity.allFinite()) return false;
  if (!all_finite(s.sites) || !all_finite(s.velocities)) return false;
  if (!s.velocities.empty() && s.velocities.size() != s.sites.size()) return false;
  if (!is_in_range(s.schedule) || !is_in_range(s.from) || !is_in_range(s.to)) return false;
  if (!std::isfinite(s.move_begin) || !within(s.move_length, 0, max_move)) return false;
  return s.kind == Source::Kind::volume ? s.waiting.empty() : is_series_in_range(s, time);
}

}  // namespace oilskin::fluid
