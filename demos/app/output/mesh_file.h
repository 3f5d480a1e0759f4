/// Meshes as PLY files.
#pragma once

#include <string>

#include "oilskin/surface_motion.h"
#include "output/surface_file.h"

namespace oilskin::demo {

/// PLY, binary little endian: x y z nx ny nz as float32, then the properties of each channel as float32 or
/// int; triangles as lists of int; `made_with` as a comment. Written beside its place and renamed, so that a
/// file of that name is whole. Throws OutputError.
void write_ply(const std::string& path, const SurfaceFile& file);

/// PLY of a surface: x y z and `wetness`, one value per vertex, as float32.
void write_wet_mesh(const std::string& path, const SurfaceMotion& motion, Span<const float> wetness);

/// The comment `made_with` of the file; empty if there is none.
std::string ply_made_with(const std::string& path);
/// Whether a file of write_ply() is as long as its header says. A copy may have been cut off.
bool ply_is_whole(const std::string& path);

}  // namespace oilskin::demo
