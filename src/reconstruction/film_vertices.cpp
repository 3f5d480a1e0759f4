// Films at the vertices of the mesh.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "reconstruction/block_parts.h"
#include "reconstruction/film_kernel.h"
#include "reconstruction/near_film.h"

namespace oilskin::reconstruction {

namespace {

/// Vertices at the lower side of films are this near to it [cells].
constexpr double at_lower_side = 0.2;

/// Between two obstacles the distances of nodes have a ridge, and those of vertices are wrong by this near to
/// it [cells]: heights over the planes of the particles count there.
constexpr double ridge = 1.5, ridge_fade = 0.5;

/// A vertex between two obstacles is nearer to one of them if it is by half of this [dx].
constexpr double nearer_side = 3;

/// Normals of particles on two obstacles that face each other have cosines beyond this and its negative.
/// Where others are between them, as in a tube, the obstacle is around the vertex.
constexpr double facing = 0.5;

/// The film at a vertex: means of its particles.
struct FilmAt {
  double thickness = 0;
  Vec3 normal = Vec3::Zero();
  double weight = 0;
  double above = 0;      ///< height of the vertex over the planes of the nearest particles
  double in_corner = 0;  ///< see FilmParticle
  FilmLayer layer;
};

/// Sums over particles of a film.
class FilmSums {
 public:
  void add(const FilmParticle& p, double k, double above) {
    sum_.thickness += double(p.share) * k;
    sum_.normal += k * vec(p.normal);
    sum_.weight += k;
    const FilmLayer layer(p, 1);
    sum_.layer.height += k * layer.height;
    sum_.in_corner += k * double(p.in_corner);
    sinks_ += k * layer.sinks;
    if (p.other == none) return;
    sum_.layer.opposite += k;
    sum_.layer.other_sinks += k * layer.other_sinks;
    sum_.layer.squeezed += k * layer.squeezed;
    sum_.layer.thin += k * layer.thin;
    grid_height_ += k * layer.grid_height;
    // Where obstacles bend, and where their distance changes, heights are right near their particles only.
    const double near = k * k * k * k;
    sum_.above += near * above;
    near_height_ += near * double(p.height);
    near_opposite_ += near * double(p.opposite_height);
    near_ += near;
  }
  bool is_between() const { return sum_.layer.opposite > 0; }
  /// Of the vertex over the planes; infinite if none counts.
  double above() const { return near_ > 0 ? sum_.above / near_ : std::numeric_limits<double>::infinity(); }
  FilmAt mean(const FilmRule& rule) const {
    FilmAt at = sum_;
    if (!(at.weight > 0)) return at;
    at.normal.normalize();
    FilmLayer& mean = at.layer;
    mean.height /= at.weight;
    at.in_corner /= at.weight;
    mean.sinks = sinks_ / at.weight;
    mean.grid_height = rule.grid_height;
    if (!is_between()) return at;
    at.above = above();
    if (near_ > 0) {
      mean.height = near_height_ / near_;
      mean.other_height = near_opposite_ / near_;
    }
    mean.grid_height += (grid_height_ - mean.opposite * rule.grid_height) / at.weight;
    mean.other_sinks /= mean.opposite;
    mean.thin /= mean.opposite;
    mean.squeezed /= at.weight;
    mean.opposite /= at.weight;
    return at;
  }

