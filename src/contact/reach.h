/// How far from a surface its slip laws act.
#pragma once

#include "oilskin/contact.h"

namespace oilskin::contact {

/// z₀ of (C.18): where the water begins in front of a surface [m]. Half a spacing before the layer that rests
/// at the thickness, or at the sheet itself if that is nearer.
double wall_offset(const ParticleMotion& particles, const SurfaceMotion& surface);

/// d0 below which a slip law acts although there is no normal impulse [m]; 0 = free.
double friction_distance(const ParticleMotion& particles, const SurfaceMotion& surface,
                         const SlipSettings& slip);

/// d0 within which every particle needs a contact, whether it approaches or not: the first layer of a viscous
/// wall [m]. 0 where neither side of the surface is one.
double wall_layer(const ParticleMotion& particles, const SurfaceMotion& surface);

}  // namespace oilskin::contact
