#include "contact/wall_friction.h"

#include <algorithm>
#include <cmath>

#include "contact/contacts.h"
#include "core/assert.h"

namespace oilskin::contact {

using fluid::WallImpulse;

namespace {

/// Walls of one side of a surface whose normals deviate by less than 60° are one wall.
constexpr double same_wall_cosine = 0.5;

/// Normals whose cosines with a load differ by less are one normal.
constexpr double same_normal = 1e-3;

/// The part of an old spare load that an interval with less load leaves (B.35).
constexpr double spare_left = 0.8;

bool is_dry(const Context& context, std::uint32_t surface, bool back) {
  const SlipModel model = context.surfaces[surface]->slip_on(back).model;
  return model == SlipModel::coulomb || model == SlipModel::sticking;
}

/// One wall of a particle: the triangles of one side of a surface, in about one direction.
struct WallGroup {
  std::uint32_t surface = 0;
  bool back = false;
  Vec3 normal = Vec3::Zero();   // sum of the triangles', with their weights
  Vec3 impulse = Vec3::Zero();  // sum of the triangles'
  const WallImpulse* nearest = nullptr;
  double distance = 0;
};

class WallsOfParticle {
 public:
  WallsOfParticle(const Context& context, std::vector<ContactConstraint>& constraints, std::size_t begin)
      : context_(context), constraints_(constraints), begin_(begin), contacts_end_(constraints.size()) {}

  void add(const WallImpulse& wall);
  /// Appends the constraints of the groups and gives the spare load to the wall that it belongs to.
  void finish(const Vec3& spare_load);

 private:
  bool is_on_back(const WallImpulse& wall) const;
  double distance_of(const WallImpulse& wall) const;
  ContactConstraint* find_contact(const WallImpulse& wall, bool back) const;
  WallGroup& group_of(const WallImpulse& wall, bool back);
  void append(const WallGroup& group);
  void give_spare_load(const Vec3& spare_load);

