/// What several validation cases measure.
#pragma once

#include "oilskin/world.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// Where the water's surface is within a box [m]: the 98 % quantile of the particles' heights y, and half a
/// spacing, because a particle's water reaches that much farther than its centre. Not finite without any.
double level_within(const World& world, const Box& within);
/// Of the particles within a box [kg].
double mass_within(const World& world, const Box& within);
/// The depth of water of that mass over an area [m²] at rest density [m]: the particles' volumes at rest are
/// 0.6 % smaller than their cells of the lattice.
double depth_of(const World& world, double mass, double area);

/// The sum of the free nodes' momenta [N s], and of their masses [kg].
Vec3 free_momentum(const SurfaceMotion& motion);
double free_mass(const SurfaceMotion& motion);

}  // namespace oilskin::demo
