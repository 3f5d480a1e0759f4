/// Contacts at the start positions, one per closest feature (docs/theory/contact.md, "Contacts").
#pragma once

#include "contact/candidates.h"

namespace oilskin::contact {

/// The contacts of all particles: one per local minimum of a particle's distance to a surface within the
/// radius of (C.4) or within the first layer of a viscous wall. The geometry depends on x_t0 only; which
/// contacts are active depends on x_t1.
class ContactSet {
 public:
  void find(const Context& context, const CandidateSet& candidates);
  /// The same for some particles, ascending, whose candidates have changed.
  void update(const Context& context, const CandidateSet& candidates,
              const std::vector<std::uint32_t>& particles);

  /// Contacts whose stop and repulsion, or whose friction, may act. Ordered by particle, surface, triangle.
  void select_active(const Context& context, std::vector<Contact>& active) const;

 private:
  std::vector<Contact> contacts_;
};

/// Do stop and repulsion act (C.6)? If d0 < h, or if the end gap is below h and the path does not pass a
/// border or a fold farther than h away.
bool comes_within_thickness(const Context& context, const Contact& contact);

/// Is the particle within friction_distance() of a side that is not free slip?
bool friction_may_act(const Context& context, const Contact& contact);

/// Gap along the contact's normal at the end of the interval (C.5) [m].
double end_gap(const Context& context, const Contact& contact);

/// A unit direction for a particle that lies on a triangle: the triangle's normal; for a triangle without
/// area, the axis of smallest index that is not along it, made perpendicular to it.
Vec3 geometric_normal(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace oilskin::contact
