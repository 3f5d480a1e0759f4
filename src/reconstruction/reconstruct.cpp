// The stages in order: blocks, field, obstacles, mesh, vertex data.
#include <cmath>

#include "core/assert.h"
#include "core/refuse.h"
#include "core/stage_timer.h"
#include "reconstruction/blobs.h"
#include "reconstruction/narrow_band.h"
#include "reconstruction/obstacle_distance.h"
#include "reconstruction/obstacle_field.h"
#include "reconstruction/smoothing.h"
#include "reconstruction/vertex_data.h"

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
  Grid grid;

  Status gather_obstacles();
  Status find_narrow_band();
  void evaluate_field();
  std::vector<std::uint8_t> blocks_at_values() const;
  std::vector<std::uint8_t> blocks_with_needed_volumes() const;
  void evaluate_block(std::uint32_t b, FieldBlock& evaluator, NearParticles& near,
                      BlockVisibility& visibility);
  RawMesh mesh_at_obstacles();
  void finish(RawMesh&& raw, WaterMesh* mesh);
};

Status Reconstruction::gather_obstacles() {
  if (!contact.uses_visibility()) return {};
  // Blocks that a particle reaches, one block more, and the reach of obstacles.
  const Box water = particles.bounds().inflated(field.kernel_radius + 1 + 2 * side + contact.reach);
  const Box region{cell * water.min, cell * water.max};
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
  const bool with_nodes = options.min_blob > 0;
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

void Reconstruction::finish(RawMesh&& raw, WaterMesh* mesh) {
  const bool keep_gap = contact.promises() && !obstacles.empty();
  if (keep_gap && options.smoothing_iterations > 0) obstacles.prepare_queries();
  report.vertices_held = smooth(options.smoothing_iterations, keep_gap ? &obstacles : nullptr, options.gap,
                                cell, options.clip, raw, workers)
                             .held;
  WaterMesh result;
  interpolate(input, particles, field, obstacles, contact.uses_visibility(), options.nearest, grid, raw,
              result, workers);
  result.normals = vertex_normals(raw);
  for (const Triangle& t : raw.triangles) report.volume += six_volumes(raw, t, raw.positions[0]) / 6;
  result.positions = std::move(raw.positions);
  result.triangles = std::move(raw.triangles);
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
  run.finish(std::move(raw), mesh);
  local.seconds.vertices = watch.lap();
  local.blocks = run.grid.inside_bits.size();
  local.bytes = run.memory.bytes();
  if (report) *report = local;
  return {};
}

}  // namespace oilskin
