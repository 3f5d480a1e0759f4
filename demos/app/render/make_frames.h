/// Pictures and ParaView files of a run. Needs VTK; without it make_frames() gives null.
#pragma once

#include <memory>
#include <string>

#include "output/frames.h"

namespace oilskin::demo {

/// Whether pictures can be drawn here and now; if not, why.
bool pictures_available(std::string* why);
/// Null when the program was built without VTK.
std::unique_ptr<Frames> make_frames(const Scene& scene, const FrameOptions& options);

}  // namespace oilskin::demo
