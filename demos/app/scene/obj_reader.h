/// Reads the v and f lines of Wavefront OBJ files.
#pragma once

#include <iosfwd>
#include <string>

#include "scene/scene.h"

namespace oilskin::demo {

/// Polygons become fans; negative indices count from the end; other lines are skipped. Throws SceneError with
/// the name of the file and the number of the line.
Mesh read_obj(std::istream& in, const std::string& name);
Mesh read_obj_file(const std::string& path);

/// The mesh of `placed.file`, resolved against `directory`, put in its place.
void load(PlacedMesh& placed, const std::string& directory);

}  // namespace oilskin::demo
