/// Stands in for VTK where the program was built without it.
#include "fields.h"
#include "frames.h"
#include "mesh_command.h"

namespace oilskin::demo {

bool pictures_available(std::string* why) {
  *why = "this program was built without VTK (OILSKIN_RENDER=OFF)";
  return false;
}

std::unique_ptr<Frames> make_frames(const Scene&, const FrameOptions&) {
  return nullptr;
}

int mesh_command(const MeshOptions&) {
  throw SceneError(
      "mesh: reading stored frames needs VTK, and this program was built without (OILSKIN_RENDER=OFF)");
}

}  // namespace oilskin::demo
