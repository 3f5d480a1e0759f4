#include "scene/fields.h"
#include "view/view_options.h"

namespace oilskin::demo {

int view_scene(const Scene&, const ViewOptions&, const MakeSimulation&) {
  throw SceneError(
      "view: this program was built without a window, which needs GLFW 3.3, ImGui and libpng (Debian: "
      "libglfw3-dev, libimgui-dev, libpng-dev) and -DOILSKIN_WINDOW=ON; demos/run view SCENE installs them");
}

}  // namespace oilskin::demo
