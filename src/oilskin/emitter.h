/// @file
/// Sources of particles.
#pragma once

#include <functional>

#include "oilskin/types.h"

namespace oilskin {

/// The handle of an emitter.
struct EmitterId {
  /// 0 = none.
  std::uint64_t value = 0;
  /// Whether it is the handle of an emitter.
  explicit operator bool() const { return value != 0; }
  /// Whether two handles are the same.
  bool operator==(EmitterId o) const { return value == o.value; }
};

/// A turn: a quaternion of length 1.
using Rotation = Eigen::Quaternion<double, Eigen::DontAlign>;

/// Where an emitter is. Its centre is that of the disc, the box, the parallelogram, or of the box around the
/// vertices of the mesh.
struct EmitterPose {
  /// The place of the centre [m].
  Vec3 position = Vec3::Zero();
  /// How the emitter is turned against what was given to add_emitter(), around the centre. Any length > 0.
  Rotation rotation = Rotation::Identity();
};

/// What an emitter does.
struct EmitterState {
  /// Whether no particle comes from it any more: its volume is filled, or its stop time is past.
  bool ended = false;
  /// World::set_emitter_enabled().
  bool enabled = true;
  /// Where it is, or moves to.
  EmitterPose pose = {};
  /// Of the particles relative to the emitter, without their own field of velocity [m/s].
  double speed = 0;
  /// Added to their velocity [m/s].
  Vec3 inherited_velocity = Vec3::Zero();
  /// World::set_emitter_max_age() [s].
  double max_age = std::numeric_limits<double>::infinity();
  /// How many have come from it.
  std::uint64_t particles = 0;
  /// Their volume at the rest density [m³].
  double volume = 0;
};

/// A vector at each point [m], for example a velocity [m/s] or a displacement [m].
using VectorField = std::function<Vec3(const Vec3&)>;

/// G (x − origin): shear, strain or rotation.
/// @param origin where the field is zero [m]
/// @param gradient G, row i the gradient of component i [1/s for a velocity]
VectorField linear_field(const Vec3& origin, const Eigen::Matrix3d& gradient);

/// A solid rotation: rate × axis × (x − origin).
/// @param origin a point of the axis [m]
/// @param axis its direction, of any length > 0
/// @param rate [rad/s for a velocity]
VectorField rotation_field(const Vec3& origin, const Vec3& axis, double rate);

/// The vortex of Taylor and Green that fills a rectangle with the edges u and v (F.69); beyond it lie
/// vortices of the opposite sense.
/// @param corner a corner of the rectangle [m]
/// @param edge_u the edge u from there [m], longer than 0
/// @param edge_v the edge v [m], longer than 0 and perpendicular to u
/// @param amplitude of the component along u, which is largest in the middle of the edges u
VectorField taylor_green_field(const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v, double amplitude);

/// A standing wave of small amplitude on water of constant depth (F.70).
struct StandingWave {
  /// A point of the bottom under a crest [m].
  Vec3 origin = Vec3::Zero();
  /// The direction in which the wave changes, of any length > 0.
  Vec3 along = Vec3(1, 0, 0);
  /// The direction from the bottom to the water, across `along`, of any length > 0.
  Vec3 up = Vec3(0, 1, 0);
  /// The length of the wave [m], > 0; twice that of a tank for its first mode.
  double wavelength = 1;
  /// The depth of the water [m], > 0.
  double depth = 1;
  /// The vertical component at a crest.
  double amplitude = 0;
};

/// The velocity of such a wave (amplitude in m/s), or the displacement that gives still water its shape (in
/// m).
VectorField standing_wave_field(const StandingWave& wave);

/// How the particles of a volume start. The fields are evaluated once for each particle when the emitter is
/// added, and are not kept.
struct InitialState {
  /// Is added to the emitter's velocity [m/s]; empty = 0. It is evaluated where the particle starts.
  VectorField velocity;
  /// Carries the particle along this field for a unit of time, from its point of the lattice [m]; empty: not
  /// at all. A field with divergence compresses the lattice, and such water bursts.
  VectorField displacement;
  /// Moves each coordinate by a random number between ± `shake` spacings, 0 … 0.25: for repeats of one run.
  double shake = 0;
  /// The seed of these numbers.
  std::uint64_t seed = 1;
};

/// A round nozzle. Particles start on a square lattice around the axis, as many as the flow needs (80 for
/// radius = 5 dx). Layers follow each other at a distance of one spacing or more that makes the mass flow ρ0
/// π r² v (F.37), (F.64).
struct DiscEmitter {
  /// The centre of the nozzle [m].
  Vec3 center = Vec3::Zero();
  /// The direction of the jet, of any length > 0.
  Vec3 direction = Vec3(0, -1, 0);
  /// The radius r of the nozzle [m], half a spacing to 1000 spacings of the fluid.
  double radius = 0.025;
  /// The speed v of the jet relative to the nozzle [m/s], ≥ 0.
  double speed = 1;
  /// The time of the first layer [s].
  double start = 0;
  /// No layer starts after this time [s].
  double stop = std::numeric_limits<double>::infinity();
  /// Moves each coordinate of a start by a random number between ± `shake` spacings, 0 … 0.25.
  double shake = 0;
  /// The seed of these numbers.
  std::uint64_t seed = 1;
};

/// Fills a box with the lattice once, centred, with as many layers as fit: a side of 6.7 spacings has 6. So a
/// box whose sides are no multiples of the spacing has less water than its volume. What would start
/// compressed, and burst, is left out and counted in StepReport::blocked_starts: points closer than 2 δ to a
/// surface; with BoundaryModel::mirrored also those closer than a fifth of a spacing, but for cloth that the
/// volume lies on one side of, which yields; and those closer than 0.9 spacings to other water, as of an
/// emitter that overlaps.
struct BoxEmitter {
  /// The box to fill [m].
  Box box;
  /// The velocity of all particles [m/s].
  Vec3 velocity = Vec3::Zero();
  /// When the box is filled [s].
  double start = 0;
  /// What differs from particle to particle.
  InitialState initial = {};
};

/// Fills the inside of a closed triangle mesh, by its winding number, with the lattice once. Points closer
/// than 2 δ to a surface are left out and counted.
struct MeshEmitter {
  /// The vertices of the mesh [m].
  std::vector<Vec3> vertices;
  /// The triangles of the mesh.
  std::vector<Triangle> triangles;
  /// The velocity of all particles [m/s].
  Vec3 velocity = Vec3::Zero();
  /// When the mesh is filled [s].
  double start = 0;
  /// What differs from particle to particle.
  InitialState initial = {};
};

/// Drops at random places of a parallelogram. A drop is a ball of lattice points.
struct RainEmitter {
  /// A corner of the parallelogram [m].
  Vec3 corner = Vec3::Zero();
  /// The first edge from there [m].
  Vec3 edge_u = Vec3(1, 0, 0);
  /// The second edge from there [m].
  Vec3 edge_v = Vec3(0, 0, 1);
  /// The rate over the whole parallelogram [1/s], > 0.
  double drops_per_second = 1000;
  /// The radius of a drop [m], 0 … 200 spacings of the fluid; below one spacing a drop is one particle.
  double drop_radius = 0;
  /// The velocity of all drops [m/s].
  Vec3 velocity = Vec3(0, -1, 0);
  /// The time of the first drop [s].
  double start = 0;
  /// No drop starts after this time [s].
  double stop = std::numeric_limits<double>::infinity();
  /// The seed of places and times.
  std::uint64_t seed = 1;
};

}  // namespace oilskin
