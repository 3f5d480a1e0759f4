#include "contact/zones.h"

#include <algorithm>
#include <map>
#include <optional>

#include "contact/contacts.h"
#include "contact/impacts.h"
#include "contact/zone_body.h"
#include "contact/zone_velocity.h"
#include "core/assert.h"
#include "core/body_motion.h"
#include "core/body_path.h"
#include "core/disjoint_sets.h"

namespace oilskin::contact {

namespace {

enum class Level : std::uint8_t { translate, hold };

constexpr int hold_violating_zones_after = 16;
constexpr int hold_everything_after = 20;
constexpr int resolve_infeasible_after = 24;
constexpr std::uint8_t max_separations = 3;

// Round resolve_infeasible_after + 1 carries along, the next one removes.
static_assert(max_zone_rounds == resolve_infeasible_after + 3);

// Points are particles and nodes under one numbering: particles first, then the nodes of each surface.
class Zones {
 public:
  Zones(Context& context, CandidateSet& candidates);
  void run(std::vector<Violation> violations);

 private:
  std::uint32_t node_point(std::uint32_t surface, std::uint32_t node) const {
    OILSKIN_ASSERT(surface < offset_.size() && offset_[surface] + node < total_);
    return offset_[surface] + node;
  }
  bool is_particle(std::uint32_t point) const { return point < offset_.front(); }
  std::uint32_t surface_of(std::uint32_t point) const {
    OILSKIN_ASSERT(!is_particle(point) && point < total_);
    return static_cast<std::uint32_t>(std::upper_bound(offset_.begin(), offset_.end(), point) -
                                      offset_.begin() - 1);
  }
  void unite(std::uint32_t a, std::uint32_t b);
  void unite_body(std::uint32_t surface);
  bool belongs_to_body(std::uint32_t point) const {
    return !is_particle(point) && context_.surfaces[surface_of(point)]->body.has_value();
  }

  double inverse_mass(std::uint32_t point) const;
  const Vec3& start(std::uint32_t point) const;
  const Vec3& velocity(std::uint32_t point) const;
  void set_end(std::uint32_t point, const Vec3& x);
  void set_velocity(std::uint32_t point, const Vec3& v);
  bool is_holdable(std::uint32_t point) const;

  /// A violation, the zones of its points and the level of the particle's zone when the round began.
  struct ZoneViolation {
    Violation violation;
    std::array<std::uint32_t, 4> roots;
    Level level;
  };
  ZoneViolation zones_of(const Violation& violation);
  void escalate(const ZoneViolation& violation);
  void separate(const Violation& violation);
  void resolve_infeasible(const Violation& violation);
  void apply_zones(const std::vector<Violation>& violations);
  void apply_zone(const std::vector<std::uint32_t>& members, Level level,
                  const std::vector<Violation>& violations, std::vector<std::uint8_t>& is_infeasible);
  void translate_free(const std::vector<std::uint32_t>& members);
  std::optional<BodyPath> rigid_motion(const std::vector<std::uint32_t>& members);
  void move_with_prescribed(const std::vector<std::uint32_t>& members, const BodyPath& path);
  void move_with_body(const std::vector<std::uint32_t>& members, std::uint32_t surface,
                      const std::vector<std::uint32_t>& bodies);
  void carry_body(SurfaceMotion& carrier, std::uint32_t surface, const BodyPath& path,
                  const RidingVelocity& common);
  void hold(const std::vector<std::uint32_t>& members, bool hold_prescribed);
  std::optional<std::uint32_t> carrier(const std::vector<std::uint32_t>& members,
                                       const std::vector<std::uint32_t>& bodies, bool may_hold) const;
  std::vector<std::uint32_t> bodies_of(const std::vector<std::uint32_t>& members) const;
  void count_members();

