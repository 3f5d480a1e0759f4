/// Sums over the cubes of 4³ cells that divide the blocks of the grid, and their smoothing.
#pragma once

#include "core/parallel.h"
#include "reconstruction/grid.h"

namespace oilskin::reconstruction {

/// Cells along an edge of a cube.
constexpr int cube_side = side / 2;

/// Cube of a block that contains cell or node (i, j, k): x + 2y + 4z.
inline std::size_t cube_of(int i, int j, int k) {
  return std::size_t(i >> 2 | j >> 2 << 1 | k >> 2 << 2);
}

/// A value per cube, per block.
using Cubes = std::vector<std::array<float, 8>>;

class CubeLattice {
 public:
  explicit CubeLattice(const Grid& grid);

  Cubes zeros() const { return Cubes(grid_.blocks.size(), std::array<float, 8>{}); }

  /// The number of the cube at x [cells, from the world's origin], 8 block + cube; none outside the grid.
  std::uint32_t cube_at(const Vec3& x) const;

  /// Means with the weights ¼, ½, ¼ along each axis, `passes` times. 0 beyond the grid.
  Cubes smoothed(Cubes values, int passes, const Workers& workers) const;

  /// Values around a block, for interpolation.
  class Around {
   public:
    Around(const CubeLattice& lattice, const Cubes& values, std::uint32_t block);
    /// Linear between the centres of cubes; x relative to the block [cells], at most two cells outside it.
    double at(const Vec3& x) const;

   private:
    std::array<float, 64> values_;  // cubes −1 … 2 along each axis
  };

 private:
  float next(const Cubes& values, std::size_t b, std::size_t cube, int axis, bool up) const;

  const Grid& grid_;
  std::vector<std::array<std::uint32_t, 6>> neighbours_;  // −x, +x, −y, …
};

}  // namespace oilskin::reconstruction