  const Context& context_;
  std::vector<ContactConstraint>& constraints_;
  const std::size_t begin_, contacts_end_;  // contacts of the particle
  std::vector<WallGroup> groups_;
};

bool WallsOfParticle::is_on_back(const WallImpulse& wall) const {
  const SurfaceMotion& s = *context_.surfaces[wall.surface];
  const Triangle& t = s.triangles[wall.triangle];
  return wall.normal.dot((s.x_t0[t[1]] - s.x_t0[t[0]]).cross(s.x_t0[t[2]] - s.x_t0[t[0]])) < 0;
}

double WallsOfParticle::distance_of(const WallImpulse& wall) const {
  const PointTriangle q = context_.start(wall.particle, wall.surface, wall.triangle);
  return (q.p - wall.weights[0] * q.a - wall.weights[1] * q.b - wall.weights[2] * q.c).norm();
}

/// Of the contacts with the same side the one whose normal is nearest to the wall's.
ContactConstraint* WallsOfParticle::find_contact(const WallImpulse& wall, bool back) const {
  ContactConstraint* found = nullptr;
  double best = same_wall_cosine * wall.normal.norm();
  for (std::size_t k = begin_; k < contacts_end_; ++k) {
    const Contact& c = constraints_[k].contact;
    if (c.surface != wall.surface || c.back != back || !(c.normal.dot(wall.normal) > best)) continue;
    best = c.normal.dot(wall.normal);
    found = &constraints_[k];
  }
  return found;
}

WallGroup& WallsOfParticle::group_of(const WallImpulse& wall, bool back) {
  for (WallGroup& g : groups_)
    if (g.surface == wall.surface && g.back == back &&
        g.normal.dot(wall.normal) > same_wall_cosine * g.normal.norm() * wall.normal.norm())
      return g;
  groups_.emplace_back();
  groups_.back().surface = wall.surface;
  groups_.back().back = back;
  return groups_.back();
}

void WallsOfParticle::add(const WallImpulse& wall) {
  const double length = wall.normal.norm();
  if (!(length > 0)) return;
  const bool back = is_on_back(wall);
  if (!is_dry(context_, wall.surface, back)) return;
  const Vec3 impulse = wall.impulse / length * wall.normal;
  if (ContactConstraint* c = find_contact(wall, back)) {
    c->wall_impulse += c->contact.normal.dot(impulse);
    return;
  }
  WallGroup& group = group_of(wall, back);
  group.normal += wall.normal;
  group.impulse += impulse;
  const double distance = distance_of(wall);
  if (group.nearest && distance >= group.distance) return;
  group.nearest = &wall;
  group.distance = distance;
}

void WallsOfParticle::finish(const Vec3& spare_load) {
  for (const WallGroup& g : groups_) append(g);
  if (!spare_load.isZero(0)) give_spare_load(spare_load);
  const auto without_load = [](const ContactConstraint& c) { return !(c.friction_load() > 0); };
  constraints_.erase(std::remove_if(constraints_.begin() + static_cast<std::ptrdiff_t>(contacts_end_),
                                    constraints_.end(), without_load),
                     constraints_.end());
}

void WallsOfParticle::append(const WallGroup& group) {
  Contact contact;
  contact.particle = group.nearest->particle;
  contact.surface = group.surface;
  contact.triangle = group.nearest->triangle;
  contact.nodes = context_.surfaces[group.surface]->triangles[contact.triangle];
  contact.weights = group.nearest->weights;
  contact.normal = group.normal.normalized();
  contact.distance = group.distance;
  contact.back = group.back;
  constraints_.push_back(make_constraint(context_, contact));
  constraints_.back().normal_active = constraints_.back().friction_active = false;
  constraints_.back().wall_impulse = std::max(0.0, contact.normal.dot(group.impulse));
}

/// To the wall whose normal is nearest to that of the load; of walls in one plane, as floors side by side, to
/// the nearest one.
void WallsOfParticle::give_spare_load(const Vec3& spare_load) {
  const double size = spare_load.norm();
  const auto along = [&](const ContactConstraint& k) { return k.contact.normal.dot(spare_load); };
  ContactConstraint* found = nullptr;
  const auto is_better = [&](const ContactConstraint& k) {
    if (!found) return true;
    const double more = along(k) - along(*found);
    return std::abs(more) < same_normal * size ? k.contact.distance < found->contact.distance : more > 0;
  };
  for (std::size_t k = begin_; k < constraints_.size(); ++k) {
    ContactConstraint& c = constraints_[k];
    if (!is_dry(context_, c.contact.surface, c.contact.back) || !(along(c) > same_wall_cosine * size))
      continue;
    if (is_better(c)) found = &c;
  }
  if (found) found->spare_load = along(*found);
}

}  // namespace

void add_wall_impulses(const Context& context, std::vector<ContactConstraint>& constraints) {
  if (context.wall_impulses.empty()) return;
  std::vector<ContactConstraint> merged;
  merged.reserve(constraints.size() + context.wall_impulses.size());
  const WallImpulse *wall = context.wall_impulses.begin(), *end = context.wall_impulses.end();
  std::size_t next = 0;
  while (next < constraints.size() || wall != end) {
    std::uint32_t p = wall != end ? wall->particle : UINT32_MAX;
    if (next < constraints.size()) p = std::min(p, constraints[next].contact.particle);
    const std::size_t begin = merged.size();
    while (next < constraints.size() && constraints[next].contact.particle == p)
      merged.push_back(constraints[next++]);
    WallsOfParticle walls(context, merged, begin);
    for (; wall != end && wall->particle == p; ++wall)
      if (!context.out_of_play[p]) walls.add(*wall);
    walls.finish(p < context.spare_load.size() ? context.spare_load[p] : Vec3::Zero());
  }
  constraints.swap(merged);
}

void keep_spare_load(const Context& context, const std::vector<ContactConstraint>& constraints) {
  for (Vec3& spare : context.spare_load) spare.setZero();
  if (context.spare_load.empty()) return;
  for (const ContactConstraint& k : constraints) {
    const Contact& c = k.contact;
    const SlipSettings& slip = context.surfaces[c.surface]->slip_on(c.back);
    if (!is_dry(context, c.surface, c.back)) continue;
    double left = k.load() > 0 ? k.load() : k.spare_load;  // sticking: while it is within reach of the wall
    if (slip.model == SlipModel::coulomb) {
      const double used = slip.friction > 0 ? k.tangential_impulse.norm() / slip.friction : 0;
      left = std::clamp(k.friction_load() - used, 0.0, std::max(k.load(), spare_left * k.spare_load));
    }
    Vec3& spare = context.spare_load[c.particle];
    if (left > spare.norm()) spare = left * c.normal;
  }
}

}  // namespace oilskin::contact
