/// A scene as lists of numbers that a graphics card takes.
#pragma once

#include <cstdint>
#include <vector>

#include "oilskin/reconstruction.h"
#include "view/live_scene.h"

namespace oilskin::demo {

enum class BodyLook { solid, clear, hidden };
enum class ShownWater { balls, surface, clear, none };

struct ShowOptions {
  ShownWater water = ShownWater::balls;
  WaterColour colour = WaterColour::speed;
  BodyLook bodies = BodyLook::solid;
  bool cut = false;  ///< what lies in front of `slice` is not shown
  Slice slice;
};

/// A ball, or a drop flat along `normal`.
struct ShownParticle {
  float position[3], radius, normal[3], height;
  float value;  ///< 0 … 1, place in the colour scale
};

struct ShownVertex {
  float position[3], normal[3];
  float value;  ///< saturation of cloth; of water the place in the colour scale
};

struct ShownMesh {
  std::vector<ShownVertex> vertices;
  std::vector<std::uint32_t> indices;  ///< three per triangle
  std::vector<std::uint32_t> border;   ///< two per edge of one triangle only
  std::vector<std::uint32_t> held;     ///< pinned vertices
  bool is_body = false;
};

/// The end of the colour scale, in the unit of the quantity.
struct ColourScale {
  const char* title;
  double from = 0, to = 1;
};
ColourScale colour_scale(const Scene& scene, WaterColour colour);

/// Keeps what has not changed from one moment to the next.
class ShownScene {
 public:
  /// Reads the state of a scene. Does nothing where neither the state nor the options changed.
  void update(const LiveScene& live, const ShowOptions& options, int threads);

  const std::vector<ShownParticle>& particles() const { return particles_; }
  /// The cloth, the bodies and the nozzles of the scene; those that are left out are empty.
  const std::vector<ShownMesh>& surfaces() const { return surfaces_; }
  const ShownMesh& water() const { return water_; }
  /// Grows with each change.
  std::uint64_t version() const { return version_; }
  /// Wall time of the last water mesh, and of the rest [s].
  double mesh_seconds() const { return mesh_seconds_; }
  double shapes_seconds() const { return shapes_seconds_; }
  /// Why there is no water mesh; empty where there is one.
  const std::string& mesh_refusal() const { return mesh_refusal_; }

 private:
  void read_surfaces(const LiveScene& live);
  void read_nozzles(const LiveScene& live);
  void read_particles(const LiveScene& live, const ShowOptions& options);
  void make_water(const LiveScene& live, int threads);

  std::vector<ShownParticle> particles_;
  std::vector<ShownMesh> surfaces_;
  std::vector<std::vector<Vec3>> drawn_at_;  ///< positions of the nodes, per surface
  ShownMesh water_;
  WaterMesher mesher_;
  WaterMesh mesh_;
  std::string mesh_refusal_;
  std::uint64_t version_ = 0, shown_ = 0;
  ShownWater look_ = ShownWater::none;
  WaterColour colour_ = WaterColour::speed;
  double mesh_seconds_ = 0, shapes_seconds_ = 0;
};

/// A surface as one mesh. Cloth is smooth; edges of bodies above 40° are sharp. `wetness` per node, or empty.
ShownMesh shown_surface(const SurfaceMotion& motion, bool is_body, Span<const float> wetness);

}  // namespace oilskin::demo
