/// Sums over the cubes of 4³ cells that divide the blocks of the grid, and their smoothing.
#pragma once

#include <algorithm>

#include "core/parallel.h"
#include "reconstruction/grid.h"

namespace oilskin::reconstruction {

/// Cells along an edge of a cube.
constexpr int cube_side = side / 2;

/// Cube of a block that contains cell or node (i, j, k): x + 2y + 4z.
inline std::size_t cube_of(int i, int j, int k) {
  return std::size_t(i >> 2 | j >> 2 << 1 | k >> 2 << 2);
}

/// From 0 at `from` to 1 at `to`.
inline float ramp(float x, float from, float to) {
  return std::clamp((x - from) / (to - from), 0.0f, 1.0f);
}

/// A value per cube, per block of the lattice.
using Cubes = std::vector<std::array<float, 8>>;

/// Per block of the grid those beside it: −x, +x, −y, …; none: there is none.
std::vector<std::array<std::uint32_t, 6>> neighbours_of(const Grid& grid);

/// The cubes that count for the surface: those of the blocks with surface and of three rings around them.
/// Deeper ones have little influence.
class CubeLattice {
 public:
  /// `has_surface` per block of the grid.
  CubeLattice(const Grid& grid, std::vector<std::uint8_t> has_surface);

  std::size_t size() const { return blocks_.size(); }
  Cubes zeros() const { return Cubes(size(), std::array<float, 8>{}); }
  /// The block of the grid at place n.
  std::uint32_t block(std::size_t n) const { return blocks_[n]; }
  /// The place of a block of the grid, or none.
  std::uint32_t place(std::uint32_t block) const { return block == none ? none : place_of_[block]; }

  /// Means with the weights ¼, ½, ¼ along each axis, `passes` times; an even number. 0 beyond the lattice.
  void smooth(Cubes& values, int passes, const Workers& workers) const;

  /// Values around a block, for interpolation.
  class Around {
   public:
    Around(const CubeLattice& lattice, const Cubes& values, std::uint32_t block);
    /// Linear between the centres of cubes; x relative to the block [cells], at most two cells outside it.
    double at(const Vec3& x) const;
    /// As at(), of values per cube of nodes: those of 4³ nodes are half a cell lower than those of 4³ cells.
    double at_node(int node) const;
    bool is_zero() const;

   private:
    std::array<float, 64> values_;  // cubes −1 … 2 along each axis
  };

 private:
  void smooth_twice(const Cubes& from, std::size_t axis, Cubes& to, const Workers& workers) const;

  const Grid& grid_;
  std::vector<std::uint32_t> blocks_, place_of_;
  std::vector<std::array<std::uint32_t, 6>> neighbours_;  // places: −x, +x, −y, …
};

}  // namespace oilskin::reconstruction
