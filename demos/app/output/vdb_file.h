/// OpenVDB files of the water. Needs OpenVDB; without it vdb_available() is false and nothing else may be
/// called.
#pragma once

#include <string>

#include "output/surface_file.h"

namespace oilskin::demo {

/// Whether the program was built with OpenVDB.
bool vdb_available();

/// Grid `surface`: the signed distance from the mesh [m] within 3 cells, negative inside; a voxel is a cell,
/// its centre a multiple of it. Cavities are outside. With the channel `velocity` also the grid `velocity`
/// [m/s]: that of the nearest point of the mesh, at the same voxels. Equal meshes give equal bytes. Throws
/// OutputError.
void write_vdb(const std::string& path, const SurfaceFile& file);

/// The metadata `made_with` of the file; empty if it has none.
std::string vdb_made_with(const std::string& path);

}  // namespace oilskin::demo
