#include <dlfcn.h>

#include <cstdlib>

#include "output/mesh_file.h"
#include "render/frame_files.h"
#include "render/make_frames.h"
#include "render/picture.h"

namespace oilskin::demo {
namespace {

class VtkFrames : public Frames {
 public:
  VtkFrames(const Scene& scene, const FrameOptions& options) : options_(options) {
    if (options.pictures || options.window) picture_ = std::make_unique<Picture>(scene, options.window);
  }

  void write(int number, const FrameData& data) override {
    times_.push_back(data.t);
    if (options_.files) write_files(number, data);
    if (!picture_) return;
    picture_->show(data);
    if (options_.pictures) picture_->save(frame_path(options_.directory, "frame", number, "png"));
  }

  bool window_open() const override { return !picture_ || picture_->window_open(); }

 private:
  void write_files(int number, const FrameData& data) {
    write_particles(frame_path(options_.directory, "particles", number, "vtp"), data);
    write_meshes("cloth_", number, data.cloth, data.wetness);
    write_meshes("body_", number, data.bodies, {});
    write_series(options_.directory, times_);
  }

  void write_meshes(const std::string& kind, int number, const std::vector<const SurfaceMotion*>& surfaces,
                    const std::vector<std::vector<float>>& wetness) {
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
      if (surfaces[k] == nullptr) continue;
      const std::string path = frame_path(options_.directory, kind + std::to_string(k), number, "ply");
      if (k < wetness.size() && !wetness[k].empty())
        write_wet_mesh(path, *surfaces[k], wetness[k]);
      else
        write_mesh(path, *surfaces[k]);
    }
  }

  FrameOptions options_;
  std::unique_ptr<Picture> picture_;
  std::vector<double> times_;
};

/// VTK ends the process when there is no X server, so that is checked before.
bool display_answers() {
  void* x11 = dlopen("libX11.so.6", RTLD_NOW);
  if (x11 == nullptr) return false;
  const auto open = reinterpret_cast<void* (*)(const char*)>(dlsym(x11, "XOpenDisplay"));
  const auto close = reinterpret_cast<int (*)(void*)>(dlsym(x11, "XCloseDisplay"));
  void* display = open != nullptr ? open(nullptr) : nullptr;
  if (display == nullptr || close == nullptr) return false;
  close(display);
  return true;
}

}  // namespace

bool pictures_available(std::string* why) {
  const char* display = std::getenv("DISPLAY");
  if (display == nullptr || *display == '\0') {
    *why = "there is no X display (DISPLAY is not set); xvfb-run provides one, and demos/run uses it";
    return false;
  }
  if (!display_answers()) {
    *why = "the X display " + std::string(display) + " does not answer";
    return false;
  }
  return true;
}

std::unique_ptr<Frames> make_frames(const Scene& scene, const FrameOptions& options) {
  return std::make_unique<VtkFrames>(scene, options);
}

}  // namespace oilskin::demo
