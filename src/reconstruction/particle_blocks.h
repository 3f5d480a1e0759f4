/// The particles sorted by block of the grid, as floats relative to their block. Lengths are in cells, as for
/// all data of the grid: nodes have integer coordinates, and floats suffice at any scale.
#pragma once

#include "core/parallel.h"
#include "oilskin/reconstruction.h"
#include "reconstruction/grid.h"

namespace oilskin::reconstruction {

struct ParticleBlocks {
  std::vector<Int3> blocks;          ///< those with particles, ascending by key
  std::vector<std::uint32_t> begin;  ///< first particle of each block, and the number of particles
  KeyMap index;                      ///< numbers of blocks by key
  // By block, within a block in the order of the input
  std::vector<float> x, y, z;         ///< relative to the block's origin [cells]
  std::vector<std::uint32_t> source;  ///< number in the input
  std::size_t skipped = 0;

  std::size_t size() const { return source.size(); }
  /// The place of particle i of block b [cells, from the world's origin].
  Vec3 place(std::size_t b, std::size_t i) const {
    return side * Vec3(blocks[b].x, blocks[b].y, blocks[b].z) + Vec3(x[i], y[i], z[i]);
  }
  Box bounds() const;  ///< of the blocks [cells]
};

/// Fills `out`. Skips particles of which position or velocity is not finite, or a coordinate is 2²⁰ cells or
/// more, and leaves out those with a volume of 0; without volumes all have water.
void sort_into_blocks(const ReconstructionInput& input, double cell, const Workers& workers,
                      ParticleBlocks& out);

/// Particles around one block, relative to its origin, padded with distant particles to a multiple of 8. The
/// vectors only grow: what lies behind the padding is left from earlier uses.
struct NearParticles {
  std::vector<float> x, y, z, volume;
  std::vector<std::uint32_t> particle;  ///< number in ParticleBlocks
  std::size_t count = 0;                ///< without padding

  std::size_t padded() const { return (count + 7) / 8 * 8; }

  /// Gathers the particles within `reach` of the box [low, high]³ of the block at `at`, in order of blocks.
  /// Empty `volumes` stand for volumes of 1.
  void gather(const ParticleBlocks& particles, const std::vector<float>& volumes, const Int3& at, float low,
              float high, float reach);
  /// Selects from `from` the particles within `reach`, on each axis, of the box from `low` to `high`.
  void select(const NearParticles& from, const std::array<float, 3>& low, const std::array<float, 3>& high,
              float reach);

 private:
  struct Limits {  // of coordinates
    std::array<float, 3> low, high;
  };
  void make_space(std::size_t more);
  void add_block(const ParticleBlocks& particles, const std::vector<float>& volumes, std::size_t block,
                 const Int3& step, const Limits& limits);
  void pad();
};

}  // namespace oilskin::reconstruction
