/// Sparse water in which the particles lie evenly: of a jet that falls, or a sheet that is drawn out. Real
/// water gets narrower there; particles move apart along the motion and keep their places beside each other.
#pragma once

#include "reconstruction/node_bits.h"
#include "reconstruction/node_blur.h"
#include "reconstruction/particle_blocks.h"

namespace oilskin::reconstruction {

/// What has been drawn in.
struct DrawnIn {
  Cubes even;  ///< per block of the grid: the share of the water that has its volume there; empty: none
  std::vector<std::array<float, 3>> moves;  ///< per particle [cells]: to where its water is; empty: none

  Vec3 move(std::size_t particle) const { return moves.empty() ? Vec3::Zero() : vec(moves[particle]); }
};

/// 1: the surface may move there, 0: the node is nearer to an obstacle than band − 1 [cells], where films
/// are.
inline float free_to_move(const Grid& grid, const NodeRef& node, double band) {
  return ramp(grid.distance(node), float(band - 1), float(band));
}

/// Even water next to each other is a piece.
class EvenWater {
 public:
  /// Looks at the particles of the lattice's blocks. `in_cubes`: the water. `spacing` and `band` in cells:
  /// water nearer to obstacles than band − 1 does not count.
  EvenWater(const ParticleBlocks& particles, const Cubes& in_cubes, double spacing, double band,
            const Grid& grid, const CubeLattice& lattice, const Workers& workers);

  /// Per block of the grid, of which there are `count`: 1 if it has such water.
  std::vector<std::uint8_t> blocks(std::size_t count) const;

  /// Draws the surface in by what it encloses beyond the water (R.42), and the particles outside with it.
  DrawnIn draw_in(Grid& grid);

  /// Changes the water in cubes to what they are to enclose: where water has been drawn in from outside, what
  /// lacks in its midst is that of others, unless its whole piece encloses too much.
  /// `enclosed` and `in_cubes` are of that lattice.
  void share_out(const Cubes& enclosed, const CubeLattice& lattice, const Grid& grid, Cubes& in_cubes) const;

 private:
  struct Choice {
    std::vector<NodeBits> leave, stay;  // per place
  };
  bool is_even(std::size_t place) const;
  void find_free_cubes(const Cubes& in_cubes, const Grid& grid);
  NodeValues shares_around(const Grid& grid) const;
  void leave_thin_water(const NodeValues& around, const Grid& grid);
  void find_pieces(const Grid& grid);
  /// Per piece, for each of `bins` numbers, the nodes inside that f(place, block)(node) maps to it, weighted
  /// by their evenness.
  template <std::size_t bins, class F>
  std::vector<std::array<double, bins>> sums_of_pieces(const Grid& grid, const F& f) const;
  std::vector<double> enclosed_by_pieces(const Grid& grid) const;
  std::vector<float> shares_of_pieces(const NodeValues& around, const Cubes& least, const Grid& grid) const;
  template <class F>
  void for_free_nodes(const Cubes& least, const Grid& grid, const F& f) const;
  template <class F>
  void for_words(const F& f) const {
    for (std::size_t n = 0; n < lattice_.size(); ++n)
      for (std::size_t k = 0; k < side; ++k) f(n, k);
  }
  Choice choose_nodes(const NodeValues& around, const Cubes& least, const Grid& grid) const;
  void leave_out_nodes(const NodeValues& around, const Cubes& least, const Choice& choice, Grid& grid) const;
  void grow(const std::vector<NodeBits>& region, const Grid& grid, std::vector<NodeBits>& grown) const;
  void move_particles(const NodeValues& around, const std::vector<NodeBits>& left_out, const Grid& grid,
                      std::vector<std::array<float, 3>>& moves) const;

  const ParticleBlocks& particles_;
  const CubeLattice& lattice_;
  const Workers& workers_;
  double spacing_, band_;
  Cubes even_;  // per cube: evenness() where it encloses more than its water
  std::vector<std::array<std::uint8_t, 8>> is_free_;  // per cube: no obstacle is near
  Cubes water_in_cubes_, enclosed_;                   // of free cubes [cells³]
  NodeValues may_move_;               // per node: how far the surface may be drawn in, 0 … 1
  std::vector<std::uint32_t> piece_;  // per place; none: there is no even water
  std::vector<double> water_;         // per piece [cells³]
  std::size_t pieces_ = 0;
};

}  // namespace oilskin::reconstruction
