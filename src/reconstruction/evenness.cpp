#include "reconstruction/evenness.h"

#include <algorithm>
#include <cmath>

#include "reconstruction/field.h"

namespace oilskin::reconstruction {

namespace {

/// So many particles of a block, at most, show its density, and so many how even it is, by their neighbours
/// within so far [dx].
constexpr std::size_t density_sample = 8, distance_sample = 32;
constexpr double farthest = 2;

/// Water whose densest particles have more than this density, relative to that at rest, is not sparse; with
/// less than the second all is drawn in that encloses too much.
constexpr float dense = 0.97f, sparse = 0.91f;

/// Particles at the surface have the mean of their neighbours farther away than this [dx]. So many others
/// show the density of a block.
constexpr float one_sided = 0.15f;
constexpr int several = 4;

/// Standard deviation over mean of these distances: 0.36 of random places, 0.2 of a lattice of which each
/// particle has moved by up to 0.3 dx along each axis.
constexpr float even_below = 0.22f, random_from = 0.28f;

/// Particles whose nearest neighbours are farther away than a spacing and this many cells are drawn apart
/// from each other; up to the first they cannot be.
constexpr float joined_below = 0.75f, apart_from = 1.25f;

/// For some particles of block b, calls f(g) with a function g that calls h(offset) for the offsets of the
/// others within reach of the block. `near`: memory.
template <class F>
void for_sample(const ParticleBlocks& particles, std::uint32_t b, std::size_t most, float reach,
                NearParticles& near, const F& f) {
  const std::vector<float> no_volumes;
  near.gather(particles, no_volumes, particles.blocks[b], 0, side, reach);
  const std::size_t begin = particles.begin[b], end = particles.begin[b + 1],
                    step = (end - begin + most - 1) / most;
  for (std::size_t p = begin; p < end; p += step)
    f([&](const auto& of_neighbour) {
      for (std::size_t c = 0; c < near.count; ++c)
        if (near.particle[c] != p)
          of_neighbour(Eigen::Vector3f(near.x[c] - particles.x[p], near.y[c] - particles.y[p],
                                       near.z[c] - particles.z[p]));
    });
}

/// Sums over particles of the distances [dx] from their nearest neighbours.
struct Distances {
  float count = 0, sum = 0, squares = 0;
};

Distances nearest_distances(const ParticleBlocks& particles, std::uint32_t b, float spacing,
                            NearParticles& near) {
  const float reach = float(farthest) * spacing;
  Distances result;
  for_sample(particles, b, distance_sample, reach, near, [&](const auto& for_neighbours) {
    float least = reach * reach;
    for_neighbours([&](const Eigen::Vector3f& x) { least = std::min(least, x.squaredNorm()); });
    const float distance = std::sqrt(least) / spacing;
    ++result.count;
    result.sum += distance;
    result.squares += distance * distance;
  });
  return result;
}

/// The mean of the two densest particles, with the kernel of (R.3); of those with neighbours on all sides if
/// there are several.
class Density {
 public:
  void add(float density, bool is_inside) {
    all_.add(density);
    if (is_inside) inside_.add(density);
  }
  bool is_inside() const { return inside_.count >= several; }
  float value() const { return is_inside() ? inside_.mean() : all_.mean(); }

 private:
  struct Densest {
    float first = 0, second = 0;
    int count = 0;