  Context& context_;
  CandidateSet& candidates_;
  std::vector<std::uint32_t> offset_;  // first point of each surface; offset_[0] = number of particles
  std::uint32_t total_ = 0;            // number of points
  DisjointSets zones_;
  int round_ = 0;
  // Per root
  std::vector<Level> level_;
  // Per point
  std::vector<Vec3> initial_displacement_;  // when the zones began [m]
  std::vector<std::uint8_t> was_held_;
  std::vector<std::uint8_t> body_united_;  // per surface: its nodes are in one zone, as they move together
  std::map<std::uint32_t, std::optional<BodyPath>> rigid_motions_;  // of surfaces that have been asked for
  // Per particle
  std::vector<Vec3> separation_;  // sum of (C.24) [m]
  std::vector<std::uint8_t> separation_count_;
  std::vector<int> carried_in_round_;  // round in which it was carried along, −1 = none
};

std::size_t count_points(const Context& context) {
  std::size_t count = context.particle_count();
  for (const SurfaceMotion* s : context.surfaces) count += s->x_t0.size();
  return count;
}

Zones::Zones(Context& context, CandidateSet& candidates)
    : context_(context), candidates_(candidates), zones_(count_points(context)) {
  const std::size_t n = context.particle_count();
  total_ = static_cast<std::uint32_t>(n);
  for (const SurfaceMotion* s : context.surfaces) {
    offset_.push_back(total_);
    total_ += static_cast<std::uint32_t>(s->x_t0.size());
  }
  level_.assign(total_, Level::translate);
  was_held_.assign(total_, 0);
  body_united_.assign(context.surfaces.size(), 0);
  separation_.assign(n, Vec3::Zero());
  separation_count_.assign(n, 0);
  carried_in_round_.assign(n, -1);
  initial_displacement_.reserve(total_);
  for (std::size_t p = 0; p < n; ++p)
    initial_displacement_.push_back(context.particles->x_t1[p] - context.particles->x_t0[p]);
  for (const SurfaceMotion* s : context.surfaces)
    for (std::size_t i = 0; i < s->x_t0.size(); ++i) initial_displacement_.push_back(s->x_t1[i] - s->x_t0[i]);
  OILSKIN_ASSERT(initial_displacement_.size() == total_);
}

void Zones::unite(std::uint32_t a, std::uint32_t b) {
  const Level level = std::max(level_[zones_.find(a)], level_[zones_.find(b)]);
  level_[zones_.unite(a, b)] = level;
}

void Zones::unite_body(std::uint32_t surface) {
  const SurfaceMotion& s = *context_.surfaces[surface];
  if (!s.body || body_united_[surface]) return;
  body_united_[surface] = 1;
  for (std::uint32_t i = 1; i < s.x_t0.size(); ++i) unite(offset_[surface], offset_[surface] + i);
}

double Zones::inverse_mass(std::uint32_t point) const {
  if (is_particle(point)) return context_.particles->inverse_mass[point];
  const std::uint32_t s = surface_of(point);
  return context_.surfaces[s]->inverse_mass[point - offset_[s]];
}

const Vec3& Zones::start(std::uint32_t point) const {
  if (is_particle(point)) return context_.particles->x_t0[point];
  const std::uint32_t s = surface_of(point);
  return context_.surfaces[s]->x_t0[point - offset_[s]];
}

const Vec3& Zones::velocity(std::uint32_t point) const {
  if (is_particle(point)) return context_.particles->velocity[point];
  const std::uint32_t s = surface_of(point);
  return context_.surfaces[s]->velocity[point - offset_[s]];
}

void Zones::set_end(std::uint32_t point, const Vec3& x) {
  if (is_particle(point)) {
    if (x != context_.particles->x_t1[point]) context_.set_particle_end(point, x);
    return;
  }
  const std::uint32_t s = surface_of(point);
  context_.set_node_end(s, point - offset_[s], x);
}

void Zones::set_velocity(std::uint32_t point, const Vec3& v) {
  if (is_particle(point)) {
    context_.particles->velocity[point] = v;
    return;
  }
  const std::uint32_t s = surface_of(point);
  SurfaceMotion& motion = *context_.surfaces[s];
  const std::uint32_t node = point - offset_[s];
  OILSKIN_ASSERT(motion.inverse_mass[node] > 0);  // prescribed nodes keep their velocity
  motion.add_impulse(node, (v - motion.velocity[node]) / motion.inverse_mass[node]);
  motion.velocity[node] = v;
}

bool Zones::is_holdable(std::uint32_t point) const {
  if (is_particle(point)) return false;
  const std::uint32_t s = surface_of(point);
  const SurfaceMotion& motion = *context_.surfaces[s];
  return !motion.holdable.empty() && motion.holdable[point - offset_[s]] != 0;
}

Zones::ZoneViolation Zones::zones_of(const Violation& violation) {
  const Triangle& t = context_.surfaces[violation.surface]->triangles[violation.triangle];
  ZoneViolation result{violation, {zones_.find(violation.particle)}, Level::translate};
  for (int k = 0; k < 3; ++k) result.roots[k + 1] = zones_.find(node_point(violation.surface, t[k]));
  result.level = level_[result.roots[0]];
  return result;
}

// Uses zones and levels of the start of the round: changes that other violations make in this round have not
// been tested yet.
void Zones::escalate(const ZoneViolation& v) {
  const std::uint32_t p = v.violation.particle;
  if (carried_in_round_[p] >= 0) {
    resolve_infeasible(v.violation);
    return;
  }
  const bool one_zone = v.roots[1] == v.roots[0] && v.roots[2] == v.roots[0] && v.roots[3] == v.roots[0];
  if (!one_zone) {
    unite_body(v.violation.surface);
    for (int k = 1; k < 4; ++k) unite(v.roots[0], v.roots[k]);
  } else if (v.level == Level::hold) {
    resolve_infeasible(v.violation);  // only prescribed nodes that were not held can cause this
  } else if (!v.violation.paths_intersect && separation_count_[p] < max_separations) {
    separate(v.violation);
  } else {
    level_[zones_.find(v.roots[0])] = Level::hold;
  }
}

// (C.24).
void Zones::separate(const Violation& v) {
  const SurfaceMotion& s = *context_.surfaces[v.surface];
  const PointTriangle x1 = context_.end(v.particle, v.surface, v.triangle);
  const ImpactGeometry g = impact_geometry(context_.start(v.particle, v.surface, v.triangle), x1, 1, s.delta);
  const double d = end_distance(x1, s.delta).distance;
  separation_[v.particle] += std::max(2 * s.delta - d, 0.5 * s.delta) * g.normal;
  ++separation_count_[v.particle];
  OILSKIN_ASSERT(separation_count_[v.particle] <= max_separations && separation_[v.particle].allFinite());
  ++context_.report->separated;
}

// First tries moving the particle with the triangle (C.27), certified like any end. If that violates, too,
// applies settings.infeasible.
void Zones::resolve_infeasible(const Violation& v) {
  const std::uint32_t p = v.particle;
  OILSKIN_ASSERT(p < carried_in_round_.size() && (v.paths_intersect || v.too_close));
  if (context_.out_of_play[p] || carried_in_round_[p] == round_) return;
  if (carried_in_round_[p] < 0 && inverse_mass(p) > 0) {  // infinite mass: prescribed motion
    carried_in_round_[p] = round_;
    const SurfaceMotion& s = *context_.surfaces[v.surface];
    const PointTriangle x0 = context_.start(p, v.surface, v.triangle);
    const ImpactGeometry g = impact_geometry(x0, context_.end(p, v.surface, v.triangle), v.time, s.delta);
    Vec3 end = context_.particles->x_t0[p] + 2 * s.delta * g.normal;
    const Triangle& t = s.triangles[v.triangle];
    for (int k = 0; k < 3; ++k) end += g.weights[k] * (s.x_t1[t[k]] - s.x_t0[t[k]]);
    context_.set_particle_end(p, end);
    return;
  }
  context_.out_of_play[p] = 1;
  if (context_.settings->infeasible == Infeasible::allow) {
    ++context_.report->allowed;
  } else {
    ++context_.report->removed;
    context_.particles->removed[p] = 1;
    const double u = context_.particles->inverse_mass[p];
    if (u > 0) context_.report->momentum_removed += context_.particles->velocity[p] / u;
  }
}

void Zones::translate_free(const std::vector<std::uint32_t>& members) {
  double mass = 0;
  Vec3 moment = Vec3::Zero(), momentum = Vec3::Zero();
  for (std::uint32_t m : members) {
    const double w = 1 / inverse_mass(m);
    mass += w;
    moment += w * initial_displacement_[m];
    momentum += w * velocity(m);
  }
  OILSKIN_ASSERT(members.size() > 1 && mass > 0);
  const Vec3 displacement = moment / mass, v = momentum / mass;
  for (std::uint32_t m : members) {
    set_end(m, start(m) + displacement + (is_particle(m) ? separation_[m] : Vec3::Zero()));
    set_velocity(m, v);
  }
}

/// The surface whose prescribed nodes are all that is prescribed in the zone, if they all have one rigid
/// motion: (C.45). Stored numbers of a motion without rotation differ by rounding, too.
std::optional<BodyPath> Zones::rigid_motion(const std::vector<std::uint32_t>& members) {
  std::uint32_t surface = UINT32_MAX;
  for (const std::uint32_t m : members) {
    if (inverse_mass(m) > 0) continue;
    if (is_particle(m)) return {};
    const std::uint32_t s = surface_of(m);
    if (surface != UINT32_MAX && s != surface) return {};
    surface = s;
  }
  if (surface == UINT32_MAX) return {};
  const auto [known, is_new] = rigid_motions_.emplace(surface, std::nullopt);
  if (is_new && all_prescribed(*context_.surfaces[surface])) {
    const SurfaceMotion& s = *context_.surfaces[surface];
    std::vector<Vec3> proposed;
    for (std::size_t i = 0; i < s.x_t0.size(); ++i)
      proposed.push_back(s.x_t0[i] + initial_displacement_[offset_[surface] + i]);
    known->second = rigid_motion_between(s.x_t0, proposed, rounding_of(s));
  }
  return known->second;
}

// (C.26), (C.45).
void Zones::move_with_prescribed(const std::vector<std::uint32_t>& members, const BodyPath& path) {
  OILSKIN_ASSERT(path.rotation.allFinite() && context_.dt > 0);
  Vec3 reaction = Vec3::Zero();
  std::vector<std::uint32_t> supports;
  for (std::uint32_t m : members) {
    if (inverse_mass(m) == 0) {
      if (!is_particle(m)) supports.push_back(m);
      continue;
    }
    const Vec3 end = path.end_of(start(m)), v = (end - start(m)) / context_.dt;
    set_end(m, end + (is_particle(m) ? separation_[m] : Vec3::Zero()));
    reaction -= (v - velocity(m)) / inverse_mass(m);
    set_velocity(m, v);
  }
  // Without supports the prescribed points are particles of infinite mass.
  if (supports.empty()) context_.report->impulse_on_prescribed += reaction;
  for (std::uint32_t m : supports) {
    const std::uint32_t s = surface_of(m);
    push_node(*context_.surfaces[s], m - offset_[s], reaction / static_cast<double>(supports.size()));
  }
}

/// The surfaces with a body whose nodes are members, which are ascending.
std::vector<std::uint32_t> Zones::bodies_of(const std::vector<std::uint32_t>& members) const {
  std::vector<std::uint32_t> bodies;
  for (std::uint32_t m : members) {
    if (is_particle(m)) continue;
    const std::uint32_t s = surface_of(m);
    if (context_.surfaces[s]->body && (bodies.empty() || bodies.back() != s)) bodies.push_back(s);
  }
  return bodies;
}

/// Of `bodies`, the one with which the zone moves: the heaviest, or the one with a locked axis. None where
/// something else is prescribed, where the others may not be moved, or where several have locked axes.
std::optional<std::uint32_t> Zones::carrier(const std::vector<std::uint32_t>& members,
                                            const std::vector<std::uint32_t>& bodies, bool may_hold) const {
  if (bodies.empty() || (bodies.size() > 1 && !may_hold)) return std::nullopt;
  for (std::uint32_t m : members)
    if (inverse_mass(m) == 0 && !belongs_to_body(m)) return std::nullopt;
  std::uint32_t best = bodies.front();
  int locked = 0;
  for (std::uint32_t s : bodies) {
    const BodyMotion &body = *context_.surfaces[s]->body, &heaviest = *context_.surfaces[best]->body;
    if (!is_free(body)) {
      best = s;
      ++locked;
    } else if (locked == 0 && body.inverse_mass.maxCoeff() < heaviest.inverse_mass.maxCoeff()) {
      best = s;
    }
  }
  return locked > 1 ? std::nullopt : std::make_optional(best);
}

// (C.41).
void Zones::move_with_body(const std::vector<std::uint32_t>& members, std::uint32_t surface,
                           const std::vector<std::uint32_t>& bodies) {
  SurfaceMotion& s = *context_.surfaces[surface];
  const BodyPath path = path_of_body(s, &initial_displacement_[offset_[surface]]);
  RidingVelocity common(*s.body);
  for (std::uint32_t m : members)
    if (inverse_mass(m) > 0) common.add(inverse_mass(m), start(m), velocity(m));
  for (std::uint32_t other : bodies)
    if (other != surface) common.add(*context_.surfaces[other]->body);
  common.solve();
  for (std::uint32_t m : members) {
    if (inverse_mass(m) == 0) continue;
    set_end(m, path.end_of(start(m)) + (is_particle(m) ? separation_[m] : Vec3::Zero()));
    const Vec3 v = common.at(start(m)), impulse = (v - velocity(m)) / inverse_mass(m);
    set_velocity(m, v);
    push_body(*s.body, start(m) - path.center_t0, -impulse);
    record_on_body(*context_.report, *s.body, -impulse);
  }
  for (std::uint32_t other : bodies)
    if (other != surface) carry_body(s, other, path, common);
}

void Zones::carry_body(SurfaceMotion& carrier, std::uint32_t surface, const BodyPath& path,
                       const RidingVelocity& common) {
  SurfaceMotion& s = *context_.surfaces[surface];
  BodyMotion& body = *s.body;
  const Vec3 impulse = (common.at(body.center_t0) - body.velocity).cwiseQuotient(body.inverse_mass);
  const Vec3 moment = inertia_of(body) * (common.angular_velocity() - body.angular_velocity);
  push_and_turn(body, impulse, moment);
  push_and_turn(*carrier.body, -impulse, -moment - (body.center_t0 - path.center_t0).cross(impulse));
  record_on_body(*context_.report, body, impulse);
  record_on_body(*context_.report, *carrier.body, -impulse);
  for (std::uint32_t i = 0; i < s.x_t0.size(); ++i) context_.set_node_end(surface, i, path.end_of(s.x_t0[i]));
  body.center_t1 = path.end_of(body.center_t0);
}

/// A held body takes part in the common velocity, but keeps its rotation.
void Zones::hold(const std::vector<std::uint32_t>& members, bool hold_prescribed) {
  ZoneVelocity common;
  for (std::uint32_t m : members)
    if (inverse_mass(m) > 0) common.add(inverse_mass(m), velocity(m));
  const std::vector<std::uint32_t> bodies =
      hold_prescribed ? bodies_of(members) : std::vector<std::uint32_t>();
  for (std::uint32_t s : bodies) common.add(*context_.surfaces[s]->body);
  for (std::uint32_t s : bodies) {
    BodyMotion& body = *context_.surfaces[s]->body;
    common.give(body, *context_.report);
    body.center_t1 = body.center_t0;
  }
  for (std::uint32_t m : members) {
    if (inverse_mass(m) > 0) {
      set_end(m, start(m));
      set_velocity(m, common.value());
      was_held_[m] = 1;
    } else if (hold_prescribed && is_holdable(m)) {
      set_end(m, start(m));
      was_held_[m] = 1;
    }
  }
}

void Zones::apply_zone(const std::vector<std::uint32_t>& members, Level level,
                       const std::vector<Violation>& violations, std::vector<std::uint8_t>& is_infeasible) {
  OILSKIN_ASSERT(!members.empty() && is_infeasible.size() == violations.size());
  bool any_prescribed = false, equal = true, all_holdable = true;
  Vec3 displacement = Vec3::Zero();
  for (std::uint32_t m : members) {
    if (inverse_mass(m) > 0) continue;
    const Vec3& d = initial_displacement_[m];  // of a prescribed node: as the host proposed
    if (any_prescribed) equal &= d == displacement;
    displacement = d;
    any_prescribed = true;
    all_holdable &= is_holdable(m) || d.isZero(0);  // a point that stands still needs no hold
  }
  if (level == Level::translate && !any_prescribed) {
    translate_free(members);
    return;
  }
  const bool may_hold = all_holdable && context_.settings->infeasible == Infeasible::stall;
  const std::vector<std::uint32_t> bodies = bodies_of(members);
  const std::optional<std::uint32_t> body = carrier(members, bodies, may_hold);
  if (level == Level::translate && body) {
    move_with_body(members, *body, bodies);
    return;
  }
  if (level == Level::translate && equal) {
    move_with_prescribed(members, {Vec3::Zero(), displacement, Eigen::Matrix3d::Identity()});
    return;
  }
  if (level == Level::translate) {
    if (const std::optional<BodyPath> path = rigid_motion(members)) {
      move_with_prescribed(members, *path);
      return;
    }
  }
  hold(members, may_hold);
  if (!any_prescribed || may_hold) return;
  const std::uint32_t root = zones_.find(members.front());
  for (std::size_t k = 0; k < violations.size(); ++k)
    if (zones_.find(violations[k].particle) == root) is_infeasible[k] = 1;
}

void Zones::apply_zones(const std::vector<Violation>& violations) {
  if (round_ > hold_violating_zones_after)
    for (const Violation& v : violations) level_[zones_.find(v.particle)] = Level::hold;
  const bool hold_all = round_ > hold_everything_after;

  // Zones in order of their roots, members ascending: independent of the order of unions.
  std::vector<std::uint32_t> size(total_, 0);
  for (std::uint32_t i = 0; i < total_; ++i) ++size[zones_.find(i)];
  std::vector<std::pair<std::uint32_t, std::uint32_t>> by_root;
  for (std::uint32_t i = 0; i < total_; ++i) {
    const std::uint32_t root = zones_.find(i);
    if (is_particle(i) && (context_.out_of_play[i] || carried_in_round_[i] >= 0)) continue;
    if (size[root] > 1 || level_[root] == Level::hold || hold_all) by_root.emplace_back(root, i);
  }
  std::sort(by_root.begin(), by_root.end());
  std::vector<std::uint8_t> is_infeasible(violations.size(), 0);
  std::vector<std::uint32_t> members;
  for (std::size_t k = 0; k < by_root.size();) {
    const std::uint32_t root = by_root[k].first;
    members.clear();
    for (; k < by_root.size() && by_root[k].first == root; ++k) members.push_back(by_root[k].second);
    apply_zone(members, hold_all ? Level::hold : level_[root], violations, is_infeasible);
  }
  for (std::size_t k = 0; k < violations.size(); ++k)
    if (is_infeasible[k]) resolve_infeasible(violations[k]);
}

void Zones::count_members() {
  OILSKIN_ASSERT(context_.report->zone_rounds > 0);
  ContactReport& report = *context_.report;
  std::vector<std::uint32_t> size(total_, 0);
  for (std::uint32_t i = 0; i < total_; ++i) ++size[zones_.find(i)];
  for (std::uint32_t i = 0; i < total_; ++i) {
    if (size[zones_.find(i)] > 1) ++report.zone_points;
    if (!was_held_[i] || belongs_to_body(i)) continue;
    ++report.held;
    if (inverse_mass(i) == 0) ++report.stalled;
  }
  for (std::size_t s = 0; s < context_.surfaces.size(); ++s)
    if (context_.surfaces[s]->body && was_held_[offset_[s]]) ++report.held;
  for (std::size_t p = 0; p < carried_in_round_.size(); ++p)
    if (carried_in_round_[p] >= 0 && !context_.out_of_play[p]) ++report.carried_along;
}

void Zones::run(std::vector<Violation> violations) {
  for (round_ = 0; !violations.empty(); ++round_) {
    {
      StageTimer timer(context_.seconds->zones);
      // From round 25 on, each round resolves a particle as infeasible, each at most twice.
      OILSKIN_ASSERT(round_ <= max_zone_rounds + 1 + 2 * static_cast<int>(context_.particle_count()));
      ++context_.report->zone_rounds;
      std::vector<ZoneViolation> zone_violations;
      zone_violations.reserve(violations.size());
      for (const Violation& v : violations) zone_violations.push_back(zones_of(v));
      for (const ZoneViolation& v : zone_violations) {
        if (round_ > resolve_infeasible_after)
          resolve_infeasible(v.violation);
        else
          escalate(v);
      }
      apply_zones(violations);
    }
    StageTimer timer(context_.seconds->ccd);
    violations = find_violations(context_, candidates_);
  }
  count_members();
  for (SurfaceMotion* s : context_.surfaces) set_node_velocities(*s);
}

}  // namespace

void run_zones(Context& context, CandidateSet& candidates) {
  std::vector<Violation> violations;
  {
    StageTimer timer(context.seconds->ccd);
    violations = find_violations(context, candidates);
  }
  if (!violations.empty()) Zones(context, candidates).run(std::move(violations));
}

}  // namespace oilskin::contact
