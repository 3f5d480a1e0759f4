/// The water's mesh of a frame as a file.
#pragma once

#include <string>

#include "oilskin/reconstruction.h"
#include "oilskin/surface_motion.h"

namespace oilskin::demo {

/// PLY, binary little endian: x y z nx ny nz and, if the mesh has velocities, vx vy vz as float32; triangles
/// as lists of int; `made_with`, one line, as a comment. Written beside its place and renamed, so that a file
/// of that name is whole. Throws OutputError.
void write_water_mesh(const std::string& path, const WaterMesh& mesh, const std::string& made_with);

/// The same for a surface: x y z and `wetness`, one value per vertex, as float32.
void write_wet_mesh(const std::string& path, const SurfaceMotion& motion, Span<const float> wetness);

/// The comment `made_with` of the file; empty if there is none.
std::string mesh_made_with(const std::string& path);

}  // namespace oilskin::demo
