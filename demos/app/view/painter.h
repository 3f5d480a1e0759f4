/// Draws a shown scene with OpenGL.
#pragma once

#include <memory>
#include <vector>

#include "view/camera.h"
#include "view/gl.h"
#include "view/shown_scene.h"

namespace oilskin::demo {

class Painter {
 public:
  /// Throws SceneError where OpenGL lacks something.
  explicit Painter(Gl::Load load);

  /// Into the window from column `left` on. `grip`: from the held place to its goal, where something is held.
  /// `up`: of the sky that water mirrors.
  void draw(const ShownScene& scene, const ShowOptions& options, const OrbitCamera& camera, int left,
            int width, int height, const std::optional<Grip>& grip, const Vec3& up);
  /// Red, green, blue, from the upper left corner, of what was drawn last.
  std::vector<unsigned char> pixels(int width, int height) const;

 private:
  struct Surface {
    std::unique_ptr<Vertices> faces, border, held;
  };
  void upload(const ShownScene& scene, const ShowOptions& options);
  Surface upload_surface(const ShownMesh& mesh);
  void look(const Program& program) const;
  void draw_surfaces(const ShownScene& scene, const ShowOptions& options, bool clear_bodies);
  void draw_lines(const ShownScene& scene, const std::optional<Grip>& grip);
  void draw_water(const ShowOptions& options, const ShownScene& scene, const Vec3& up);

  Gl gl_;
  Program drops_, meshes_, water_, lines_, sky_;
  Vertices balls_, water_mesh_, nothing_, pull_;
  std::vector<Surface> surfaces_;
  std::uint64_t uploaded_ = 0;
  Eigen::Matrix4f view_ = Eigen::Matrix4f::Identity(), projection_ = Eigen::Matrix4f::Identity();
  float cut_[4] = {0, 0, 0, -1};
  int height_ = 1;  ///< of the picture [pixels]
};

}  // namespace oilskin::demo
