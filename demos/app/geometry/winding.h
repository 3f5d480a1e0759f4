/// Which points of a regular grid lie inside a closed triangle mesh.
#pragma once

#include "oilskin/types.h"

namespace oilskin::demo {

/// Winding numbers by rays along x. They count orientation, so that a cavity is outside and a drop in a
/// cavity is inside, and self-intersections leave no gap. Rays are tested in integer arithmetic: one that
/// passes through an edge or a vertex counts it once.
class Winding {
 public:
  using Float3 = std::array<float, 3>;

  /// Grid points are the multiples of `cell` [m] > 0; vertices lie within 2²⁰ cells of the origin. The mesh
  /// is closed and oriented outwards.
  Winding(Span<const Float3> positions, Span<const Triangle> triangles, double cell);

  /// At the grid point (i, j, k): 1 inside, 0 outside; others only where the mesh intersects itself. Exact
  /// for points farther from the mesh than `resolution` cells.
  int at(int i, int j, int k) const;

  /// Vertices are rounded to this fraction of a cell across the rays.
  static constexpr double resolution = 1.0 / 4096;

 private:
  struct Crossing {
    std::int32_t k, j;
    double x;    ///< [cells]
    int enters;  /// 1 into the mesh, −1 out of it
  };
  void add(const std::array<Float3, 3>& corner, double cell);

  std::vector<Crossing> crossings_;  ///< sorted by row, then by x
};

}  // namespace oilskin::demo
