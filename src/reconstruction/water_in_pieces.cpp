#include "reconstruction/water_in_pieces.h"

#include <cmath>
#include <limits>

namespace oilskin::reconstruction {

namespace {

/// Particles farther than this from a piece have not drawn it [dx].
constexpr double far_from_piece = 3;

}  // namespace

WaterInPieces water_in_pieces(const ParticleBlocks& particles, const Water& water, const Film& film,
                              const DrawnIn& drawn_in, const Grid& grid, const Obstacles& obstacles,
                              const RawMesh& mesh, SmallPieces& pieces, const Workers& workers) {
  WaterInPieces result{std::vector<double>(pieces.count + 1, 0), {}};
  const PieceFinder finder(grid, obstacles, mesh, pieces);
  result.water.back() =
      workers.ordered_sum(particles.blocks.size(), 64, 0.0, [&](std::size_t from, std::size_t to) {
        double sum = 0;
        for (std::size_t p = particles.begin[from]; p < particles.begin[to]; ++p)
          if (!water.is_drop(p)) sum += water.of(p);
        return sum;
      });
  if (pieces.count == 0) return result;
  for (const std::uint32_t v : pieces.in_bubbles) pieces.of_vertex[v] = finder.of_node(mesh.inside_nodes[v]);
  std::vector<std::uint32_t>& piece_of = result.of_particle;
  piece_of.assign(particles.size(), none);
  workers.for_each(particles.blocks.size(), 8, [&](std::size_t n) {
    const bool is_near = finder.is_near(particles.blocks[n]);
    if (!is_near && film.empty() && drawn_in.moves.empty()) return;
    for (std::size_t p = particles.begin[n]; p < particles.begin[n + 1]; ++p) {
      if (water.is_drop(p)) continue;
      const Vec3 x = particles.place(n, p), drawn = x + drawn_in.move(p);
      if (drawn == x ? is_near : finder.is_near(block_at(drawn))) piece_of[p] = finder.find(drawn);
      if (piece_of[p] != none) continue;
      const Vec3 in_film = place_in_film(film, static_cast<std::uint32_t>(p), x);
      if (in_film != x && finder.is_near(block_at(in_film))) piece_of[p] = finder.find(in_film);
    }
  });
  for (std::size_t p = 0; p < particles.size(); ++p) {
    if (piece_of[p] == none) continue;
    result.water[piece_of[p]] += water.of(p);
    result.water.back() -= water.of(p);
  }
  return result;
}

void join_pieces_without_water(const ParticleBlocks& particles, const Water& water,
                               const WaterInPieces& in_pieces, const RawMesh& mesh, double cell,
                               double spacing, SmallPieces& pieces) {
  std::vector<std::uint32_t> joined(pieces.count, none);
  std::vector<std::uint8_t> is_joined(pieces.count, 0);
  const std::vector<float> no_volumes;
  NearParticles near;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const std::uint32_t piece = pieces.of_vertex[v];
    if (piece == none || in_pieces.water[piece] > 0 || is_joined[piece]) continue;
    is_joined[piece] = 1;
    const Vec3 x = vec(mesh.positions[v]) / cell;
    const Int3 at = block_at(x);
    const Vec3 y = x - side * Vec3(at.x, at.y, at.z);
    near.gather(particles, no_volumes, at, 0, side, float(far_from_piece * spacing));
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < near.count; ++c) {
      const std::uint32_t p = near.particle[c];
      const double distance = (Vec3(near.x[c], near.y[c], near.z[c]) - y).squaredNorm();
      if (water.is_drop(p) || !(water.of(p) > 0) || !(distance < nearest)) continue;
      nearest = distance;
      joined[piece] = in_pieces.of_particle[p];
    }
  }
  for (std::uint32_t& piece : pieces.of_vertex)
    if (piece != none && is_joined[piece]) piece = joined[piece];
}

std::vector<double> water_of_small_pieces(double max_volume, const ParticleBlocks& particles,
                                          const Water& water, const Film& film, const DrawnIn& drawn_in,
                                          const Grid& grid, const Obstacles& obstacles, const RawMesh& mesh,
                                          const Workers& workers) {
  const double cell_volume = std::pow(grid.cell, 3);
  SmallPieces pieces = small_pieces(mesh, parts_of(mesh, mesh.positions, workers), max_volume, workers);
  const std::vector<double> in_pieces =
      water_in_pieces(particles, water, film, drawn_in, grid, obstacles, mesh, pieces, workers).water;
  std::vector<double> result(mesh.positions.size(), 0.0);
  for (std::size_t v = 0; v < result.size(); ++v)
    if (pieces.of_vertex[v] != none) result[v] = cell_volume * in_pieces[pieces.of_vertex[v]];
  return result;
}

}  // namespace oilskin::reconstruction
