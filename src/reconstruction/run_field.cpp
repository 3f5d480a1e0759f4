// The stages up to the field: blocks, obstacles, films, values of nodes.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/assert.h"
#include "reconstruction/drops.h"
#include "reconstruction/obstacle_distance.h"
#include "reconstruction/run.h"
#include "reconstruction/sparse_water.h"

namespace oilskin::reconstruction {

namespace {

/// Distance beyond the clip box [cells], negative inside it.
float beyond(const Box& clip, const Vec3& x, double cell) {
  return static_cast<float>(std::max((clip.min - x).maxCoeff(), (x - clip.max).maxCoeff()) / cell);
}

/// Nodes that only the clip box makes outside have values this small, per cell beyond it: the surface on an
/// edge from inside is then as far as the side of the box, which vertices do not pass (`fraction_in_clip`).
constexpr float per_cell_beyond = 1e-3f;

/// A particle is alone if it has this part of its volume without neighbours.
constexpr float alone_above = 0.98f;

/// Obstacles so far beyond the region are kept, too, for runs to come [cells].
constexpr double kept_margin = 64;

}  // namespace

Status Reconstruction::gather_obstacles() {
  if (!contact.uses_visibility()) {
    obstacles.clear();
    space.memory.forget();
    return {};
  }
  // Blocks that a particle reaches, one block more, and the reach of obstacles; or the largest drop.
  double reach = field.kernel_radius + 1 + 2 * side + contact.reach;
  if (keeps_volume(options) && !input.volumes.empty())
    reach += reach_of_drop(*std::max_element(input.volumes.begin(), input.volumes.end())) / cell;
  const Box reached = particles.bounds().inflated(reach);
  obstacle_region = {cell * reached.min, cell * reached.max};
  if (Status s = validate_resolution(input.obstacles, obstacle_region, cell); !s.ok()) return s;
  const Box larger = obstacle_region.inflated(space.is_for_one_run ? 0 : kept_margin * cell);
  if (!obstacles.set(input.obstacles, obstacle_region, larger)) return {};
  space.memory.forget();
  return {};
}

Status Reconstruction::find_narrow_band() {
  std::size_t triangles = 0;
  for (const ObstacleMesh& o : input.obstacles) triangles += o.triangles.size();
  memory.add(28.0 * double(input.positions.size()) + 100.0 * double(triangles));
  if (!memory.fits()) return memory.refusal("sorting the particles");
  sort_into_blocks(input, cell, workers, particles);
  report.particles_skipped = particles.skipped;
  if (Status s = gather_obstacles(); !s.ok()) return s;
  space.memory.keep({cell, contact.band, contact.reach, contact.promises(), contact.mode, contact.wet}, grid);
  grid.cell = cell;
  grid.clearance = static_cast<float>(contact.clearance);
  grid.outside = field.outside();
  grid.inside = -field.particle_radius;
  grid.clip = options.clip;
  if (Status s = find_blocks(particles, field, options.clip, grid, memory); !s.ok()) return s;
  find_near_triangles(obstacles, contact.reach, space.memory, grid);
  const std::size_t near_bytes = nodes * sizeof(float) * (contact.mode == ObstacleMode::wet ? 2 : 1);
  for (const NearBlock& near : grid.nears)
    memory.add(double(sizeof(NearBlock) + near_bytes + 4 * near.triangles.size()));
  return choose_fields(particles, field, options.clip, grid, memory, workers);
}

/// The water of each particle, and films.
void Reconstruction::find_films() {
  if (!keeps_volume(options)) return;
  water = Water(input, options, particles);
  if (!keeps_gap()) return;
  obstacles.prepare_queries(workers);
  obstacles.prepare_normals(workers);
  film = Film(film_rule(options, contact.clearance), particles, water, obstacles, cell, workers);
}

/// Particles without neighbours are drops, but those that lie on obstacles are films. Neither count in the
/// field.
void Reconstruction::find_drops() {
  if (!water.is_kept()) return;
  const bool knows_drops = !volumes.empty();
  if (!knows_drops && !film.empty()) volumes.assign(particles.size(), 1.0f);
  const float alone = alone_above / field.kernel_norm;
  for (std::uint32_t p = 0; p < volumes.size(); ++p) {
    const FilmParticle* const near = film.find(p);
    if (near && near->radius > 0) {
      volumes[p] *= 1 - near->thin;
    } else if (knows_drops && volumes[p] > alone) {
      water.make_drop(p);
      volumes[p] = 0;
    }
  }
}

/// Adds the films of the grid: on wet obstacles from the clearance on, on dry ones where the particles are.
void Reconstruction::add_films(std::uint32_t b, FieldBlock& evaluator, const NearParticles& near,
                               const BlockVisibility& visibility, float* values) const {
  const NearBlock& obstacle = grid.nears[grid.blocks[b].near];
  if (film.empty() || obstacle.distance.empty()) return;
  std::array<float, nodes> on_obstacle, at_particles;
  const ObstacleMode mode = contact.film_mode();
  const float* const distances = obstacle.distance.data();
  if (mode != ObstacleMode::gap &&
      !evaluator.evaluate_films(near, visibility, film, distances, FieldBlock::FilmPlace::on_obstacle,
                                on_obstacle.data()))
    return;
  if (mode != ObstacleMode::touch &&
      !evaluator.evaluate_films(near, visibility, film, distances, FieldBlock::FilmPlace::at_particles,
                                at_particles.data()))
    return;
  const auto low = static_cast<float>(contact.clearance);
  for (std::size_t n = 0; n < nodes; ++n) {
    const float d = obstacle.distance[n];
    if (!std::isfinite(d)) continue;
    const float wet = film_wetness(mode, obstacle, n);
    float layer = 0;
    if (wet > 0) layer += wet * on_obstacle[n];
    if (wet < 1) layer += (1 - wet) * at_particles[n];
    if (layer < values[n]) values[n] = std::max(layer, low - d);
  }
}

/// Values of a block, changed by obstacles and the clip box.
void Reconstruction::evaluate_block(std::uint32_t b, FieldBlock& evaluator, NearParticles& near,
                                    BlockVisibility& visibility) {
  const Block& block = grid.blocks[b];
  OILSKIN_ASSERT(block.field != none);
  float* const values = &grid.values[std::size_t(block.field) * nodes];
  const Vec3 origin = grid.origin(block);
  near.gather(particles, volumes, block.at, 0, side - 1, field.kernel_radius);
  if (block.near == none) {
    evaluator.evaluate(near, nullptr, values);
  } else {
    const NearBlock& obstacle = grid.nears[block.near];
    visibility.set(obstacles, obstacle.triangles, origin, cell, field.kernel_radius);
    evaluator.evaluate(near, &visibility, values);
    std::array<float, nodes> all;
    if (contact.mode == ObstacleMode::overlap) {
      evaluator.evaluate(near, nullptr, all.data());
      // Where no particle is in reach, there is no water to pass through an obstacle.
      for (float& value : all)
        if (value >= field.outside()) value = std::numeric_limits<float>::infinity();
    }
    if (!obstacle.distance.empty())
      for (std::size_t n = 0; n < nodes; ++n)
        values[n] =
            value_at_contact(contact, values[n], contact.mode == ObstacleMode::overlap ? all[n] : 0.0f,
                             obstacle.distance[n], obstacle.wetness.empty() ? 0.0f : obstacle.wetness[n]);
    add_films(b, evaluator, near, visibility, values);
  }
  if (options.clip)
    for (int n = 0; n < nodes; ++n) {
      const Vec3 x = grid.place({b, n});
      if (const float b = beyond(*options.clip, x, cell); b >= 0)
        values[n] = std::max(values[n], per_cell_beyond * b);
    }
  grid.find_inside(block.field);
}

/// Blocks with values, and those that share edges with them.
std::vector<std::uint8_t> Reconstruction::blocks_at_values() const {
  std::vector<std::uint8_t> result(grid.blocks.size(), 0);
  for (std::size_t b = 0; b < grid.blocks.size(); ++b)
    for (const std::uint32_t o : grid.blocks[b].plus) {
      if (o == none || (grid.blocks[b].field == none && grid.blocks[o].field == none)) continue;
      result[b] = result[o] = 1;
    }
  return result;
}

/// Blocks of particles that reach a block with values.
std::vector<std::uint8_t> Reconstruction::blocks_with_needed_volumes() const {
  std::vector<std::uint8_t> needed(particles.blocks.size(), 0);
  const int ring = static_cast<int>(std::ceil(field.kernel_radius / side));
  workers.for_each(particles.blocks.size(), 64, [&](std::size_t p) {
    for (int z = -ring; z <= ring; ++z)
      for (int y = -ring; y <= ring; ++y)
        for (int x = -ring; x <= ring; ++x) {
          const std::uint32_t b = grid.index.find(key_of(particles.blocks[p] + Int3{x, y, z}));
          if (b != none && grid.blocks[b].field != none) needed[p] = 1;
        }
  });
  return needed;
}

/// Distances from obstacles, if they are not known from the last run.
void Reconstruction::measure_blocks() {
  const std::vector<std::uint8_t> needed = blocks_at_values();
  workers.for_each(grid.blocks.size(), 8, [&](std::size_t b) {
    const Block& block = grid.blocks[b];
    if (block.near == none) return;
    NearBlock& near = grid.nears[block.near];
    if (!needed[b]) near.forget_measures();
    if (!needed[b] || near.is_measured) return;
    measure_obstacles(obstacles, grid.origin(block), cell, contact.band, contact.promises(), near);
    if (contact.mode == ObstacleMode::wet)
      measure_wetness(obstacles, grid.origin(block), cell, contact.wet, near);
    near.is_measured = true;
  });
  space.memory.learn();
}

void Reconstruction::evaluate_field() {
  find_films();
  measure_blocks();
  if (field.needs_volumes())
    particle_volumes(particles, field, blocks_with_needed_volumes(), workers, volumes);
  else
    volumes.clear();
  find_drops();
  workers.for_chunks(grid.blocks.size(), 8, [&](std::size_t from, std::size_t to, std::size_t) {
    FieldBlock evaluator(field);
    NearParticles near;
    BlockVisibility visibility;
    for (auto b = static_cast<std::uint32_t>(from); b < to; ++b)
      if (grid.blocks[b].field != none) evaluate_block(b, evaluator, near, visibility);
  });
  if (!water.is_kept()) return;
  drawn_in = open_sparse_water(particles, water, field, 1 / options.cell, contact.band, workers, grid);
  fill_single_nodes(workers, grid);
}

}  // namespace oilskin::reconstruction
