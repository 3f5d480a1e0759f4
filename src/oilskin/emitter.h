/// Where particles come from.
#pragma once

#include "oilskin/types.h"

namespace oilskin {

/// A round nozzle. Centres on the square lattice through the axis within `radius` (81 for radius = 5 dx);
/// layers follow each other so that the mass flow is ρ π r² v.
struct DiscEmitter {
  Vec3 center = Vec3::Zero();                             ///< [m]
  Vec3 direction = Vec3(0, -1, 0);                        ///< any length > 0
  double radius = 0.025;                                  ///< [m], > 0
  double speed = 1;                                       ///< [m/s], > 0
  double start = 0;                                       ///< [s]
  double stop = std::numeric_limits<double>::infinity();  ///< [s]
};

/// Fills a box with the lattice once, at `start`. Points nearer than 2 δ to a surface are left out and
/// counted.
struct BoxEmitter {
  Box box;
  Vec3 velocity = Vec3::Zero();
  double start = 0;
};

/// Fills the inside of a closed triangle mesh (by winding number) with the lattice once, at `start`.
struct MeshEmitter {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  Vec3 velocity = Vec3::Zero();
  double start = 0;
};

/// Drops at random places of a rectangle: each a lattice ball of `drop_radius`, falling with `velocity`.
struct RainEmitter {
  Vec3 corner = Vec3::Zero(), edge_u = Vec3(1, 0, 0), edge_v = Vec3(0, 0, 1);  ///< [m]
  double drops_per_second = 1000;                                              ///< over the rectangle, > 0
  double drop_radius = 0;          ///< [m]; below one spacing a drop is one particle
  Vec3 velocity = Vec3(0, -1, 0);  ///< [m/s]
  double start = 0;
  double stop = std::numeric_limits<double>::infinity();
  std::uint64_t seed = 1;
};

}  // namespace oilskin
