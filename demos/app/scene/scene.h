/// A scene as plain data: what a scene file says, with every default in place (docs/manual/scene_file.md).
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "oilskin/emitter.h"
#include "oilskin/force_fields.h"
#include "oilskin/implicit_viscosity.h"
#include "oilskin/reconstruction.h"
#include "oilskin/settings.h"
#include "oilskin/surface_tension.h"
#include "oilskin/wetting.h"
#include "scene/fields.h"

namespace oilskin::demo {

constexpr double never = std::numeric_limits<double>::infinity();

enum class HostKind { bullet, bullet64, mock };

/// Of oilskin/presets.h.
enum class PresetKind { none, game, film, measurement };

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

/// Prescribed motion of pins, bodies and emitters between `start` and `stop`: rotation about a fixed axis,
/// then translation.
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
  double hold = 0;         ///< [s]; from then on they are pinned, where they are then
  double release = never;  ///< [s]
  Motion motion;
};

enum class PinKind { none, corners, border, nodes, boxes };

struct Pins {
  PinKind kind = PinKind::none;
  std::vector<int> nodes;
  std::vector<PinBox> boxes;
};

/// Nodes inside a box of the start positions follow a dynamic body, as if rods held them.
struct Anchor {
  int body = 0;
  Box within;
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
  bool waterproof = false;
  Vec3 wind = Vec3::Zero();  ///< of the air that drags at the cloth [m/s]; zero: no air
  std::vector<Anchor> anchors;
  std::optional<Fabric> fabric;  ///< absent: that of effects.wetting
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

  double volume() const { return 8 * half_extents.prod(); }  ///< [m³]
};

/// A box without its face towards `open`, as one sheet of triangles whose normals point inwards.
struct TankShape {
  Box inside;                                   ///< [m]
  Vec3 open = Vec3(0, 1, 0);                    ///< along an axis; zero: a closed box
  std::array<double, 4> rotate = {0, 0, 0, 1};  ///< about the middle of the box
};

/// Boxes that are one body.
struct CompoundShape {
  std::vector<BoxShape> boxes;
};

struct Body {
  std::variant<BoxShape, SphereShape, PlaneShape, PlacedMesh, TankShape, CompoundShape> shape;
  double mass = 0;     ///< [kg]; 0 = by density
  double density = 0;  ///< [kg/m³]; 0 and no mass: the water does not move it
  Motion motion;
  SurfaceSettings surface;

  bool is_dynamic() const { return mass > 0 || density > 0; }
  /// [kg], with its volume [m³]; 0 = the water does not move it.
  double mass_with(double volume) const { return mass > 0 ? mass : density * volume; }
};

enum class FieldKind { linear, rotation, taylor_green, standing_wave };

/// One of the vector fields of oilskin/emitter.h.
struct FieldTerm {
  FieldKind kind = FieldKind::linear;
  Vec3 origin = Vec3::Zero();                           ///< [m]
  std::vector<Vec3> gradient;                           ///< linear: three rows
  Vec3 axis = Vec3(0, 1, 0);                            ///< rotation
  double rate = 0;                                      ///< rotation [rad/s]
  Vec3 edge_u = Vec3(1, 0, 0), edge_v = Vec3(0, 1, 0);  ///< taylor_green [m]
  StandingWave wave;                                    ///< standing_wave, without its origin and amplitude
  double amplitude = 0;                                 ///< taylor_green, standing_wave
};

/// How the particles of a volume start, beyond the velocity that they share.
struct InitialFields {
  std::vector<FieldTerm> flow;          ///< [m/s]
  std::vector<FieldTerm> displacement;  ///< [m]
  double shake = 0;                     ///< [spacings]
};

struct FilledBox {
  Box box;  ///< [m]
  Vec3 velocity = Vec3::Zero();
  double start = 0;
  InitialFields initial;
};

struct PlacedMeshEmitter {
  PlacedMesh mesh;
  Vec3 velocity = Vec3::Zero();
  double start = 0;
  InitialFields initial;
};

struct Emitter {
  using Shape = std::variant<DiscEmitter, FilledBox, PlacedMeshEmitter, RainEmitter>;

