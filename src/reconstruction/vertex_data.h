/// What vertices carry: normals, and the quantities of the particles around them.
#pragma once

#include "reconstruction/field.h"
#include "reconstruction/polygonise.h"

namespace oilskin::reconstruction {

std::vector<std::array<float, 3>> vertex_normals(const RawMesh& mesh);

/// Velocities and attributes of the particles that a vertex can see, by moving least squares of first order
/// (R.24): a field that is linear in space comes out as it is, also where all particles lie on one side. What
/// that would extrapolate is limited to half of the particles' range beyond it.
void interpolate(const ReconstructionInput& input, const ParticleBlocks& particles,
                 const FieldParameters& field, const Obstacles& obstacles, bool sees, const Grid& grid,
                 const RawMesh& raw, WaterMesh& mesh, const Workers& workers);

}  // namespace oilskin::reconstruction
