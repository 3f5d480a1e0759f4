/// The particles sorted by block of the grid, as floats relative to their block. The unit of length is the
/// cell here and wherever the grid is spoken of: nodes have whole coordinates, and no scale is too small for
/// floats.
#pragma once

#include "core/parallel.h"
#include "reconstruction/grid.h"

namespace oilskin::reconstruction {

struct ParticleBlocks {
  std::vector<Int3> blocks;          ///< those with particles, ascending by key
  std::vector<std::uint32_t> begin;  ///< one more than blocks
  KeyMap index;
  /// By block, within a block in the order of the input.
  std::vector<float> x, y, z;         ///< from the block's origin [cells]
  std::vector<std::uint32_t> source;  ///< number in the input
  std::size_t skipped = 0;

  std::size_t size() const { return source.size(); }
  Box bounds() const;  ///< of the blocks [cells]
};

/// Particles that are not finite or lie farther out than 2²⁰ cells are skipped.
ParticleBlocks sort_into_blocks(Span<const Vec3> positions, double cell, const Workers& workers);

/// What one thread gathers around one block, relative to that block's origin. Padded with particles far away
/// to a multiple of 8.
struct NearParticles {
  std::vector<float> x, y, z, volume;
  std::vector<std::uint32_t> particle;  ///< number in ParticleBlocks
  std::size_t count = 0;                ///< without padding

  /// Those within `reach` of the box [low, high]³ of the block at `at`, in order of blocks. `volumes` may be
  /// empty: 1 each.
  void gather(const ParticleBlocks& particles, const std::vector<float>& volumes, const Int3& at, float low,
              float high, float reach);
  /// Of another gathering, those within `reach` of the cube of edge `edge` at `low`. Coordinates only.
  void select(const NearParticles& from, const std::array<float, 3>& low, float edge, float reach);

 private:
  void pad();
};

}  // namespace oilskin::reconstruction
