#include "reconstruction/sparse_water.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "reconstruction/node_bits.h"
#include "reconstruction/water_in_cubes.h"

namespace oilskin::reconstruction {

namespace {

/// Levels below the surface at which the enclosed volume is counted, from 0 to the radius of a particle.
constexpr std::size_t levels = 10;

/// The share of space that must be enclosed: less is no cloud but a thread or a sheet, for which the grid
/// needs the whole radius. From `filled` on nothing is kept back.
constexpr float partly_filled = 0.5f, filled = 0.65f;

/// The share of the enclosed volume that must be without water. The fit after the mesh makes up for less.
constexpr float some_air = 0.12f, much_air = 0.25f;

/// Blocks with less of their space enclosed, or with less of that without water, are not looked at.
constexpr double hardly_filled = 0.25, hardly_any_air = 0.07;

/// Volumes per cube that the levels enclose [cells³]: nodes.
using Enclosed = std::array<Cubes, levels>;

Enclosed count_enclosed(const Grid& grid, const CubeLattice& lattice, float radius, const Workers& workers) {
  Enclosed result;
  for (Cubes& at_level : result) at_level = lattice.zeros();
  workers.for_each(lattice.size(), 16, [&](std::size_t n) {
    const Block& block = grid.blocks[lattice.block(n)];
    if (block.field == none) {
      if (!block.solid) return;
      for (Cubes& at_level : result) at_level[n].fill(float(cube_side * cube_side * cube_side));
      return;
    }
    const float* const values = &grid.values[std::size_t(block.field) * nodes];
    for (int node = 0; node < nodes; ++node) {
      if (!(values[node] < 0)) continue;
      const std::size_t cube = cube_of(node & 7, node >> 3 & 7, node >> 6);
      const float depth = -values[node] * float(levels) / radius;
      const auto deepest = std::min(std::size_t(depth), levels - 1);
      for (std::size_t level = 0; level <= deepest; ++level) ++result[level][n][cube];
    }
  });
  return result;
}

/// The level at which `enclosed` decreases to the water, as a fraction of the radius.
float level_of(const std::array<float, levels>& enclosed, float water) {
  for (std::size_t level = 1; level < levels; ++level)
    if (enclosed[level] < water) {
      const float above = enclosed[level - 1], below = enclosed[level];
      return (float(level - 1) + (above - water) / std::max(above - below, 1e-6f)) / float(levels);
    }
  return float(levels - 1) / float(levels);
}

/// Blocks that enclose less water than space.
std::vector<std::uint8_t> sparse_blocks(const ParticleBlocks& particles, const Water& water, double least,
                                        const Grid& grid, const Workers& workers) {
  std::vector<std::uint8_t> result(grid.blocks.size(), 0);
  workers.for_each(grid.blocks.size(), 64, [&](std::size_t b) {
    const Block& block = grid.blocks[b];
    if (block.field == none) return;
    const float* const values = &grid.values[std::size_t(block.field) * nodes];
    const auto enclosed = double(std::count_if(values, values + nodes, [](float v) { return v < 0; }));
    if (enclosed < hardly_filled * nodes) return;
    double own = 0;
    if (const std::uint32_t p = particles.index.find(key_of(block.at)); p != none)
      for (std::size_t i = particles.begin[p]; i < particles.begin[p + 1]; ++i)
        if (!water.is_drop(i)) own += std::max(water.of(i), least);
    result[b] = own < (1 - hardly_any_air) * enclosed;
  });
  return result;
}

}  // namespace

DrawnIn open_sparse_water(const ParticleBlocks& particles, const Water& water, const FieldParameters& field,
                          double spacing, double band, const Workers& workers, Grid& grid) {
  DrawnIn drawn_in;
  // Water at rest whose particles are given less volume stays whole.
  const double least = spacing * spacing * spacing;
  const std::vector<std::uint8_t> sparse = sparse_blocks(particles, water, least, grid, workers);
  if (std::find(sparse.begin(), sparse.end(), 1) == sparse.end()) return drawn_in;
  const float radius = field.particle_radius + field.sparse_radius;
  const CubeLattice lattice(grid, sparse);
  Cubes in_cubes = water_in_cubes(particles, water, spacing, grid, lattice, workers, least, true);
  const EvenWater found(particles, in_cubes, spacing, band, grid, lattice, workers);
  const std::vector<std::uint8_t> even_blocks = found.blocks(grid.blocks.size());
  std::optional<CubeLattice> near_even;
  std::optional<EvenWater> even;
  if (std::find(even_blocks.begin(), even_blocks.end(), 1) != even_blocks.end()) {
    // A smaller lattice: drawing in takes much longer than finding such water.
    near_even.emplace(grid, even_blocks);
    even.emplace(particles, water_in_cubes(particles, water, spacing, grid, *near_even, workers, least, true),
                 spacing, band, grid, *near_even, workers);
    drawn_in = even->draw_in(grid);
  }
  lattice.smooth(in_cubes, 2, workers);
  Enclosed enclosed = count_enclosed(grid, lattice, radius, workers);
  for (Cubes& at_level : enclosed) lattice.smooth(at_level, 2, workers);
  if (even) even->share_out(enclosed[0], lattice, grid, in_cubes);
  Cubes raised = lattice.zeros();
  workers.for_each(lattice.size(), 64, [&](std::size_t n) {
    for (std::size_t c = 0; c < 8; ++c) {
      std::array<float, levels> at;
      for (std::size_t level = 0; level < levels; ++level) at[level] = enclosed[level][n][c];
      const float share = at[0] / float(cube_side * cube_side * cube_side);
      const float weight = ramp(share, partly_filled, filled) *
                           (at[0] > 0 ? ramp(1 - in_cubes[n][c] / at[0], some_air, much_air) : 0);
      if (weight > 0) raised[n][c] = weight * radius * level_of(at, in_cubes[n][c]);
    }
  });
  workers.for_each(lattice.size(), 16, [&](std::size_t n) {
    const std::uint32_t b = lattice.block(n);
    const Block& block = grid.blocks[b];
    if (block.field == none) return;
    const CubeLattice::Around around(lattice, raised, b);
    if (around.is_zero()) return;
    float* const values = &grid.values[std::size_t(block.field) * nodes];
    for (int node = 0; node < nodes; ++node) {
      const float weight = free_to_move(grid, {b, node}, band);
      if (weight > 0) values[node] += weight * float(around.at_node(node));
    }
    grid.find_inside(block.field);
  });
  return drawn_in;
}

void fill_single_nodes(const Workers& workers, Grid& grid) {
  const std::vector<std::array<std::uint32_t, 6>> neighbours = neighbours_of(grid);
  std::vector<NodeBits> filled(grid.blocks.size());
  const auto slice = [&](std::uint32_t block, int k) { return grid.slice(block, k); };
  workers.for_each(grid.blocks.size(), 16, [&](std::size_t b) {
    filled[b] = {};
    if (grid.blocks[b].field == none) return;
    const auto own = static_cast<std::uint32_t>(b);
    for (int k = 0; k < side; ++k) {
      std::uint64_t around = ~grid.slice(own, k);
      for (const std::uint64_t beside : bits_beside(own, neighbours[b], k, slice)) around &= beside;
      filled[b][std::size_t(k)] = around;
    }
  });
  // Only now: neighbours read the bits.
  workers.for_each(grid.blocks.size(), 16, [&](std::size_t b) {
    for (int k = 0; k < side; ++k)
      for (std::uint64_t bits = filled[b][std::size_t(k)]; bits != 0; bits &= bits - 1) {
        const NodeRef node{std::uint32_t(b), 64 * k + __builtin_ctzll(bits)};
        if (!std::isfinite(grid.distance(node))) grid.set_inside(node);
      }
  });
}

}  // namespace oilskin::reconstruction
