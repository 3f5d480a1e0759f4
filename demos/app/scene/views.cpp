#include "scene/views.h"

#include <algorithm>

namespace oilskin::demo {

Box extents(const Scene& scene) {
  Box box;
  for (const Cloth& c : scene.cloth) {
    if (c.mesh) {
      for (const Vec3& x : c.mesh->mesh.vertices) box.add(x);
    } else {
      const double reach = 0.5 * std::max(c.size[0], c.size[1]);
      box.add(Vec3(c.center - Vec3::Constant(reach)));
      box.add(Vec3(c.center + Vec3::Constant(reach)));
    }
  }
  for (const Body& b : scene.bodies)
    if (const auto* mesh = std::get_if<PlacedMesh>(&b.shape))
      for (const Vec3& x : mesh->mesh.vertices) box.add(x);
  if (!(box.min.array() <= box.max.array()).all()) box = {Vec3::Constant(-0.3), Vec3::Constant(0.3)};
  return box;
}

std::vector<View> views_of(const Scene& scene) {
  if (!scene.pictures.views.empty()) return scene.pictures.views;
  const Box box = extents(scene);
  const Vec3 middle = 0.5 * (box.min + box.max);
  const double size = (box.max - box.min).norm();
  const Vec3 up = scene.world.gravity.norm() > 0 ? Vec3(-scene.world.gravity.normalized()) : Vec3(0, 1, 0);
  const Vec3 side = (up.unitOrthogonal() + 0.6 * up.cross(up.unitOrthogonal())).normalized();
  View above, below;
  above.title = "from above";
  below.title = "from below";
  for (View* v : {&above, &below}) {
    v->target = middle;
    v->up = up;
  }
  above.eye = middle + size * (1.2 * side + 0.85 * up);
  below.eye = middle + size * (1.2 * side - 0.7 * up);
  return {above, below};
}

double colour_end(const Scene& scene) {
  if (scene.pictures.max_speed > 0) return scene.pictures.max_speed;
  double fastest = 1;
  for (const Emitter& e : scene.emitters) {
    if (const auto* disc = std::get_if<DiscEmitter>(&e.shape)) fastest = std::max(fastest, disc->speed);
    if (const auto* rain = std::get_if<RainEmitter>(&e.shape))
      fastest = std::max(fastest, rain->velocity.norm());
    if (const auto* box = std::get_if<FilledBox>(&e.shape)) fastest = std::max(fastest, box->velocity.norm());
  }
  return 1.25 * fastest;
}

}  // namespace oilskin::demo