    void add(float density) {
      second = std::max(second, std::min(first, density));
      first = std::max(first, density);
      ++count;
    }
    float mean() const { return count > 1 ? (first + second) / 2 : first; }
  };
  Densest all_, inside_;
};

Density density_of(const ParticleBlocks& particles, std::uint32_t b, float spacing, NearParticles& near) {
  const float reach = float(farthest) * spacing;
  const float norm = kernel_norm(farthest);
  Density result;
  for_sample(particles, b, density_sample, reach, near, [&](const auto& for_neighbours) {
    float sum = 1;
    Eigen::Vector3f offset = Eigen::Vector3f::Zero();
    for_neighbours([&](const Eigen::Vector3f& x) {
      const float within = std::max(0.0f, 1 - x.squaredNorm() / (reach * reach)),
                  k = within * within * within;
      sum += k;
      offset += k * x;
    });
    result.add(norm * sum, offset.norm() < one_sided * spacing * sum);
  });
  return result;
}

/// Calls f(place) for the blocks around place n and itself.
template <class F>
void for_blocks_around(const Grid& grid, const CubeLattice& lattice, std::size_t n, const F& f) {
  const Int3& at = grid.blocks[lattice.block(n)].at;
  for (int o = 0; o < 27; ++o) {
    const std::uint32_t place =
        lattice.place(grid.index.find(key_of(at + Int3{o % 3 - 1, o / 3 % 3 - 1, o / 9 - 1})));
    if (place != none) f(place);
  }
}

/// Per place that is chosen: f(block of particles, place, memory).
template <class F>
void for_particles(const ParticleBlocks& particles, const Grid& grid, const CubeLattice& lattice,
                   const std::vector<std::uint8_t>& chosen, const Workers& workers, const F& f) {
  workers.for_chunks(lattice.size(), 8, [&](std::size_t from, std::size_t to, std::size_t) {
    NearParticles near;
    for (std::size_t n = from; n < to; ++n) {
      if (!chosen[n]) continue;
      const std::uint32_t b = particles.index.find(key_of(grid.blocks[lattice.block(n)].at));
      if (b != none) f(b, n, near);
    }
  });
}

/// How sparse each block is, between 0 and 1. Particles at the surface have fewer neighbours: where a block
/// has only such, those of the blocks around show the water.
std::vector<float> sparseness(const ParticleBlocks& particles, double spacing, const Grid& grid,
                              const CubeLattice& lattice, const std::vector<std::uint8_t>& chosen,
                              const Workers& workers) {
  std::vector<std::uint8_t> needed = chosen;
  for (std::size_t n = 0; n < chosen.size(); ++n)
    if (chosen[n]) for_blocks_around(grid, lattice, n, [&](std::uint32_t place) { needed[place] = 1; });
  std::vector<Density> density(lattice.size());
  for_particles(particles, grid, lattice, needed, workers,
                [&](std::uint32_t b, std::size_t n, NearParticles& near) {
                  density[n] = density_of(particles, b, float(spacing), near);
                });
  std::vector<float> result(lattice.size(), 0.0f);
  for (std::size_t n = 0; n < chosen.size(); ++n) {
    if (!chosen[n]) continue;
    float densest = density[n].value();
    if (!density[n].is_inside())
      for_blocks_around(grid, lattice, n,
                        [&](std::uint32_t place) { densest = std::max(densest, density[place].value()); });
    result[n] = ramp(densest, dense, sparse);
  }
  return result;
}

}  // namespace

Cubes evenness(const ParticleBlocks& particles, double spacing, const Cubes& excess, const Grid& grid,
               const CubeLattice& lattice, const Workers& workers) {
  Cubes result = lattice.zeros();
  std::vector<std::uint8_t> chosen(lattice.size(), 0);
  for (std::size_t n = 0; n < lattice.size(); ++n)
    chosen[n] = std::any_of(excess[n].begin(), excess[n].end(), [](float e) { return e > 0; });
  const std::vector<float> is_sparse = sparseness(particles, spacing, grid, lattice, chosen, workers);
  for (std::size_t n = 0; n < lattice.size(); ++n) chosen[n] = is_sparse[n] > 0;
  if (std::find(chosen.begin(), chosen.end(), 1) == chosen.end()) return result;
  Cubes sum = result, squares = result, count = result, sparse_count = result;
  for_particles(particles, grid, lattice, chosen, workers,
                [&](std::uint32_t b, std::size_t n, NearParticles& near) {
                  const Distances found = nearest_distances(particles, b, float(spacing), near);
                  count[n].fill(found.count);
                  sum[n].fill(found.sum);
                  squares[n].fill(found.squares);
                  sparse_count[n].fill(is_sparse[n] * found.count);
                });
  for (Cubes* values : {&count, &sum, &squares, &sparse_count}) lattice.smooth(*values, 2, workers);
  for (std::size_t n = 0; n < lattice.size(); ++n)
    for (std::size_t c = 0; c < 8; ++c) {
      const float all = count[n][c], mean = all > 0 ? sum[n][c] / all : 0;
      if (!(mean > 0)) continue;
      const float variance = std::max(0.0f, squares[n][c] / all - mean * mean);
      const float between = (mean - 1) * float(spacing);  // [cells]
      result[n][c] = excess[n][c] * sparse_count[n][c] / all *
                     (1 - ramp(std::sqrt(variance) / mean, even_below, random_from)) *
                     (1 - ramp(between, joined_below, apart_from));
    }
  return result;
}

}  // namespace oilskin::reconstruction
