/// Vertex data: normals, and quantities interpolated from particles.
#pragma once

#include "reconstruction/field.h"
#include "reconstruction/polygonise.h"

namespace oilskin::reconstruction {

/// Unit: the mean of the triangles, weighted by area. (0, 0, 1) where it has no direction.
void vertex_normals(const RawMesh& mesh, const SurfaceBlocks& blocks, const Workers& workers,
                    std::vector<std::array<float, 3>>& normals);

/// Velocities and attributes of the particles that a vertex sees, by moving least squares of first order
/// (R.24): linear fields are reproduced, also if all particles are on one side. Extrapolation is limited to
/// half of the particles' range beyond it. With `wants_nearest` also WaterMesh::nearest.
void interpolate(const ReconstructionInput& input, const ParticleBlocks& particles,
                 const FieldParameters& field, const Obstacles& obstacles, bool use_visibility,
                 bool wants_nearest, const Grid& grid, const RawMesh& raw, WaterMesh& mesh,
                 const Workers& workers);

}  // namespace oilskin::reconstruction
