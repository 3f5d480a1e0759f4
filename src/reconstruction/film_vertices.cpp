// Films at the vertices of the mesh.
#include <algorithm>
#include <cmath>

#include "reconstruction/film_kernel.h"
#include "reconstruction/near_film.h"

namespace oilskin::reconstruction {

namespace {

/// Vertices at the lower side of films are this near to it [cells].
constexpr double at_lower_side = 0.2;

/// The film at a vertex.
struct FilmAt {
  double thickness = 0;
  Vec3 normal = Vec3::Zero();
  double weight = 0;
  FilmLayer layer;  ///< mean of its particles
};

/// The film at x, whose distance from obstacles is known.
FilmAt film_at(const FilmRule& rule, const NearFilm& near, const Vec3& x, double distance,
               const FilmKernel& kernel) {
  FilmAt at;
  FilmLayer& mean = at.layer;
  mean.sinks = 0;
  double grid_height = 0;
  const double most = height_slack * rule.spacing + slope_slack * rule.link;
  near.for_over(x, distance, most, rule.link, [&](std::size_t c) {
    const FilmParticle& p = near.item(c);
    const AlongFilm along(p, x - near.place(c));
    const double k = kernel(along.rho_squared);
    // Those without a share are no part of the film: too high above the obstacle.
    if (!(k > 0) || !(p.share > 0)) return;
    const double slack = height_slack * rule.spacing + slope_slack * std::sqrt(along.rho_squared);
    if (std::abs(along.height - distance) > slack) return;
    at.thickness += double(p.share) * k;
    at.normal += k * vec(p.normal);
    at.weight += k;
    const FilmLayer layer(p, 1);
    mean.height += k * layer.height;
    mean.sinks += k * layer.sinks;
    if (p.other == none) return;
    mean.opposite += k;
    mean.other_height += k * layer.other_height;
    mean.other_sinks += k * layer.other_sinks;
    mean.squeezed += k * layer.squeezed;
    grid_height += k * layer.grid_height;
  });
  if (!(at.weight > 0)) return at;
  at.normal.normalize();
  mean.height /= at.weight;
  mean.sinks /= at.weight;
  mean.grid_height = rule.grid_height;
  if (!(mean.opposite > 0)) return at;
  mean.grid_height += (grid_height - mean.opposite * rule.grid_height) / at.weight;
  mean.other_height /= mean.opposite;
  mean.other_sinks /= mean.opposite;
  mean.squeezed /= at.weight;
  mean.opposite /= at.weight;
  return at;
}

/// How far a vertex of a film moves along its normal [cells]. It is at the distance `now`.
double film_shift(const FilmRule& rule, const FilmLayer& layer, double thickness, double now) {
  const double on_grid = layer.lower(layer.grid_height, rule.clearance);
  const double above = std::clamp((now - on_grid) / layer.grid_height, 0.0, 1.0);
  return layer.lower(thickness, rule.clearance) + thickness * above - now;
}

}  // namespace

FilmVertices thin_films(const Film& film, ObstacleMode mode, const ParticleBlocks& particles,
                        const Grid& grid, const std::vector<std::array<float, 3>>& polygonised,
                        const std::optional<Box>& clip, RawMesh& mesh, const Workers& workers) {
  FilmVertices result;
  result.thickness.assign(mesh.positions.size(), 0.0f);
  result.share = result.thickness;
  if (film.empty()) return result;
  std::optional<Box> within_clip;
  if (clip) within_clip = clip->inflated(-0.05 * grid.cell);
  const FilmRule& rule = film.rule();
  const FilmKernel kernel(rule.link);
  const std::vector<float> no_volumes;
  workers.for_chunks(grid.blocks.size(), 8, [&](std::size_t from, std::size_t to, std::size_t) {
    NearParticles near;
    NearFilm near_film;
    for (std::size_t b = from; b < to; ++b) {
      const std::uint32_t begin = mesh.first_vertex[b], end = mesh.first_vertex[b + 1];
      if (begin == end || grid.blocks[b].near == none) continue;
      near.gather(particles, no_volumes, grid.blocks[b].at, -1, side + 1, float(rule.link));
      near_film.set(film, near);
      const Vec3 origin = grid.origin(grid.blocks[b]);
      for (std::uint32_t v = begin; v < end; ++v) {
        const double distance = mesh.distances[v];
        const Vec3 place = vec(mesh.positions[v]);
        if (!(distance < rule.band) || (within_clip && !within_clip->contains(place))) continue;
        FilmAt at = film_at(rule, near_film, (place - origin) / grid.cell, distance, kernel);
        if (!(at.weight > 0)) continue;
        const double share = std::max(thinness(rule, at.thickness), at.layer.squeezed) *
                             std::clamp((rule.band - 1 - distance) / fade, 0.0, 1.0);
        result.thickness[v] = static_cast<float>(at.thickness);
        result.share[v] = static_cast<float>(share);
        const NodeRef& inner = mesh.inside_nodes[v];
        const std::uint32_t inner_near = grid.blocks[inner.block].near;
        const double wetness =
            inner_near == none ? mode == ObstacleMode::touch
                               : double(film_wetness(mode, grid.nears[inner_near], std::size_t(inner.node)));
        at.layer.sinks *= wetness;
        at.layer.other_sinks *= wetness;
        const double now = distance + at.normal.dot(place - vec(polygonised[v])) / grid.cell;
        // Below another obstacle the nearest one of the node within may be the lower one.
        const bool faces_obstacle = at.layer.opposite > 0
                                        ? at.normal.dot(grid.place(inner) - vec(polygonised[v])) > 0
                                        : double(grid.distance(inner)) > distance;
        // Into the water only, where there is no obstacle: lower sides go up, all others down.
        const bool is_lower =
            faces_obstacle && now < at.layer.lower(at.layer.grid_height, rule.clearance) + at_lower_side;
        const double shift = share * film_shift(rule, at.layer, at.thickness, now);
        const double inwards = is_lower ? std::max(0.0, shift) : std::min(0.0, shift);
        const Vec3 moved = clamped_to(clip, place + inwards * grid.cell * at.normal);
        mesh.positions[v] = {float(moved.x()), float(moved.y()), float(moved.z())};
      }
    }
  });
  return result;
}

}  // namespace oilskin::reconstruction
