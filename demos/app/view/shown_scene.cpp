#include "view/shown_scene.h"

#include <algorithm>
#include <chrono>

#include "geometry/particle_shapes.h"
#include "hosts/scene_effects.h"
#include "output/water_mesh.h"
#include "scene/mesh_options.h"
#include "scene/views.h"
#include "view/nozzle_mesh.h"

namespace oilskin::demo {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void put(float (&to)[3], const Vec3& v) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(v[k]);
}

float place_in(const ColourScale& scale, double value) {
  return static_cast<float>(std::clamp((value - scale.from) / (scale.to - scale.from), 0.0, 1.0));
}

/// The cloth and bodies, in order; null = left out.
std::vector<const SurfaceMotion*> surfaces_of(const LiveScene& live) {
  std::vector<const SurfaceMotion*> surfaces;
  const Scene& scene = live.scene();
  for (std::size_t i = 0; i < scene.cloth.size(); ++i) surfaces.push_back(live.simulation().cloth(i));
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) surfaces.push_back(live.simulation().body(i));
  return surfaces;
}

WaterMeshSettings mesh_settings(const Scene& scene) {
  if (scene.water_mesh) return *scene.water_mesh;
  WaterMeshSettings settings;
  if (scene.effects.wetting) settings.mode = ObstacleMode::wet;
  return settings;
}

std::vector<float> wetness_of(const LiveScene& live, std::size_t surface, const SurfaceMotion& motion) {
  if (surface >= live.scene().cloth.size()) return {};
  return saturation(live.scene(), surface, live.simulation().models()[surface], motion);
}

}  // namespace

ColourScale colour_scale(const Scene& scene, WaterColour colour) {
  if (colour == WaterColour::pressure) return {"pressure [Pa]", 0, scene.pictures.max_pressure};
  if (colour == WaterColour::density)
    return {"density [kg/m\u00b3]", 0.9 * scene.fluid.rest_density, 1.1 * scene.fluid.rest_density};
  return {"speed [m/s]", 0, colour_end(scene)};
}

void ShownScene::update(const LiveScene& live, const ShowOptions& options, int threads) {
  const bool same_state = shown_ == live.version();
  if (same_state && look_ == options.water && colour_ == options.colour) return;
  const Clock::time_point start = Clock::now();
  if (!same_state) read_surfaces(live);
  if (options.water == ShownWater::balls) read_particles(live, options);
  shapes_seconds_ = seconds_since(start);
  const bool wants_mesh = options.water == ShownWater::surface || options.water == ShownWater::clear;
  if (wants_mesh) make_water(live, threads);
  shown_ = live.version();
  look_ = options.water;
  colour_ = options.colour;
  ++version_;
}

void ShownScene::read_surfaces(const LiveScene& live) {
  const std::vector<const SurfaceMotion*> surfaces = surfaces_of(live);
  surfaces_.resize(surfaces.size());  // without the nozzles
  drawn_at_.resize(surfaces.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    if (surfaces[s] == nullptr) {
      surfaces_[s] = {};
      drawn_at_[s].clear();
      continue;
    }
    const bool is_body = s >= live.scene().cloth.size();
    if (is_body && surfaces[s]->x_t1 == drawn_at_[s]) continue;
    surfaces_[s] = shown_surface(*surfaces[s], is_body, wetness_of(live, s, *surfaces[s]));
    drawn_at_[s] = surfaces[s]->x_t1;
  }
  read_nozzles(live);
}

void ShownScene::read_nozzles(const LiveScene& live) {
  for (const Nozzle& nozzle : live.simulation().nozzles()) {
    SurfaceMotion motion;
    Mesh tube = nozzle_mesh(nozzle.center, nozzle.direction, nozzle.radius);
    motion.x_t1 = std::move(tube.vertices);
    motion.triangles = std::move(tube.triangles);
    surfaces_.push_back(shown_surface(motion, true, {}));
  }
}

void ShownScene::read_particles(const LiveScene& live, const ShowOptions& options) {
  const World& world = live.world();
  const ColourScale scale = colour_scale(live.scene(), options.colour);
  const double spacing = live.scene().fluid.spacing;
  const std::vector<ParticleShape> shapes = particle_shapes(world.positions(), surfaces_of(live), spacing);
  particles_.resize(shapes.size());
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    ShownParticle& shown = particles_[i];
    const ParticleShape& shape = shapes[i];
    put(shown.position, world.positions()[i]);
    put(shown.normal, shape.normal);
    shown.radius = static_cast<float>(shape.ball ? 0.5 * spacing : shape.radius);
    shown.height = static_cast<float>(shape.ball ? 0.5 * spacing : shape.height);
    const double value = options.colour == WaterColour::pressure  ? world.pressures()[i]
                         : options.colour == WaterColour::density ? world.densities()[i]
                                                                  : world.motions()[i].norm();
    shown.value = place_in(scale, value);
  }
}

void ShownScene::make_water(const LiveScene& live, int threads) {
  const Clock::time_point start = Clock::now();
  const World& world = live.world();
  const Scene& scene = live.scene();
  ReconstructionInput input;
  input.positions = world.positions();
  input.velocities = world.motions();
  const std::vector<double> volumes = water_volumes(world.particle_count(), world.mass_ratios(),
                                                    world.particle_mass(), scene.fluid.rest_density);
  input.volumes = volumes;
  std::vector<std::vector<float>> wetness;
  const std::vector<const SurfaceMotion*> surfaces = surfaces_of(live);
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    wetness.push_back(surfaces[s] ? wetness_of(live, s, *surfaces[s]) : std::vector<float>());
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    if (surfaces[s]) input.obstacles.push_back({surfaces[s]->x_t1, surfaces[s]->triangles, wetness[s]});
  const Status status = mesher_.reconstruct(
      input, reconstruction_options(mesh_settings(scene), scene.fluid.spacing, threads), &mesh_);
  mesh_refusal_ = status.message;
  if (!status.ok()) mesh_ = {};
  const ColourScale scale = colour_scale(scene, WaterColour::speed);
  water_.vertices.resize(mesh_.positions.size());
  for (std::size_t i = 0; i < mesh_.positions.size(); ++i) {
    ShownVertex& vertex = water_.vertices[i];
    std::copy(mesh_.positions[i].begin(), mesh_.positions[i].end(), vertex.position);
    std::copy(mesh_.normals[i].begin(), mesh_.normals[i].end(), vertex.normal);
    const auto& v = mesh_.velocities[i];
    vertex.value = place_in(scale, Vec3(v[0], v[1], v[2]).norm());
  }
  water_.indices.clear();
  for (const Triangle& t : mesh_.triangles) water_.indices.insert(water_.indices.end(), t.begin(), t.end());
  mesh_seconds_ = seconds_since(start);
}

}  // namespace oilskin::demo
