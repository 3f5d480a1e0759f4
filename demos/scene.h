/// A scene as plain data: what a scene file says, with every default in place (docs/scene_file.md).
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "oilskin/emitter.h"
#include "oilskin/settings.h"

namespace oilskin::demo {

constexpr double never = std::numeric_limits<double>::infinity();

enum class HostKind { bullet, bullet64, mock };

struct Mesh {
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<Triangle> triangles;
};

/// A mesh file and where it stands: x → rotate(scale x) + translate.
struct PlacedMesh {
  std::string file;                             ///< relative to the scene file
  Vec3 translate = Vec3::Zero();                ///< [m]
  std::array<double, 4> rotate = {0, 0, 0, 1};  ///< quaternion x, y, z, w
  double scale = 1;
  Mesh mesh;  ///< as placed
};

/// Prescribed motion of pins and bodies between `start` and `stop`: rotation about a fixed axis, then
/// translation.
struct Motion {
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
  Vec3 spin_center = Vec3::Zero();
  Vec3 spin_axis = Vec3(0, 1, 0);
  double spin_rate = 0;            ///< [rad/s]
  double start = 0, stop = never;  ///< [s]

  bool moves() const { return spin_rate != 0 || !velocity.isZero(0); }
};

/// Pinned nodes inside a box of the start positions.
struct PinBox {
  Box within;
  double release = never;  ///< [s]
  Motion motion;
};

enum class PinKind { none, corners, border, nodes, boxes };

struct Pins {
  PinKind kind = PinKind::none;
  std::vector<int> nodes;
  std::vector<PinBox> boxes;
};

struct Cloth {
  std::optional<PlacedMesh> mesh;  ///< absent: the grid below
  std::array<int, 2> grid = {57, 57};
  std::array<double, 2> size = {0.5, 0.5};  ///< [m]
  Vec3 center = Vec3::Zero(), normal = Vec3(0, 1, 0), u_axis = Vec3(1, 0, 0);
  double bowl_depth = 0;       ///< [m], against the normal: the rest shape is a bowl
  double areal_density = 0.2;  ///< [kg/m²]
  Pins pins;
  int substeps = 8;  ///< of Bullet per dt; the same for every cloth of a scene
  int iterations = 4;
  bool bend_links = false;  ///< links across edges as well
  SurfaceSettings surface;
};

struct SphereShape {
  Vec3 center = Vec3::Zero();
  double radius = 0.1;
};
struct PlaneShape {
  Vec3 point = Vec3::Zero(), normal = Vec3(0, 1, 0);
};
struct BoxShape {
  Vec3 center = Vec3::Zero(), half_extents = Vec3::Constant(0.1);
  std::array<double, 4> rotate = {0, 0, 0, 1};
};

struct Body {
  std::variant<BoxShape, SphereShape, PlaneShape, PlacedMesh> shape;
  Motion motion;
  SurfaceSettings surface;
};

struct PlacedMeshEmitter {
  PlacedMesh mesh;
  Vec3 velocity = Vec3::Zero();
  double start = 0;
};

using Emitter = std::variant<DiscEmitter, BoxEmitter, PlacedMeshEmitter, RainEmitter>;

/// Mean tangential speed of the particles next to two sheets, compared.
struct SlipRatioCheck {
  int free = 0, no_slip = 1;  ///< indices of cloths
  double at_least = 5;        ///< speed next to `free` over speed next to `no_slip`
  double window = 0.1;        ///< the last seconds of the run
  double within = 0.75;       ///< of the sheet [spacings]
};

/// Mean vertical pin reaction against the weight of cloth and water.
struct PinReactionCheck {
  double tolerance = 0.01;
  double window = 1;  ///< the last seconds of the run
};

/// No particle below a cloth, inside its outline shrunk by a margin.
struct DryShadowCheck {
  int cloth = 0;
  double margin = 0.05;  ///< [m]
};

/// What a scene promises besides what is always checked.
struct Acceptance {
  std::optional<int> min_emitted;
  std::optional<int> min_over_rim;
  std::optional<double> vertical_momentum;  ///< largest relative difference
  std::optional<double> sag_below_dry;      ///< [m]
  std::optional<double> max_stretch;        ///< longest edge over rest length
  std::optional<SlipRatioCheck> slip_ratio;
  std::optional<PinReactionCheck> pin_reaction;
  std::optional<DryShadowCheck> dry_shadow;
};

struct View {
  Vec3 eye = Vec3(0.55, 0.45, 0.75), target = Vec3::Zero(), up = Vec3(0, 1, 0);
  double angle = 30;  ///< of sight, vertical [degrees]
  std::string title;
};

struct Pictures {
  double frames_per_second = 30;  ///< of simulated time; 0 = none
  double max_speed = 0;           ///< end of the colour scale [m/s]; 0 = the fastest of the first frames
  std::vector<View> views;        ///< side by side; empty: two views around the surfaces
};

struct Scene {
  std::string name;
  std::string description;
  std::string directory;  ///< of the scene file; not part of it
  HostKind host = HostKind::bullet;
  double dt = 0.001, duration = 0.5;  ///< [s]
  std::uint64_t seed = 1;
  WorldSettings world;
  FluidSettings fluid;
  ContactSettings contact;
  std::vector<Emitter> emitters;
  std::vector<Cloth> cloth;
  std::vector<Body> bodies;
  Acceptance acceptance;
  Pictures pictures;
};

}  // namespace oilskin::demo
