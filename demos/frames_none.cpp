/// Stands in for VTK where the program was built without it.
#include "frames.h"

namespace oilskin::demo {

bool pictures_available(std::string* why) {
  *why = "this program was built without VTK (OILSKIN_RENDER=OFF)";
  return false;
}

std::unique_ptr<Frames> make_frames(const Scene&, const FrameOptions&) {
  return nullptr;
}

}  // namespace oilskin::demo
