/// The nozzle that a picture shows around the mouth of a round emitter.
#pragma once

#include "scene/scene.h"

namespace oilskin::demo {

/// A tube around the axis, open at both ends: from the mouth two radii back, a little wider than the jet.
/// @param direction of the jet, of length 1
/// @param radius of the mouth [m], > 0
Mesh nozzle_mesh(const Vec3& center, const Vec3& direction, double radius);

}  // namespace oilskin::demo
