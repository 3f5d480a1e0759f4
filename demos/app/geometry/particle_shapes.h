/// How particles are drawn beside surfaces.
#pragma once

#include "oilskin/surface_motion.h"

namespace oilskin::demo {

/// A ball, or beside a surface a drop that is flat along `normal`.
struct ParticleShape {
  bool ball = true;
  Vec3 normal = Vec3::Zero();
  double height = 0, radius = 0;  ///< half axes of a drop, along the normal and across it [m]
};

/// One shape per particle. Balls have half a spacing as radius. A particle nearer to a surface than that is a
/// drop that reaches no farther towards it than its distance: a whole ball would come through and look like
/// a leak. `surfaces` may have null in it.
std::vector<ParticleShape> particle_shapes(Span<const Vec3> positions,
                                           Span<const SurfaceMotion* const> surfaces, double spacing);

}  // namespace oilskin::demo
