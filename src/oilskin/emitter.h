/// @file
/// Sources of particles.
#pragma once

#include "oilskin/types.h"

namespace oilskin {

/// A round nozzle. Particles start on a square lattice around the axis, as many as the flow needs (80 for
/// radius = 5 dx). Layers follow each other at a distance of one spacing or more that makes the mass flow ρ0
/// π r² v (F.37), (F.73).
struct DiscEmitter {
  /// The centre of the nozzle [m].
  Vec3 center = Vec3::Zero();
  /// The direction of the jet, of any length > 0.
  Vec3 direction = Vec3(0, -1, 0);
  /// The radius r of the nozzle [m], half a spacing to 10⁴ spacings of the fluid.
  double radius = 0.025;
  /// The speed v of the jet [m/s], > 0.
  double speed = 1;
  /// The time of the first layer [s].
  double start = 0;
  /// No layer starts after this time [s].
  double stop = std::numeric_limits<double>::infinity();
};

/// Fills a box with the lattice once. Points closer than 2 δ to a surface are left out and counted.
struct BoxEmitter {
  /// The box to fill [m].
  Box box;
  /// The velocity of all particles [m/s].
  Vec3 velocity = Vec3::Zero();
  /// When the box is filled [s].
  double start = 0;
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
  /// The radius of a drop [m]; below one spacing a drop is one particle.
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