  Shape shape;
  Motion motion;
  bool inherits_motion = true;  ///< its water has the velocity of its centre, too
  double max_age = never;       ///< of its particles [s]

  Emitter() = default;
  template <class S>
  Emitter(S s) : shape(std::move(s)) {}
};

/// The water's surface as triangles, for every frame (oilskin/reconstruction.h). In a scene with wetting that
/// gives no mode, the mode is `wet`.
struct WaterMeshSettings {
  double cell = 0;  ///< edge of a grid cell [m]; 0 = half a spacing
  double gap = 0;   ///< to cloth and bodies [m]
  ObstacleMode mode = ObstacleMode::gap;
  ReconstructionField field = ReconstructionField::density_decay;
  double touch_range = 1;       ///< in spacings
  double wet_saturation = 0.5;  ///< from which on cloth is wet
  double wet_blend = 0.5;       ///< width of the transition, as a fraction of wet_saturation
  double overlap_depth = 0;     ///< [m]
  int smoothing = 10;           ///< iterations
  bool keep_volume = true;      ///< of the water
  double min_blob = 0;          ///< in spacings³
  /// Of the files, see known_formats().
  std::vector<std::string> formats = {"ply"};
  /// Of the vertices, see known_channels().
  std::vector<std::string> channels = {"velocity"};
};

/// A cut through the scene: only water within the slab is shown, and of surfaces their lines in its middle
/// plane.
struct Slice {
  Vec3 point = Vec3::Zero(), normal = Vec3(0, 0, 1);
  double thickness = 0.01;  ///< [m]
};

/// The quantity that colours the water.
enum class WaterColour { speed, pressure, density };

/// How the water is drawn; automatic: its surface where the scene has one, else balls.
enum class WaterLook { automatic, balls, surface, clear };

struct View {
  Vec3 eye = Vec3(0.55, 0.45, 0.75), target = Vec3::Zero(), up = Vec3(0, 1, 0);
  double angle = 30;        ///< of sight, vertical [degrees]
  double orthographic = 0;  ///< height of what is seen without perspective [m]; 0 = with, by the angle
  std::optional<Slice> slice;
  WaterLook water = WaterLook::automatic;
  WaterColour colour = WaterColour::speed;
  std::string title;
};

struct Pictures {
  double frames_per_second = 30;  ///< of simulated time; 0 = none
  double max_speed = 0;           ///< end of the colour scale [m/s]; 0 = the fastest of the first frames
  double max_pressure = 1000;     ///< end of the colour scale [Pa]
  std::vector<View> views;        ///< side by side; empty: two views around the surfaces
};

/// The effects that a scene names; an absent one is not simulated.
struct SceneEffects {
  std::optional<ImplicitViscositySettings> viscosity;
  std::optional<WettingSettings> wetting;
  std::optional<SurfaceTensionSettings> surface_tension;
  std::vector<Force> forces;
};

struct Scene {
  std::string name;
  std::string description;
  std::string directory;  ///< of the scene file; not part of it
  HostKind host = HostKind::bullet;
  PresetKind preset = PresetKind::none;
  double dt = 0.001, duration = 0.5;  ///< [s]
  bool adaptive_dt = false;           ///< dt is the longest step
  double min_dt = 1e-5;               ///< the shortest, where it adapts [s]
  int series_every = 1;               ///< steps between two rows of series.csv; 0 = no file
  std::uint64_t seed = 1;
  WorldSettings world;
  FluidSettings fluid;
  ContactSettings contact;
  std::vector<Emitter> emitters;
  std::vector<Cloth> cloth;
  std::vector<Body> bodies;
  std::vector<Region> sinks;
  double max_age = never;  ///< of particles [s]
  SceneEffects effects;
  std::optional<WaterMeshSettings> water_mesh;  ///< scene key "surface"
  Json acceptance = Json::object();  ///< the checks of a run, as the file has them (checks/acceptance.h)
  Pictures pictures;
  std::vector<std::string> notes;  ///< on keys that have no effect; not part of the file
};

}  // namespace oilskin::demo
