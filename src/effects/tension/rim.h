/// The rim of a surface, for forces that are the slope of an energy.
#pragma once

#include "oilskin/effect.h"

namespace oilskin::effects {

/// The nearest point of the walls that a particle sees. Near the rim of a surface the share of it that is
/// seen (B.7) changes along the surface, and forces along the normals make energy. There the particle is
/// taken as one before a plane as far away as the nearest point, whose energy has a slope everywhere (S.8).
struct Rim {
  const VisibleWall* wall = nullptr;  ///< with the nearest point; null: there is none
  double distance = 0;                ///< from the nearest point [m]
  Vec3 normal = Vec3::Zero();         ///< from it to the particle; unit
  double part = 0;                    ///< t: 0 = the walls count by their shares, 1 = the nearest point alone

  Rim(const EffectForces& f, std::size_t particle);

  /// What of a vector the normal turns towards when the particle moves along it: nothing over a face, what is
  /// across an edge, what is tangential over a corner.
  Vec3 turning(const Vec3& vector) const;

 private:
  int corners_ = 0;           // of the feature that holds the nearest point
  Vec3 edge_ = Vec3::Zero();  // its direction; unit, if it is an edge
};

}  // namespace oilskin::effects
