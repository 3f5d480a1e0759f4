#include "study/cases/parts.h"

#include <algorithm>

namespace oilskin::demo {

Scene empty_scene(double spacing, double duration) {
  Scene scene;
  scene.host = HostKind::mock;
  scene.dt = 0.2 * spacing;
  scene.duration = duration;
  scene.series_every = 0;
  scene.pictures.frames_per_second = 0;
  scene.fluid.spacing = spacing;
  scene.contact.verify = true;
  scene.world.gravity = Vec3(0, -earth, 0);
  scene.world.kill_box = {Vec3::Constant(-1), Vec3::Constant(1)};
  return scene;
}

FilledBox water_box(const Vec3& low, const Vec3& high) {
  FilledBox box;
  box.box = {low, high};
  return box;
}

Body tank_body(const Vec3& low, const Vec3& high) {
  TankShape tank;
  tank.inside = {low, high};
  Body body;
  body.shape = tank;
  return body;
}

Mesh sheet_mesh(const Vec3& corner, const Vec3& u, const Vec3& v, int nu, int nv) {
  Mesh mesh;
  for (int j = 0; j <= nv; ++j)
    for (int i = 0; i <= nu; ++i)
      mesh.vertices.push_back(corner + u * (double(i) / nu) + v * (double(j) / nv));
  const auto node = [nu](int i, int j) { return static_cast<std::uint32_t>(i + (nu + 1) * j); };
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      mesh.triangles.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1)});
      mesh.triangles.push_back({node(i, j), node(i + 1, j + 1), node(i, j + 1)});
    }
  return mesh;
}

void append(Mesh& mesh, const Mesh& part) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const Triangle& t : part.triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

Body mesh_body(Mesh mesh) {
  PlacedMesh placed;
  placed.mesh = std::move(mesh);
  Body body;
  body.shape = std::move(placed);
  return body;
}

Vec3 impulse_on(const SurfaceMotion* surface) {
  return surface == nullptr ? Vec3(Vec3::Zero()) : load_of(*surface).impulse;
}

Vec3 mean_position(const World& world) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : world.positions()) sum += x;
  return sum / static_cast<double>(std::max<std::size_t>(world.particle_count(), 1));
}

double largest_speed(const World& world) {
  double speed = 0;
  for (const Vec3& v : world.motions()) speed = std::max(speed, v.norm());
  return speed;
}

}  // namespace oilskin::demo
