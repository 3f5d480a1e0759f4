/// A line of JSON for each frame of the window.
#pragma once

#include <fstream>
#include <map>
#include <string>

#include "view/viewer.h"

namespace oilskin::demo {

class FrameLog {
 public:
  /// Writes to `path`; empty = nothing. Throws SceneError where that cannot be written.
  explicit FrameLog(const std::string& path);
  /// `places`: of the panel's switches and buttons [pixels].
  void write(std::uint64_t frame, const Viewer& viewer,
             const std::map<std::string, std::array<float, 2>>& places);

 private:
  std::ofstream file_;
};

/// What a line says.
Json frame_line(std::uint64_t frame, const Viewer& viewer);

}  // namespace oilskin::demo
