// The stages from the field on: mesh, obstacles, volume, vertex data.
#include <cmath>

#include "core/assert.h"
#include "core/stage_timer.h"
#include "reconstruction/blobs.h"
#include "reconstruction/drops.h"
#include "reconstruction/pieces.h"
#include "reconstruction/run.h"
#include "reconstruction/smoothing.h"
#include "reconstruction/untangle.h"
#include "reconstruction/vertex_data.h"
#include "reconstruction/volume_fit.h"
#include "reconstruction/water_in_pieces.h"

namespace oilskin {

namespace reconstruction {

namespace {

/// The volume fit moves vertices outwards by this at most [dx], inwards by this part of the particles'
/// radius.
constexpr double max_outward = 0.6, max_inward = 0.9;

/// Pieces with less water than this are fitted one by one [dx³].
constexpr double small_piece = 300;

}  // namespace

namespace {

template <class T>
std::size_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

}  // namespace

std::size_t Workspace::bytes() const {
  std::size_t bytes = bytes_of(particles.blocks) + bytes_of(particles.begin) + particles.index.bytes() +
                      bytes_of(particles.x) + bytes_of(particles.y) + bytes_of(particles.z) +
                      bytes_of(particles.source) + bytes_of(volumes) + obstacles.bytes() + memory.bytes() +
                      bytes_of(grid.blocks) + grid.index.bytes() + bytes_of(grid.values) +
                      bytes_of(grid.inside_bits) + bytes_of(mesh.positions) + bytes_of(mesh.triangles) +
                      bytes_of(mesh.first_vertex) + bytes_of(mesh.first_triangle) +
                      bytes_of(mesh.triangle_cubes) + bytes_of(mesh.inside_nodes) + bytes_of(mesh.distances) +
                      bytes_of(mesh.cube_volumes);
  for (const NearBlock& near : grid.nears) bytes += near.bytes();
  return bytes;
}

/// Repairs until no triangle is too close and no piece of an obstacle is inside the water.
void Reconstruction::mesh_at_obstacles(RawMesh& mesh) {
  const bool with_nodes = options.min_blob > 0 || water.is_kept();
  if (!keeps_gap()) return polygonise(grid, with_nodes, workers, mesh);
  for (const NearBlock& near : grid.nears) report.cut_edges += near.cut_edges.size();
  report.nodes_cleared += clear_joined_edges(grid, workers);
  const auto& pieces = obstacles.pieces();
  std::vector<std::uint32_t> only;
  Stopwatch watch;
  for (;;) {
    const RepairReport repaired = repair(obstacles, options.gap, grid, std::move(only), workers);
    report.repair_rounds += repaired.rounds;
    report.nodes_cleared += repaired.nodes;
    report.seconds.contact += watch.lap();
    polygonise(grid, with_nodes, workers, mesh);
    std::vector<std::vector<NodeRef>> around;
    InsideTest inside(mesh.positions, mesh.triangles);
    for (const auto& piece : pieces) {
      if (!is_submerged(obstacles, piece, grid, inside)) continue;
      ++report.components_freed;
      around.push_back(nodes_around(obstacles.vertex(piece[0]), grid));
      OILSKIN_ASSERT(!around.back().empty());
    }
    if (around.empty()) return;
    std::vector<NodeRef> changed;
    for (const auto& part : around) changed.insert(changed.end(), part.begin(), part.end());
    report.nodes_cleared += set_outside(grid, around);
    only = blocks_around(grid, changed);
  }
}

/// By the water in them, if the mesh will enclose that.
void Reconstruction::remove_small_pieces(RawMesh& mesh) {
  if (!(options.min_blob > 0)) return;
  const double least = options.min_blob * std::pow(options.spacing, 3);
  std::vector<double> water_near;
  if (water.is_kept())
    water_near =
        water_of_small_pieces(least, particles, water, film, drawn_in, grid, obstacles, mesh, workers);
  report.blobs_removed = remove_blobs(grid, least, water_near, mesh);
}

/// Gives films their thickness and the mesh its volume. Returns the thickness per vertex [cells].
std::vector<float> Reconstruction::fit_to_water(const std::vector<std::array<float, 3>>& polygonised,
                                                const MeshParts& parts, const SurfaceBlocks& blocks,
                                                RawMesh& raw) {
  const std::vector<std::uint8_t> missing = far_from_water(particles, film, drawn_in, grid, workers);
  for (std::size_t p = 0; p < missing.size(); ++p)
    if (missing[p]) water.make_drop(p);
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
  limits.gap = options.gap;
  if (contact.promises()) limits.known = obstacle_region;
  fit_volume(limits, particles, water, film, drawn_in, grid, obstacles, polygonised, films, parts, blocks,
             raw, workers);
  return std::move(films.thickness);
}

/// The triangles that have moved and may have come near an obstacle. Those of a block without obstacles were
/// farther away than their reach, and smoothing moved them by a cell at most.
std::vector<std::uint32_t> Reconstruction::moved_near_obstacles(
    const std::vector<std::array<float, 3>>& start, const RawMesh& raw) const {
  const double safe = std::max(0.0, contact.reach - 1) * cell;
  constexpr std::size_t chunk = 16;
  std::vector<std::vector<std::uint32_t>> part((grid.blocks.size() + chunk - 1) / chunk);
  workers.for_chunks(grid.blocks.size(), chunk, [&](std::size_t from, std::size_t to, std::size_t c) {
    for (std::size_t b = from; b < to; ++b)
      for (std::uint32_t t = raw.first_triangle[b]; t < raw.first_triangle[b + 1]; ++t) {
        double farthest = 0;  // squared
        for (const std::uint32_t v : raw.triangles[t])
          farthest = std::max(farthest, (vec(raw.positions[v]) - vec(start[v])).squaredNorm());
        if (farthest > (grid.blocks[b].near == none ? safe * safe : 0)) part[c].push_back(t);
      }
  });
  std::vector<std::uint32_t> moved;
  for (const auto& found : part) moved.insert(moved.end(), found.begin(), found.end());
  return moved;
}

/// The mesh at `start` keeps the promise, and vertices only go back to it, so this ends.
void Reconstruction::put_back_what_fails(const std::vector<std::array<float, 3>>& start, RawMesh& raw) {
  const std::vector<std::uint32_t> moved = moved_near_obstacles(start, raw);
  for (;;) {
    report.vertices_held += put_back(obstacles, options.gap, options.clip, &moved, start, raw, workers);
    const std::size_t freed = put_back_around_enclosed(obstacles, grid, start, moved, raw);
    if (freed == 0) return;
    report.vertices_held += freed;
  }
}

void Reconstruction::append_drops(WaterMesh& mesh) {
  DropLimits limits;
  limits.cell = cell;
  limits.obstacles = keeps_gap() ? &obstacles : nullptr;
  limits.gap = options.gap;
  limits.clip = options.clip;
  limits.min_volume = options.min_blob * std::pow(options.spacing, 3);
  const DropReport made = add_drops(input, particles, water, film, limits, options.nearest, workers, mesh);
  report.drops = made.drawn;
  report.drops_left_out = made.left_out;
}

/// The mesh needs the signs of nodes only.
void Reconstruction::release_field() {
  if (!space.is_for_one_run) return;
  std::vector<float>().swap(grid.values);
  std::vector<float>().swap(volumes);
}

void Reconstruction::finish(RawMesh& raw, WaterMesh& mesh) {
  if (keeps_gap() && options.smoothing_iterations > 0) obstacles.prepare_queries(workers);
  const bool keeps = water.is_kept();
  const bool moves = keeps && (options.smoothing_iterations > 0 || !film.empty());
  const std::vector<std::array<float, 3>> polygonised =
      moves ? raw.positions : std::vector<std::array<float, 3>>();
  report.vertices_held = smooth(options.smoothing_iterations, keeps_gap() ? &obstacles : nullptr, options.gap,
                                cell, options.clip, raw, workers)
                             .held;
  const SurfaceBlocks blocks(grid, raw);
  mesh.thickness.clear();
  if (keeps || options.smoothing_iterations > 0) {
    const std::vector<std::array<float, 3>> start =
        keeps_gap() ? raw.positions : std::vector<std::array<float, 3>>();
    MeshParts parts;
    if (keeps) {
      const std::vector<std::array<float, 3>>& before = moves ? polygonised : raw.positions;
      parts = parts_of(raw, before, workers);
      mesh.thickness = fit_to_water(before, parts, blocks, raw);
    } else {
      untangle(cell, options.clip, blocks, raw, workers);
    }
    if (keeps_gap()) put_back_what_fails(start, raw);
    if (keeps) remove_turned_parts(parts, obstacles, workers, raw, mesh.thickness);
  }
  for (float& t : mesh.thickness) t *= static_cast<float>(cell);
  interpolate(input, particles, field, obstacles, contact.uses_visibility(), options.nearest, grid, raw, mesh,
              workers);
  vertex_normals(raw, blocks, workers, mesh.normals);
  // The buffers of the last mesh serve the next run.
  mesh.positions.swap(raw.positions);
  mesh.triangles.swap(raw.triangles);
  if (keeps) append_drops(mesh);
  report.volume =
      workers.ordered_sum(mesh.triangles.size(), 1 << 12, 0.0, [&](std::size_t from, std::size_t to) {
        double sum = 0;
        for (std::size_t t = from; t < to; ++t)
          sum += six_volumes(mesh.positions, mesh.triangles[t], mesh.positions[0]) / 6;
        return sum;
      });
}

}  // namespace reconstruction

namespace {

using namespace reconstruction;  // NOLINT: the module of this file

Status run(const ReconstructionInput& input, const ReconstructionOptions& options, Workspace& space,
           WaterMesh& mesh, ReconstructionReport* report) {
  if (Status s = options.validate(); !s.ok()) return s;
  if (Status s = validate_input(input, options.spacing); !s.ok()) return s;
  if (!space.workers || space.threads != options.threads) {
    space.workers = std::make_unique<Workers>(options.threads);
    space.threads = options.threads;
  }
  ReconstructionReport local;
  Stopwatch watch;
  Reconstruction run(input, options, local, space);
  if (Status s = run.find_narrow_band(); !s.ok()) return s;
  local.seconds.blocks = watch.lap();
  run.evaluate_field();
  local.seconds.field = watch.lap();
  run.mesh_at_obstacles(space.mesh);
  run.remove_small_pieces(space.mesh);
  local.seconds.mesh = watch.lap() - local.seconds.contact;
  run.release_field();
  run.finish(space.mesh, mesh);
  local.seconds.vertices = watch.lap();
  local.blocks = run.grid.inside_bits.size();
  local.bytes = run.memory.bytes();
  if (report) *report = local;
  return {};
}

}  // namespace

Status reconstruct_surface(const ReconstructionInput& input, const ReconstructionOptions& options,
                           WaterMesh* mesh, ReconstructionReport* report) {
  OILSKIN_ASSERT(mesh != nullptr);
  Workspace space;
  return run(input, options, space, *mesh, report);
}

struct WaterMesher::Impl {
  Workspace space;
};

WaterMesher::WaterMesher() : impl_(std::make_unique<Impl>()) {
  impl_->space.is_for_one_run = false;
}
WaterMesher::~WaterMesher() = default;
WaterMesher::WaterMesher(WaterMesher&&) noexcept = default;
WaterMesher& WaterMesher::operator=(WaterMesher&&) noexcept = default;

Status WaterMesher::reconstruct(const ReconstructionInput& input, const ReconstructionOptions& options,
                                WaterMesh* mesh, ReconstructionReport* report) {
  OILSKIN_ASSERT(mesh != nullptr);
  try {
    return run(input, options, impl_->space, *mesh, report);
  } catch (...) {
    // What a run left half done must not serve the next one.
    *this = WaterMesher();
    throw;
  }
}

std::size_t WaterMesher::bytes() const {
  return impl_->space.bytes();
}

}  // namespace oilskin
