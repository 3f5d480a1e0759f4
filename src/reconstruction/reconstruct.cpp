// The stages in order: blocks, field, obstacles, mesh, vertex data.
#include <cmath>

#include "core/assert.h"
#include "core/refuse.h"
#include "core/stage_timer.h"
#include "reconstruction/blobs.h"
#include "reconstruction/drops.h"
#include "reconstruction/film.h"
#include "reconstruction/narrow_band.h"
#include "reconstruction/obstacle_distance.h"
#include "reconstruction/obstacle_field.h"
#include "reconstruction/pieces.h"
#include "reconstruction/smoothing.h"
#include "reconstruction/vertex_data.h"
#include "reconstruction/volume_fit.h"

namespace oilskin {

namespace {

using namespace reconstruction;  // NOLINT: the module of this file

Status validate_input(const ReconstructionInput& input) {
  const std::size_t n = input.positions.size();
  const auto wrong_count = [n](const std::string& name, std::size_t count) {
    return refuse(name, " has ", count, " values; there are ", n, " positions");
  };
  if (n >= 0xfffffff0u) return Status::refused("positions: more than 2^32 − 16");
  if (!input.velocities.empty() && input.velocities.size() != n)
    return wrong_count("velocities", input.velocities.size());
  if (!input.volumes.empty() && input.volumes.size() != n)
    return wrong_count("volumes", input.volumes.size());
  for (std::size_t i = 0; i < input.volumes.size(); ++i)
    if (!(input.volumes[i] >= 0 && std::isfinite(input.volumes[i])))
      return refuse("volume ", i, " is ", input.volumes[i], "; it must be finite and ≥ 0 m³");
  for (std::size_t a = 0; a < input.attributes.size(); ++a) {
    const ParticleAttribute& attribute = input.attributes[a];
    const std::string name = "attribute " + std::to_string(a);
    if (attribute.components < 1)
      return refuse(name, ": components is ", attribute.components, "; it must be ≥ 1");
    if (attribute.values.size() != n * std::size_t(attribute.components))
      return wrong_count(name + " of " + std::to_string(attribute.components) + " components",
                         attribute.values.size());
  }
  return validate_obstacles(input.obstacles);
}

/// Distance beyond the clip box [cells], negative inside it. The clipped field is the maximum of it and the
/// field.
float beyond(const Box& clip, const Vec3& x, double cell) {
  return static_cast<float>(std::max((clip.min - x).maxCoeff(), (x - clip.max).maxCoeff()) / cell);
}

/// The volume fit moves vertices outwards by this at most [dx], inwards by this part of the particles'
/// radius.
constexpr double max_outward = 0.6, max_inward = 0.9;

/// Pieces with less water than this are fitted one by one [dx³].
constexpr double small_piece = 300;

/// A particle is alone if it has this part of its volume without neighbours.
constexpr float alone_above = 0.98f;

/// Input, options and data of one run.
struct Reconstruction {
  Reconstruction(const ReconstructionInput& i, const ReconstructionOptions& o, ReconstructionReport& r)
      : input(i), options(o), report(r), workers(o.threads) {}

  const ReconstructionInput& input;
  const ReconstructionOptions& options;
  ReconstructionReport& report;
  Workers workers;
  double cell = options.cell * options.spacing;  ///< [m]
  FieldParameters field = field_parameters(options);
  ContactParameters contact = contact_parameters(options);
  Obstacles obstacles;  ///< near the water; none in mode `none`
  MemoryPlan memory{options.memory_limit};
  ParticleBlocks particles;
  std::vector<float> volumes;
  Water water;
  Film film;
  Grid grid;

