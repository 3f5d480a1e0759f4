/// A bit per node of a block, a word per slice.
#pragma once

#include "reconstruction/grid.h"

namespace oilskin::reconstruction {

using NodeBits = std::array<std::uint64_t, side>;

/// Six words of slice k: the bits of the nodes beside each node towards −x, +x, −y, +y, −z, +z. `around`: the
/// blocks there (neighbours_of()). `slice(block, k)` gives the bits of a slice; block may be `none`.
template <class Slice>
std::array<std::uint64_t, 6> bits_beside(std::uint32_t block, const std::array<std::uint32_t, 6>& around,
                                         int k, const Slice& slice) {
  constexpr std::uint64_t first_column = 0x0101010101010101, last_column = first_column << 7,
                          first_row = 0xff, last_row = first_row << 56;
  const std::uint64_t own = slice(block, k);
  return {(own << 1 & ~first_column) | (slice(around[0], k) >> 7 & first_column),
          (own >> 1 & ~last_column) | (slice(around[1], k) << 7 & last_column),
          (own << 8 & ~first_row) | (slice(around[2], k) >> 56 & first_row),
          (own >> 8 & ~last_row) | (slice(around[3], k) << 56 & last_row),
          k > 0 ? slice(block, k - 1) : slice(around[4], side - 1),
          k + 1 < side ? slice(block, k + 1) : slice(around[5], 0)};
}

}  // namespace oilskin::reconstruction
