/// Particles between a dynamic rigid body and another surface (docs/theory/contact.md, "Rigid bodies").
#pragma once

#include "contact/constraints.h"

namespace oilskin::contact {

/// A particle that has contacts with a body and, on the other side, with another surface, is as hard as they
/// are: what presses the body on the particle presses it on the surface. Gauss–Seidel alone would pass the
/// momentum of the body on in portions of the particle's mass.
class Squeezes {
 public:
  /// Finds them among the constraints of contacts, which are ordered by particle.
  Squeezes(const Context& context, const std::vector<ContactConstraint>& constraints);

  /// Stops the approach of body and surface, each pair in its order (C.39), (C.40).
  void solve(Context& context);

 private:
  struct Squeeze {
    Contact above, below;      // two points at one particle
    Vec3 normal;               // from below to above
    double allowed = 0;        // approach speed that leaves the thickness at the end of the next step [m/s]
    Vec3 next = Vec3::Zero();  // change of the relative velocity by gravity until then [m/s]
    double k = 0;              // [1/kg]
    double impulse = 0;        // accumulated [N s]
  };

  void add(const Context& context, const Contact& a, const Contact& b);

  std::vector<Squeeze> squeezes_;
};

}  // namespace oilskin::contact
