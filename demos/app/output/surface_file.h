/// The water's mesh of a frame as files of other programs.
#pragma once

#include <string>
#include <vector>

#include "output/vertex_channels.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// What a file of the mesh holds. Nothing but the channels is owned.
struct SurfaceFile {
  const WaterMesh& mesh;
  std::vector<VertexChannel> channels;
  /// The options that made it, one line.
  std::string made_with;
  /// The edge of a grid cell of the reconstruction [m], > 0: the voxel of a level set.
  double cell;
};

/// The file of a mesh that was made of `input` with the settings `wanted`; `ids` of the particles, or none.
/// The spacing is in metres.
SurfaceFile surface_file(const WaterMesh& mesh, const ReconstructionInput& input,
                         Span<const std::uint64_t> ids, const WaterMeshSettings& wanted, double spacing);

/// Refuses formats whose library the program was built without, naming its package. Throws SceneError.
void require_formats(const std::vector<std::string>& formats);

/// DIR/surface_NNNN.FORMAT for each format. Throws OutputError.
void write_surface(const std::string& directory, int number, const std::vector<std::string>& formats,
                   const SurfaceFile& file);

/// The line `made_with` of a file of that format; empty if it has none.
std::string surface_made_with(const std::string& path, const std::string& format);
/// Whether a file of write_surface() is as long as it says; of VDB always.
bool surface_is_whole(const std::string& path, const std::string& format);

}  // namespace oilskin::demo
