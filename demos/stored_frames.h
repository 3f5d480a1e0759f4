/// Frames that an earlier run wrote, read back. Needs VTK; without it everything here refuses with
/// SceneError.
#pragma once

#include <string>
#include <vector>

#include "oilskin/types.h"
#include "ply_reader.h"

namespace oilskin::demo {

struct StoredFrame {
  std::vector<Vec3> position, velocity;  ///< [m], [m/s]; velocity may be empty
  std::vector<StoredMesh> obstacles;     ///< cloth, then bodies
};

/// The numbers of all DIR/particles_NNNN.vtp, ascending. Throws SceneError if there are none.
std::vector<int> stored_frames(const std::string& directory);

/// particles_NNNN.vtp and all cloth_K_NNNN.ply and body_K_NNNN.ply beside it. Throws SceneError naming the
/// file.
StoredFrame read_frame(const std::string& directory, int number);

}  // namespace oilskin::demo