  Status gather_obstacles();
  Status find_narrow_band();
  void find_films();
  void find_drops();
  void evaluate_field();
  void add_films(std::uint32_t b, FieldBlock& evaluator, const NearParticles& near,
                 const BlockVisibility& visibility, float* values) const;
  std::vector<std::uint8_t> blocks_at_values() const;
  std::vector<std::uint8_t> blocks_with_needed_volumes() const;
  void evaluate_block(std::uint32_t b, FieldBlock& evaluator, NearParticles& near,
                      BlockVisibility& visibility);
  RawMesh mesh_at_obstacles();
  bool keeps_gap() const { return contact.promises() && !obstacles.empty(); }
  std::vector<float> fit_to_water(const std::vector<std::array<float, 3>>& polygonised,
                                  const SurfaceBlocks& blocks, RawMesh& raw);
  void put_back_what_fails(const std::vector<std::array<float, 3>>& start, RawMesh& raw);
  void append_drops(WaterMesh& mesh);
  void release_field();
  void finish(RawMesh&& raw, WaterMesh* mesh);
};

Status Reconstruction::gather_obstacles() {
  if (!contact.uses_visibility()) return {};
  // Blocks that a particle reaches, one block more, and the reach of obstacles.
  const Box reached = particles.bounds().inflated(field.kernel_radius + 1 + 2 * side + contact.reach);
  const Box region{cell * reached.min, cell * reached.max};
  if (Status s = validate_resolution(input.obstacles, region, cell); !s.ok()) return s;
  obstacles = Obstacles(input.obstacles, region);
  return {};
}

Status Reconstruction::find_narrow_band() {
  std::size_t triangles = 0;
  for (const ObstacleMesh& o : input.obstacles) triangles += o.triangles.size();
  memory.add(28.0 * double(input.positions.size()) + 100.0 * double(triangles));
  if (!memory.fits()) return memory.refusal("sorting the particles");
  particles = sort_into_blocks(input.positions, cell, workers);
  report.particles_skipped = particles.skipped;
  if (Status s = gather_obstacles(); !s.ok()) return s;
  grid.cell = cell;
  grid.clearance = static_cast<float>(contact.clearance);
  grid.outside = field.outside();
  grid.inside = -field.particle_radius;
  if (Status s = find_blocks(particles, field, options.clip, grid, memory); !s.ok()) return s;
  find_near_triangles(obstacles, contact.reach, grid);
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
  obstacles.prepare_queries();
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
  if (mode != ObstacleMode::gap &&
      !evaluator.evaluate_films(near, visibility, film, FieldBlock::FilmPlace::on_obstacle,
                                on_obstacle.data()))
    return;
  if (mode != ObstacleMode::touch &&
      !evaluator.evaluate_films(near, visibility, film, FieldBlock::FilmPlace::at_particles,
                                at_particles.data()))
    return;
  const auto low = static_cast<float>(contact.clearance),
             high = static_cast<float>(contact.clearance + film.rule().grid_height);
  for (std::size_t n = 0; n < nodes; ++n) {
    const float d = obstacle.distance[n];
    if (!std::isfinite(d)) continue;
    const float wet = film_wetness(mode, obstacle, n);
    float layer = 0;
    if (wet > 0) layer += wet * std::max(on_obstacle[n], d - high);
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
    if (contact.mode == ObstacleMode::overlap) evaluator.evaluate(near, nullptr, all.data());
    if (!obstacle.distance.empty())
      for (std::size_t n = 0; n < nodes; ++n)
        values[n] =
            value_at_contact(contact, values[n], contact.mode == ObstacleMode::overlap ? all[n] : 0.0f,
                             obstacle.distance[n], obstacle.wetness.empty() ? 0.0f : obstacle.wetness[n]);
    add_films(b, evaluator, near, visibility, values);
  }
  if (options.clip)
    for (int n = 0; n < nodes; ++n) {
      const Vec3 x = origin + cell * Vec3(n & 7, n >> 3 & 7, n >> 6);
      values[n] = std::max(values[n], beyond(*options.clip, x, cell));
    }
  for (std::size_t k = 0; k < side; ++k) {
    std::uint64_t bits = 0;
    for (int n = 0; n < 64; ++n) bits |= std::uint64_t(values[64 * k + std::size_t(n)] < 0) << n;
    grid.inside_bits[block.field][k] = bits;
  }
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

void Reconstruction::evaluate_field() {
  find_films();
  const std::vector<std::uint8_t> measured = blocks_at_values();
  workers.for_each(grid.blocks.size(), 8, [&](std::size_t b) {
    const Block& block = grid.blocks[b];
    if (block.near == none || !measured[b]) return;
    NearBlock& near = grid.nears[block.near];
    measure_obstacles(obstacles, grid.origin(block), cell, contact.band, contact.promises(), near);
    if (contact.mode == ObstacleMode::wet)
      measure_wetness(obstacles, grid.origin(block), cell, contact.wet, near);
  });
  if (field.needs_volumes())
    volumes = particle_volumes(particles, field, blocks_with_needed_volumes(), workers);
  find_drops();
  workers.for_chunks(grid.blocks.size(), 8, [&](std::size_t from, std::size_t to, std::size_t) {
    FieldBlock evaluator(field);
    NearParticles near;
    BlockVisibility visibility;
    for (auto b = static_cast<std::uint32_t>(from); b < to; ++b)
      if (grid.blocks[b].field != none) evaluate_block(b, evaluator, near, visibility);
  });
}

/// Repairs until no triangle is too close and no piece of an obstacle is inside the water.
RawMesh Reconstruction::mesh_at_obstacles() {
  const bool with_nodes = options.min_blob > 0 || water.is_kept();
  if (!contact.promises() || obstacles.empty()) return polygonise(grid, with_nodes, workers);
  for (const NearBlock& near : grid.nears) report.cut_edges += near.cut_edges.size();
  report.nodes_cleared += clear_joined_edges(grid, workers);
  const auto pieces = obstacles.pieces();
  std::vector<std::uint32_t> only;
  Stopwatch watch;
  for (;;) {
    const RepairReport repaired = repair(obstacles, options.gap, grid, std::move(only), workers);
    report.repair_rounds += repaired.rounds;
    report.nodes_cleared += repaired.nodes;
    report.seconds.contact += watch.lap();
    RawMesh mesh = polygonise(grid, with_nodes, workers);
    std::vector<std::vector<NodeRef>> around;
    for (const auto& piece : pieces) {
      if (!is_submerged(obstacles, piece, grid, mesh, workers)) continue;
      ++report.components_freed;
      around.push_back(nodes_around(obstacles.vertex(piece[0]), grid));
      OILSKIN_ASSERT(!around.back().empty());
    }
    if (around.empty()) return mesh;
    std::vector<NodeRef> changed;
    for (const auto& part : around) changed.insert(changed.end(), part.begin(), part.end());
    report.nodes_cleared += set_outside(grid, around);
    only = blocks_around(grid, changed);
  }
}

/// Gives films their thickness and the mesh its volume. Returns the thickness per vertex [cells].
std::vector<float> Reconstruction::fit_to_water(const std::vector<std::array<float, 3>>& polygonised,
                                                const SurfaceBlocks& blocks, RawMesh& raw) {
  const std::vector<std::uint8_t> missing = far_from_water(particles, grid, workers);
  for (std::size_t p = 0; p < missing.size(); ++p)
    if (missing[p]) water.make_drop(p);
  const std::vector<std::array<float, 3>> start =
      keeps_gap() ? raw.positions : std::vector<std::array<float, 3>>();
  FilmVertices films =
      thin_films(film, contact.film_mode(), particles, grid, polygonised, options.clip, raw, workers);
  FitLimits limits;
  limits.cell = cell;
  limits.spacing = 1 / options.cell;
  limits.max_outward = max_outward / options.cell;
  limits.max_inward = max_inward * double(field.particle_radius + field.sparse_radius);
  limits.clearance = contact.clearance;
  limits.small_piece = small_piece / std::pow(options.cell, 3);
  limits.clip = options.clip;
  fit_volume(limits, particles, water, grid, polygonised, films, blocks, raw, workers);
  if (keeps_gap()) put_back_what_fails(start, raw);
  return std::move(films.thickness);
}

/// The mesh at `start` keeps the promise.
void Reconstruction::put_back_what_fails(const std::vector<std::array<float, 3>>& start, RawMesh& raw) {
  std::vector<std::uint32_t> moved;
  for (std::uint32_t t = 0; t < raw.triangles.size(); ++t)
    for (const std::uint32_t v : raw.triangles[t])
      if (std::isfinite(raw.distances[v]) && raw.positions[v] != start[v]) {
        moved.push_back(t);
        break;
      }
  report.vertices_held += put_back(obstacles, options.gap, &moved, start, raw, workers);
  report.vertices_held += put_back_around_enclosed(obstacles, grid, start, raw, workers);
}

void Reconstruction::append_drops(WaterMesh& mesh) {
  DropLimits limits;
  limits.cell = cell;
  limits.obstacles = keeps_gap() ? &obstacles : nullptr;
  limits.gap = options.gap;
  limits.clip = options.clip;
  limits.min_volume = options.min_blob * std::pow(options.spacing, 3);
  const DropReport made = add_drops(input, particles, water, film, limits, options.nearest, mesh);
  report.drops = made.drawn;
  report.drops_left_out = made.left_out;
}

/// The mesh needs the signs of nodes only.
void Reconstruction::release_field() {
  std::vector<float>().swap(grid.values);
  std::vector<float>().swap(volumes);
}

void Reconstruction::finish(RawMesh&& raw, WaterMesh* mesh) {
  if (keeps_gap() && options.smoothing_iterations > 0) obstacles.prepare_queries();
  const bool keeps = water.is_kept();
  const bool moves = keeps && (options.smoothing_iterations > 0 || !film.empty());
  const std::vector<std::array<float, 3>> polygonised =
      moves ? raw.positions : std::vector<std::array<float, 3>>();
  report.vertices_held = smooth(options.smoothing_iterations, keeps_gap() ? &obstacles : nullptr, options.gap,
                                cell, options.clip, raw, workers)
                             .held;
  WaterMesh result;
  const SurfaceBlocks blocks(grid, raw);
  if (keeps) result.thickness = fit_to_water(moves ? polygonised : raw.positions, blocks, raw);
  for (float& t : result.thickness) t *= static_cast<float>(cell);
  interpolate(input, particles, field, obstacles, contact.uses_visibility(), options.nearest, grid, raw,
              result, workers);
  result.normals = vertex_normals(raw, blocks, workers);
  result.positions = std::move(raw.positions);
  result.triangles = std::move(raw.triangles);
  if (keeps) append_drops(result);
  report.volume =
      workers.ordered_sum(result.triangles.size(), 1 << 12, 0.0, [&](std::size_t from, std::size_t to) {
        double sum = 0;
        for (std::size_t t = from; t < to; ++t)
          sum += six_volumes(result.positions, result.triangles[t], result.positions[0]) / 6;
        return sum;
      });
  *mesh = std::move(result);
}

}  // namespace

Status reconstruct_surface(const ReconstructionInput& input, const ReconstructionOptions& options,
                           WaterMesh* mesh, ReconstructionReport* report) {
  OILSKIN_ASSERT(mesh != nullptr);
  if (Status s = options.validate(); !s.ok()) return s;
  if (Status s = validate_input(input); !s.ok()) return s;
  ReconstructionReport local;
  Stopwatch watch;
  Reconstruction run(input, options, local);
  if (Status s = run.find_narrow_band(); !s.ok()) return s;
  local.seconds.blocks = watch.lap();
  run.evaluate_field();
  local.seconds.field = watch.lap();
  RawMesh raw = run.mesh_at_obstacles();
  if (options.min_blob > 0)
    local.blobs_removed = remove_blobs(run.grid, options.min_blob * std::pow(options.spacing, 3), raw);
  local.seconds.mesh = watch.lap() - local.seconds.contact;
  run.release_field();
  run.finish(std::move(raw), mesh);
  local.seconds.vertices = watch.lap();
  local.blocks = run.grid.inside_bits.size();
  local.bytes = run.memory.bytes();
  if (report) *report = local;
  return {};
}

}  // namespace oilskin
