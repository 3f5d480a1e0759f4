/// Contact records at the start positions, by closest feature (docs/theory/contact.md, "Contacts").
#pragma once

#include "contact/candidates.h"

namespace oilskin::contact {

/// Geometry of every particle that starts nearer than thickness + spacing to a surface and may come within
/// the thickness, or is in the first layer of a viscous wall: one record for each local minimum of its
/// distance to the surface. The geometry depends on x_t0 alone; which records act depends on x_t1.
class ContactSet {
 public:
  void find(const Context& context, const CandidateSet& candidates);
  /// The same for some particles, ascending, whose candidates have changed.
  void update(const Context& context, const CandidateSet& candidates,
              const std::vector<std::uint32_t>& particles);

  /// Those that undercut the thickness, and those that may slip. Ordered by particle, surface, triangle.
  void select_active(const Context& context, std::vector<Contact>& active) const;

 private:
  std::vector<Contact> near_;
};

/// (C.6): d0 < h, or the gap along n falls below h by the end (records exist for d0 < h + dx only) and the
/// way does not pass farther than h beside a border or a fold: stop and repulsion act.
bool comes_within_thickness(const Context& context, const Contact& contact);

/// Is the particle in the first layer of a side that is not free slip: d0 ≤ h + 0.1 dx, or z < dx of a
/// viscous wall? See friction_distance().
bool friction_may_act(const Context& context, const Contact& contact);

/// Gap along the contact's normal at the end of the interval (C.5) [m].
double end_gap(const Context& context, const Contact& contact);

/// A unit direction for a particle that lies on a triangle: its geometric normal, or the axis of smallest
/// index that is not along the triangle where it has no area.
Vec3 geometric_normal(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace oilskin::contact
