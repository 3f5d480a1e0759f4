/// Contacts as the pressure solvers see them.
#pragma once

#include "oilskin/types.h"

namespace oilskin::fluid {

/// A one-sided bound on predicted velocities: v*·normal ≥ min_normal_velocity (F.36). For a particle at
/// distance d0 from a sheet of thickness h that moves with v_w, min_normal_velocity = v_w·n − max(0, d0 −
/// h)/dt. It keeps the prediction on the particle's side of the sheet and gives no impulse to anything.
struct PredictionContact {
  std::uint32_t particle = 0;
  Vec3 normal = Vec3::Zero();
  double min_normal_velocity = 0;  ///< [m/s]
};

}  // namespace oilskin::fluid
