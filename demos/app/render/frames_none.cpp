/// Stands in for VTK where the program was built without it.
#include "render/make_frames.h"
#include "render/stored_frames.h"
#include "scene/fields.h"

namespace oilskin::demo {

bool pictures_available(std::string* why) {
  *why = "this program was built without VTK (OILSKIN_RENDER=OFF)";
  return false;
}

std::unique_ptr<Frames> make_frames(const Scene&, const FrameOptions&) {
  return nullptr;
}

StoredFrames::StoredFrames(const std::string&) {
  throw SceneError(
      "mesh: reading stored frames needs VTK, and this program was built without (OILSKIN_RENDER=OFF)");
}

// There is no object to call it of.
StoredFrame StoredFrames::read(int) const {
  return {};
}

}  // namespace oilskin::demo
