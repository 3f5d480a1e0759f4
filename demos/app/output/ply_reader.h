/// Triangle meshes of PLY files as runs write them.
#pragma once

#include <string>
#include <vector>

#include "oilskin/types.h"

namespace oilskin::demo {

struct StoredMesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  std::vector<float> wetness;  ///< saturation of the vertices; empty if the file has none
};

/// Binary little-endian PLY: vertices with x, y, z (float or double) among scalar properties, faces as one
/// list of int (polygons become fans). Throws SceneError naming the file and what is wrong: a file that is
/// cut short, indices that name no vertex and numbers that are not finite are refused.
StoredMesh read_ply(const std::string& path);

}  // namespace oilskin::demo
