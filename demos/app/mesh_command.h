/// `oilskin mesh DIR`: the water's surface of frames that a run stored.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace oilskin::demo {

struct MeshOptions {
  std::string directory;
  std::string out;                           ///< empty: the same folder
  std::string frames;                        ///< A:B, both included; empty: all
  std::optional<double> cell, gap, spacing;  ///< [m]; absent: what the run's report.json says
  std::string mode;                          ///< empty: likewise
  std::optional<int> smoothing;
  std::vector<std::string> formats, channels;  ///< empty: likewise
  std::vector<std::string> set;                ///< surface.KEY=VALUE; the options above win
  std::optional<double> density;               ///< of the water [kg/m³]; absent: likewise
  int threads = 0;
  bool overwrite = false, quiet = false;
  bool missing = false;  ///< only print the frames that lack a file
};

/// Writes OUT/surface_NNNN.ply (or the formats asked for) for each frame, skipping those that are there
/// unless `overwrite`. Returns the exit code: 1 if a surface is not as promised. Throws SceneError for what
/// is refused, OutputError.
int mesh_command(const MeshOptions& options);

}  // namespace oilskin::demo
