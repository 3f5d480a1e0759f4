/// glTF 2.0 in its binary form. Needs TinyGLTF; without it gltf_available() is false and nothing else may be
/// called.
#pragma once

#include <string>

#include "output/surface_file.h"

namespace oilskin::demo {

/// Whether the program was built with TinyGLTF.
bool gltf_available();

/// One mesh `water` of one primitive: POSITION, NORMAL, indices, and each channel as _NAME. Floats are
/// float32; integers are pairs of unsigned shorts, the lower half first, because glTF has no vertices with
/// integers of 32 bits. Coordinates are those of the run, in metres. An empty mesh is a file without scenes.
/// Throws OutputError, also where 4 GiB are too few.
void write_gltf(const std::string& path, const SurfaceFile& file);

/// asset.extras.made_with of the file; empty if it has none.
std::string gltf_made_with(const std::string& path);
/// Whether the file is as long as its header says. A copy may have been cut off.
bool gltf_is_whole(const std::string& path);

}  // namespace oilskin::demo
