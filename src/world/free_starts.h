/// Which starts of emitters have a free place.
#pragma once

#include "fluid/emission/emission.h"
#include "fluid/particles.h"
#include "world/attachments.h"

namespace oilskin::world {

/// Per start: `blocked` where a surface is nearer than 2 δ, or outside the kill box. Of volumes also what
/// would start compressed, and burst: points that are much nearer to a surface than the lattice beside one,
/// with BoundaryModel::mirrored, and points near to a particle or to a point of another volume
/// (docs/theory/fluid.md, section 12).
std::vector<fluid::Outcome> judge_starts(const std::vector<fluid::Start>& starts, const FluidSettings& fluid,
                                         const Box& kill_box, const ActiveSurfaces& surfaces,
                                         const fluid::Particles& particles, const Workers& workers);

}  // namespace oilskin::world
