/// Normal impulses that walls have given to particles before contact acts: those of boundary terms.
#pragma once

#include <array>
#include <cstdint>

#include "oilskin/types.h"

namespace oilskin::fluid {

/// What one triangle gave to one particle that is near it. The nodes already have the opposite impulse.
struct WallImpulse {
  std::uint32_t particle = 0;  ///< index into ParticleMotion
  std::uint32_t surface = 0;   ///< index into the list of surfaces
  std::uint32_t triangle = 0;
  std::array<double, 3> weights{};  ///< barycentric, of the closest point, Σ = 1
  Vec3 normal = Vec3::Zero();       ///< of the triangle, towards the particle; its length is a weight > 0
  double impulse = 0;               ///< along the normal, ≥ 0 [N s]
};

}  // namespace oilskin::fluid