 private:
  FilmAt sum_;
  double sinks_ = 0, grid_height_ = 0, near_ = 0, near_height_ = 0, near_opposite_ = 0;
};

/// The films at a vertex, of weights that add up to 1. Between two obstacles a film is on both; in the
/// middle, where neither is nearer, both count, so that vertices side by side move alike.
struct FilmsAt {
  std::array<FilmAt, 2> films;
  std::array<double, 2> weights = {1, 0};
};

/// The films at x, whose distance from obstacles is known.
FilmsAt films_at(const FilmRule& rule, const NearFilm& near, const Vec3& x, double distance,
                 const FilmKernel& kernel) {
  // Calls f(particle, weight, height over its plane).
  const auto for_film = [&](const auto& f) {
    near.for_over(rule, x, distance, [&](std::size_t c, double rho_squared, double above) {
      // Those without a share are no part of the film: too high above the obstacle.
      if (near.item(c).share > 0) f(near.item(c), kernel(rho_squared), above);
    });
  };
  FilmSums all;
  std::array<float, 3> first{};
  bool is_facing = false, is_around = false;
  for_film([&](const FilmParticle& p, double k, double above) {
    all.add(p, k, above);
    if (first == std::array<float, 3>{}) first = p.normal;
    const double alike = vec(p.normal).dot(vec(first));
    is_facing |= alike < -facing;
    is_around |= std::abs(alike) < facing;
  });
  if (!all.is_between() && (!is_facing || is_around)) return {{all.mean(rule), {}}};
  std::array<FilmSums, 2> sides;  // of two obstacles opposite to each other: particles are on one or both
  std::array<double, 2> off = {0, 0}, weight = {0, 0};
  for_film([&](const FilmParticle& p, double k, double above) {
    const std::size_t side_of = vec(p.normal).dot(vec(first)) > 0 ? 0 : 1;
    sides[side_of].add(p, k, above);
    off[side_of] += k * std::abs(above - distance);
    weight[side_of] += k;
  });
  // Two films, each on its obstacle: the vertex is of the one over whose planes it is as high as it should
  // be.
  if (!all.is_between()) return {{sides[off[0] * weight[1] <= off[1] * weight[0] ? 0 : 1].mean(rule), {}}};
  const double first_above = sides[0].above(), second_above = sides[1].above();
  double share = std::isfinite(first_above) ? 1 : 0;
  if (std::isfinite(first_above) && std::isfinite(second_above))
    share = std::clamp(0.5 + (second_above - first_above) / (nearer_side * rule.spacing), 0.0, 1.0);
  FilmsAt result{{sides[0].mean(rule), sides[1].mean(rule)}};
  std::array<FilmAt, 2>& films = result.films;
  // Far from one of them only some particles agree with it; both have the same water.
  films[0].thickness = films[1].thickness = std::max(films[0].thickness, films[1].thickness);
  const double both = share * films[0].weight + (1 - share) * films[1].weight;
  result.weights[0] = both > 0 ? share * films[0].weight / both : share;
  result.weights[1] = 1 - result.weights[0];
  return result;
}

/// The height of a vertex over the obstacle of its film. `now`: its distance with its moves, `distance`
/// without them.
double height_of(const FilmAt& at, double distance, double now) {
  if (!(at.layer.opposite > 0)) return now;
  const double middle = (at.layer.height + at.layer.other_height) / 2;
  const double share = std::clamp((distance - middle + ridge) / ridge_fade, 0.0, 1.0);
  return now + share * (at.above - now);
}

/// 1: the water is a film, 0: it is not. Near the greatest width between two obstacles some particles know of
/// one of them only, so columns may look thin that are not.
double film_share(const FilmRule& rule, const FilmAt& at) {
  const double thin = thinness(rule, at.thickness) * (1 - at.in_corner);
  return at.layer.opposite > 0 ? std::min(std::max(thin, at.layer.squeezed), at.layer.thin) : thin;
}

/// The mean of two moves as far as they agree: in folds they do not, and vertices would pass each other.
Vec3 common(const std::array<Vec3, 2>& moves, const std::array<double, 2>& weights) {
  Vec3 mean = weights[0] * moves[0] + weights[1] * moves[1];
  if (!(weights[0] > 0 && weights[1] > 0)) return mean;
  const double most = std::max(moves[0].squaredNorm(), moves[1].squaredNorm());
  const double agree = most > 0 ? std::clamp(moves[0].dot(moves[1]) / most, 0.0, 1.0) : 0;
  const double both = 2 * std::min(weights[0], weights[1]);
  mean *= 1 - both * (1 - agree);
  return mean;
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
  const auto thin = [&](std::uint32_t v, const Vec3& x, const NearFilm& near) {
    const double distance = mesh.distances[v];
    const Vec3 place = vec(mesh.positions[v]);
    const FilmsAt found = films_at(rule, near, x, distance, kernel);
    const NodeRef& inner = mesh.inside_nodes[v];
    const std::uint32_t inner_near = grid.blocks[inner.block].near;
    const double wetness = inner_near == none
                               ? mode == ObstacleMode::touch
                               : double(film_wetness(mode, grid.nears[inner_near], std::size_t(inner.node)));
    std::array<Vec3, 2> moves = {Vec3::Zero(), Vec3::Zero()};
    for (std::size_t side_of = 0; side_of < 2; ++side_of) {
      FilmAt at = found.films[side_of];
      const double weight = found.weights[side_of];
      if (!(weight > 0 && at.weight > 0)) continue;
      const double is_film = film_share(rule, at),
                   share = is_film * std::clamp((rule.band - 1 - distance) / fade, 0.0, 1.0);
      result.thickness[v] += static_cast<float>(weight * std::min(1.0, 4 * is_film) * at.thickness);
      result.share[v] += static_cast<float>(weight * share);
      at.layer.sinks *= wetness;
      at.layer.other_sinks *= wetness;
      const double now =
          height_of(at, distance, distance + at.normal.dot(place - vec(polygonised[v])) / grid.cell);
      // Below another obstacle the nearest one of the node within may be the lower one.
      const bool faces_obstacle = at.layer.opposite > 0
                                      ? at.normal.dot(grid.place(inner) - vec(polygonised[v])) > 0
                                      : double(grid.distance(inner)) > distance;
      // Into the water only, where there is no obstacle: lower sides go up, all others down.
      const bool is_lower =
          faces_obstacle && now < at.layer.lower(at.layer.grid_height, rule.clearance) + at_lower_side;
      const double shift = share * film_shift(rule, at.layer, at.thickness, now);
      moves[side_of] = (is_lower ? std::max(0.0, shift) : std::min(0.0, shift)) * at.normal;
    }
    const Vec3 move = common(moves, found.weights);
    if (move == Vec3::Zero()) return;
    const Vec3 moved = clamped_to(clip, place + grid.cell * move);
    mesh.positions[v] = {float(moved.x()), float(moved.y()), float(moved.z())};
  };
  const std::vector<float> no_volumes;
  workers.for_chunks(grid.blocks.size(), 8, [&](std::size_t from, std::size_t to, std::size_t) {
    NearParticles near, near_part;
    NearFilm near_film;
    BlockParts parts;
    for (std::size_t b = from; b < to; ++b) {
      const std::uint32_t begin = mesh.first_vertex[b], end = mesh.first_vertex[b + 1];
      if (begin == end || grid.blocks[b].near == none) continue;
      near.gather(particles, no_volumes, grid.blocks[b].at, -1, side + 1, float(rule.link));
      const Vec3 origin = grid.origin(grid.blocks[b]);
      parts.clear();
      for (std::uint32_t v = begin; v < end; ++v) {
        const Vec3 place = vec(mesh.positions[v]);
        if (double(mesh.distances[v]) < rule.band && (!within_clip || within_clip->contains(place)))
          parts.add(v, (place - origin) / grid.cell);
      }
      parts.for_each([&](const BlockParts::Part& part) {
        near_part.select(near, part.low, part.high, float(rule.link));
        near_film.set(film, near_part);
        for (std::size_t i = 0; i < part.numbers.size(); ++i)
          thin(part.numbers[i], vec(part.places[i]), near_film);
      });
    }
  });
  return result;
}

}  // namespace oilskin::reconstruction
