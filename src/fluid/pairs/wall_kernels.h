/// The loops over particles and the triangles near them, in versions for the instruction sets of the machine:
/// part of PairKernels. All versions give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace oilskin::fluid {

/// Points nearer than this to a plane count as in it [H].
constexpr float in_plane = 1e-5f;

/// Eight edges of polygons in planes, in columns. Lengths in units of H, relative to the particle.
struct EdgeBlock {
  float from[3][8], to[3][8];
  float normal[3][8];  ///< of the plane: the polygon runs round it
  float distance[8];   ///< ζ > 0 of the plane
  float mass[8];       ///< Λ(ζ)
};

/// Eight triangles that may hide others, in columns: see VisibleParts.
struct OccluderBlock {
  float corner[3][3][8];          ///< [corner][axis]
  float normal[3][8], offset[8];  ///< of the plane; normal · corner = offset
  float side[3][3][8];            ///< [k][axis]: unit normals of the pyramid's faces, inwards
  float axis[3][8];               ///< of the cone around the pyramid
  float cosine[8], sine[8];       ///< of the cone's half angle
  float number[8];                ///< in the order in which they were added
};

/// What occluders may hide.
struct Occluded {
  float corner[3][3];  ///< [corner][axis]
  float side[3][3];    ///< [k][axis], as in OccluderBlock
  float axis[3], cosine, sine, number;
};

/// The corners of a triangle [m]: x, y, z of a, b and c.
struct Corners {
  double x[9];
};

/// Closest points of triangles, four to a block, in columns: see ClosestPoint.
struct ClosestBlock {
  double weight[3][4], offset[3][4], distance[4];  // [m]
  double height2[4];                               // squared, of the particle above the plane [m²]
};

/// Spheres around triangles, and their planes, in columns. In units of H, relative to a place near the
/// particle.
struct TriangleColumns {
  const float *x, *y, *z, *radius2;  ///< centres; the sphere with H added, squared
  const float *nx, *ny, *nz, *offset;
  const std::uint32_t* number;
  std::size_t count;  ///< the arrays are padded to a multiple of eight
};

}  // namespace oilskin::fluid
