/// The surface of the water at one moment, as the scene wants it, and what it is worth.
#pragma once

#include "oilskin/reconstruction.h"
#include "scene/scene.h"

namespace oilskin::demo {

struct MadeSurface {
  WaterMesh mesh;
  ReconstructionReport report;
  MeshCheck check;
  double seconds = 0;  ///< of the reconstruction, the check not counted

  /// The mesh keeps away from obstacles, as asked; always true for modes that do not promise it.
  bool as_promised(ObstacleMode mode) const;
};

/// Refuses a spacing that cannot be that of these particles; one in other units, say. `which` begins the
/// message.
Status check_spacing(Span<const Vec3> positions, double spacing, const std::string& which);

/// Throws SceneError where the options or the input are refused.
MadeSurface make_surface(const ReconstructionInput& input, const ReconstructionOptions& options);

/// What all surfaces of a run come to.
struct SurfaceTotals {
  std::uint64_t frames = 0, triangles = 0;  ///< triangles of the last frame
  std::uint64_t intersecting_pairs = 0, near_pairs = 0, submerged = 0, flaws = 0;  ///< flaws: edges, vertices
  double min_distance = std::numeric_limits<double>::infinity();                   ///< [m]
  double seconds = 0;

  void add(const MadeSurface& made);
};

}  // namespace oilskin::demo
