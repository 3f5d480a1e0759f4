/// How far from a surface its slip laws act.
#pragma once

#include "contact/context.h"

namespace oilskin::contact {

/// z₀ of (C.18): distance at which the water begins [m], half a spacing in front of the layer that rests at
/// h, or at the sheet if that is nearer.
double wall_offset(const Liquid& liquid, const SurfaceMotion& surface);

/// Distance d0 up to which friction acts without a normal impulse [m]; 0 for free slip.
double friction_distance(const Liquid& liquid, const SurfaceMotion& surface, const SlipSettings& slip);

/// Distance d0 within which each particle needs a contact even if it does not approach: the first layer of a
/// viscous wall [m]. 0 if neither side of the surface is one.
double wall_layer(const Liquid& liquid, const SurfaceMotion& surface);

}  // namespace oilskin::contact
