/// The mesh of the water's surface at one moment, as the scene asks for, and its check.
#pragma once

#include "oilskin/reconstruction.h"
#include "scene/scene.h"

namespace oilskin::demo {

struct MadeMesh {
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
/// What may be wrong with particles that are meshed: half of them have their nearest neighbour within 0.5
/// spacings, or none within 2.5, or several are at the same place. Empty if nothing is.
std::vector<std::string> doubts_about(Span<const Vec3> positions, double spacing);

/// The water of each particle [m³]. `mass_ratio` as World::mass_ratios(), `particle_mass` in kg.
std::vector<double> water_volumes(std::size_t count, Span<const float> mass_ratio, double particle_mass,
                                  double rest_density);

/// Throws SceneError where the options or the input are refused.
MadeMesh make_mesh(const ReconstructionInput& input, const ReconstructionOptions& options);

/// Sums over all meshes of a run.
struct MeshTotals {
  std::uint64_t frames = 0, triangles = 0;  ///< triangles of the last frame
  std::uint64_t intersecting_pairs = 0, too_close_pairs = 0, submerged = 0,
                flaws = 0;                                        ///< flaws: edges, vertices
  double min_distance = std::numeric_limits<double>::infinity();  ///< [m]
  double seconds = 0;

  void add(const MadeMesh& made);
};

}  // namespace oilskin::demo
