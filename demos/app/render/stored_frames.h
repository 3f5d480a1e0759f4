/// Frames that an earlier run wrote, read back. Needs VTK; without it everything here refuses with
/// SceneError.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "oilskin/types.h"
#include "output/ply_reader.h"

namespace oilskin::demo {

struct StoredFrame {
  std::vector<Vec3> position, velocity;  ///< [m], [m/s]; velocity may be empty
  std::vector<double> mass;              ///< [kg]; empty: all have the mass of a new particle
  std::vector<std::uint64_t> id;         ///< of the particles; may be empty
  std::vector<StoredMesh> obstacles;     ///< cloth, then bodies
};

class StoredFrames {
 public:
  /// Looks into the folder once. Throws SceneError if it holds no particles_NNNN.vtp.
  explicit StoredFrames(const std::string& directory);

  /// The numbers of all particles_NNNN.vtp, ascending.
  const std::vector<int>& numbers() const { return numbers_; }
  /// VTK and PLY files in the folder that have none of the names below, nor that of a water mesh; ascending.
  const std::vector<std::string>& other_files() const { return other_files_; }
  /// particles_NNNN.vtp and all cloth_K_NNNN.ply and body_K_NNNN.ply beside it. Throws SceneError naming the
  /// file.
  StoredFrame read(int number) const;

 private:
  struct Meshes {
    std::vector<int> cloth, bodies;  // their K
  };

  std::string directory_;
  std::vector<int> numbers_;
  std::vector<std::string> other_files_;
  std::map<int, Meshes> meshes_;
};

}  // namespace oilskin::demo
