#include "reconstruction/water_in_cubes.h"

#include <algorithm>
#include <cmath>

namespace oilskin::reconstruction {

namespace {

/// Cubes −1 … 2 of a block along each axis.
using WithRing = std::array<float, 64>;

/// The cubes that a particle overlaps along an axis: `first`, from −1 on, by `share`; the next one by the
/// rest.
struct Overlap {
  int first;
  float share;
  Overlap(float x, float half) {
    const float low = x - half;
    first = static_cast<int>(std::floor(low / cube_side));
    share = std::min(1.0f, (float(cube_side * (first + 1)) - low) / (2 * half));
  }
};

void add(const Overlap& x, const Overlap& y, const Overlap& z, float volume, WithRing& out) {
  for (int c = 0; c < 8; ++c) {
    const float part =
        (c & 1 ? 1 - x.share : x.share) * (c & 2 ? 1 - y.share : y.share) * (c & 4 ? 1 - z.share : z.share);
    // A particle at the end of its block by rounding may just touch a cube beyond the ring.
    const int i = std::min(x.first + 1 + (c & 1), 3), j = std::min(y.first + 1 + (c >> 1 & 1), 3),
              k = std::min(z.first + 1 + (c >> 2), 3);
    out[std::size_t(i + 4 * j + 16 * k)] += volume * part;
  }
}

/// The part of a block's cubes that the particles of its neighbour towards `d` fill.
void add_from_neighbour(const WithRing& from, const Int3& d, std::array<float, 8>& to) {
  for (int c = 0; c < 8; ++c) {
    const int i = (c & 1) - 2 * d.x, j = (c >> 1 & 1) - 2 * d.y, k = (c >> 2) - 2 * d.z;
    if (std::min({i, j, k}) < -1 || std::max({i, j, k}) > 2) continue;
    to[std::size_t(c)] += from[std::size_t((i + 1) + 4 * (j + 1) + 16 * (k + 1))];
  }
}

}  // namespace

Cubes water_in_cubes(const ParticleBlocks& particles, const Water& water, double spacing, const Grid& grid,
                     const CubeLattice& lattice, const Workers& workers, double least, bool of_nodes) {
  const auto half = static_cast<float>(std::min(spacing, double(cube_side)) / 2);
  const float up = of_nodes ? 0.5f : 0.0f;
  std::vector<WithRing> own(lattice.size(), WithRing{});
  workers.for_each(lattice.size(), 16, [&](std::size_t n) {
    const std::uint32_t b = particles.index.find(key_of(grid.blocks[lattice.block(n)].at));
    if (b == none) return;
    for (std::size_t p = particles.begin[b]; p < particles.begin[b + 1]; ++p)
      if (!water.is_drop(p))
        add({particles.x[p] + up, half}, {particles.y[p] + up, half}, {particles.z[p] + up, half},
            float(std::max(water.of(p), least)), own[n]);
  });
  Cubes result = lattice.zeros();
  workers.for_each(lattice.size(), 16, [&](std::size_t n) {
    const Int3 at = grid.blocks[lattice.block(n)].at;
    for (int o = 0; o < 27; ++o) {
      const Int3 d{o % 3 - 1, o / 3 % 3 - 1, o / 9 - 1};
      const std::uint32_t neighbour =
          d == Int3{} ? std::uint32_t(n) : lattice.place(grid.index.find(key_of(at + d)));
      if (neighbour != none) add_from_neighbour(own[neighbour], d, result[n]);
    }
  });
  return result;
}

}  // namespace oilskin::reconstruction
