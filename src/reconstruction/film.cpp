#include "reconstruction/film.h"

#include <algorithm>
#include <cmath>

#include "core/closest_point.h"

namespace oilskin::reconstruction {

namespace {

constexpr double pi = 3.14159265358979323846;

/// Distances along films in spacings, see FilmRule.
constexpr double film_reach = 1, column_reach = 2.2, link = 3, min_radius = 0.66, max_radius = 1.6;

/// Films are at least this thick on the grid [cells]: then a row of nodes lies inside, whatever the slope.
constexpr double min_grid_height = 1.25;

/// Vertices at the lower side of films are this near to it [cells].
constexpr double at_lower_side = 0.2;

/// Above the grid's films, thinning fades out over this [cells].
constexpr double fade = 0.95;

/// Discs of two particles at this fraction of their distance close the space between four.
constexpr double radius_of_distance = 0.62;

/// Two particles lie on the same side of the same sheet if their heights over each other's plane agree.
constexpr double height_slack = 0.4, slope_slack = 0.25;  // [dx], per distance

/// The columns of water up to the first are films; from the second on [dx] they are not.
constexpr double film_up_to = 1, bulk_from = 2;

/// The kernel of the mean along a film: 4/(π L²) (1 − ρ²/L²)³.
struct FilmKernel {
  explicit FilmKernel(double reach) : inverse_(1 / (reach * reach)), norm_(4 / (pi * reach * reach)) {}
  double operator()(double rho_squared) const {
    const double u = std::max(0.0, 1 - rho_squared * inverse_);
    return norm_ * u * u * u;
  }

 private:
  double inverse_, norm_;
};

/// Offset of b from a, split into height over a's plane and distance along it.
struct AlongFilm {
  double height, rho_squared;
  AlongFilm(const FilmParticle& a, const Vec3& offset)
      : height(double(a.height) + vec(a.normal).dot(offset)),
        rho_squared(std::max(0.0, offset.squaredNorm() - std::pow(vec(a.normal).dot(offset), 2))) {}
};

/// Calls f(item, particle, offset, rho²) for the particles near obstacles in `near` that lie on the same film
/// as `own`.
template <class F>
void for_film_neighbours(const Film& film, const NearParticles& near, const FilmParticle& own, const Vec3& x,
                         double reach, const F& f) {
  const FilmRule& rule = film.rule();
  for (std::size_t c = 0; c < near.count; ++c) {
    const FilmParticle* other = film.find(near.particle[c]);
    if (!other) continue;
    const Vec3 offset = Vec3(near.x[c], near.y[c], near.z[c]) - x;
    if (vec(own.normal).dot(vec(other->normal)) < 0.5) continue;
    const AlongFilm along(own, offset);
    const double rho = std::sqrt(along.rho_squared);
    if (rho > reach) continue;
    if (std::abs(along.height - double(other->height)) > height_slack * rule.spacing + slope_slack * rho)
      continue;
    f(*other, near.particle[c], offset, along.rho_squared);
  }
}

/// Two unit vectors along a film.
struct TangentFrame {
  Vec3 u, v;
  explicit TangentFrame(const Vec3& normal) {
    u = normal.cross(std::abs(normal.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
    v = normal.cross(u);
  }
};

/// Points of the unit disc that stand for equal parts of FilmKernel: radii by the inverse of its integral, in
/// a spiral with the golden angle.
constexpr std::array<std::array<double, 2>, 24> kernel_points = {
    {{0.0725, 0.0000},   {-0.0933, 0.0855}, {0.0144, -0.1641},  {0.1196, 0.1560},  {-0.2215, -0.0392},
     {0.2118, -0.1347},  {-0.0715, 0.2661}, {-0.1378, -0.2654}, {0.3023, 0.1104},  {-0.3180, 0.1313},
     {0.1551, -0.3315},  {0.1161, 0.3701},  {-0.3546, -0.2055}, {0.4220, -0.0928}, {-0.2615, 0.3720},
     {-0.0614, -0.4741}, {0.3841, 0.3237},  {-0.5274, 0.0218},  {0.3935, -0.3915}, {-0.0270, 0.5842},
     {-0.3960, -0.4746}, {0.6513, 0.0876},  {-0.5804, 0.4039},  {0.1728, -0.7683}}};

/// The distance to the nearest neighbour in each of six sectors.
class Sectors {
 public:
  explicit Sectors(const Vec3& normal) : frame_(normal) { nearest_.fill(0); }
  void add(const Vec3& offset, double rho) {
    const double a = frame_.u.dot(offset), b = frame_.v.dot(offset);
    // Lines at 0, 60 and 120 degrees separate the sectors.
    const bool above60 = b > 1.7320508 * a, above120 = b > -1.7320508 * a;
    const std::size_t sector =
        b >= 0 ? (above120 ? (above60 ? 1u : 0u) : 2u) : (above120 ? 5u : (above60 ? 3u : 4u));
    double& n = nearest_[sector];
    if (n == 0 || rho < n) n = rho;
  }
  double farthest() const { return *std::max_element(nearest_.begin(), nearest_.end()); }

 private:
  TangentFrame frame_;
  std::array<double, 6> nearest_;
};

/// 1 where a column of water of this thickness [cells] is a film, 0 where it is not.
double thinness(const FilmRule& rule, double thickness) {
  return std::clamp((bulk_from - thickness / rule.spacing) / (bulk_from - film_up_to), 0.0, 1.0);
}

/// The nearest point of the obstacles within `reach` [m]; at that distance if there is none.
ClosestPoint nearest_point(const Obstacles& obstacles, const Vec3& x, double reach,
                           std::vector<std::uint32_t>& near) {
  Box box;
  box.add(x);
  near.clear();
  obstacles.query(box.inflated(reach), near);
  ClosestPoint best;
  best.distance = reach;
  for (const std::uint32_t t : near) {
    const Corners c = obstacles.corners(t);
    const ClosestPoint p = closest_point(x, c[0], c[1], c[2]);
    if (p.distance < best.distance) best = p;
  }
  return best;
}

}  // namespace

double film_band(double clearance) {
  return clearance + min_grid_height + fade + 1.05;
}

FilmRule film_rule(const ReconstructionOptions& o, double clearance) {
  FilmRule r;
  r.spacing = 1 / o.cell;
  r.clearance = clearance;
  r.band = film_band(clearance);
  r.grid_height = min_grid_height;
  r.film_reach = film_reach * r.spacing;
  r.column_reach = column_reach * r.spacing;
  r.link = link * r.spacing;
  r.min_radius = min_radius * r.spacing;
  r.max_radius = max_radius * r.spacing;
  return r;
}

Film::Film(const FilmRule& rule, const ParticleBlocks& particles, const Water& water,
           const Obstacles& obstacles, double cell, const Workers& workers)
    : rule_(rule) {
  if (obstacles.empty()) return;
  find_heights(particles, obstacles, cell, workers);
  find_radii(particles, workers);
  find_shares(particles, water, workers);
}

void Film::find_heights(const ParticleBlocks& particles, const Obstacles& obstacles, double cell,
                        const Workers& workers) {
  const Box bounds = obstacles.bounds().inflated(rule_.column_reach * cell);
  std::vector<std::vector<std::pair<std::uint32_t, FilmParticle>>> found(particles.blocks.size());
  workers.for_chunks(particles.blocks.size(), 16, [&](std::size_t from, std::size_t to, std::size_t) {
    std::vector<std::uint32_t> near;
    for (std::size_t b = from; b < to; ++b) {
      for (std::size_t i = particles.begin[b]; i < particles.begin[b + 1]; ++i) {
        const Vec3 x = cell * particles.place(b, i);
        if (!bounds.contains(x)) continue;
        const ClosestPoint nearest = nearest_point(obstacles, x, rule_.column_reach * cell, near);
        if (!(nearest.distance > 0 && nearest.distance < rule_.column_reach * cell)) continue;
        FilmParticle p;
        const Vec3 n = nearest.offset / nearest.distance;
        p.normal = {float(n.x()), float(n.y()), float(n.z())};
        p.height = static_cast<float>(nearest.distance / cell);
        found[b].emplace_back(static_cast<std::uint32_t>(i), p);
      }
    }
  });
  for (const auto& block : found)
    for (const auto& [particle, item] : block) {
      if (index_.empty()) index_.assign(particles.size(), none);
      index_[particle] = static_cast<std::uint32_t>(items_.size());
      items_.push_back(item);
    }
}

/// Calls f(number of the item, its place, particles around) for every particle near an obstacle.
template <class F>
void Film::for_items(const ParticleBlocks& particles, double reach, const Workers& workers,
                     const F& f) const {
  if (items_.empty()) return;
  const std::vector<float> no_volumes;
  workers.for_chunks(particles.blocks.size(), 8, [&](std::size_t from, std::size_t to, std::size_t) {
    NearParticles near;
    for (std::size_t b = from; b < to; ++b) {
      bool gathered = false;
      for (std::size_t i = particles.begin[b]; i < particles.begin[b + 1]; ++i) {
        if (index_[i] == none) continue;
        if (!gathered) near.gather(particles, no_volumes, particles.blocks[b], 0, side, float(reach));
        gathered = true;
        f(index_[i], static_cast<std::uint32_t>(i), Vec3(particles.x[i], particles.y[i], particles.z[i]),
          near);
      }
    }
  });
}

void Film::find_radii(const ParticleBlocks& particles, const Workers& workers) {
  for_items(particles, rule_.link, workers,
            [&](std::uint32_t item, std::uint32_t particle, const Vec3& x, const NearParticles& near) {
              FilmParticle& own = items_[item];
              if (!(double(own.height) < rule_.film_reach)) return;
              Sectors sectors(vec(own.normal));
              for_film_neighbours(
                  *this, near, own, x, rule_.link,
                  [&](const FilmParticle& other, std::uint32_t p, const Vec3& offset, double rho2) {
                    if (p != particle && double(other.height) < rule_.film_reach)
                      sectors.add(offset, std::sqrt(rho2));
                  });
              own.is_linked = sectors.farthest() > 0;
              own.radius = static_cast<float>(
                  std::clamp(radius_of_distance * sectors.farthest(), rule_.min_radius, rule_.max_radius));
            });
}

/// The share of a particle is its volume over the part of its kernel that lies over discs. Also takes
/// particles under deep water out of films.
void Film::find_shares(const ParticleBlocks& particles, const Water& water, const Workers& workers) {
  const double reach = rule_.link + rule_.max_radius;
  const FilmKernel kernel(rule_.link);
  // Only when all are known: neighbours read the radii.
  std::vector<std::uint8_t> is_deep(items_.size(), 0);
  for_items(particles, reach, workers,
            [&](std::uint32_t item, std::uint32_t particle, const Vec3& x, const NearParticles& near) {
              FilmParticle& own = items_[item];
              const TangentFrame frame(vec(own.normal));
              std::array<bool, kernel_points.size()> is_covered{};
              double volume = 0;
              for_film_neighbours(
                  *this, near, own, x, reach,
                  [&](const FilmParticle& other, std::uint32_t p, const Vec3& offset, double rho2) {
                    volume += water.of(p) * kernel(rho2);
                    if (!(other.radius > 0)) return;
                    const double a = frame.u.dot(offset), b = frame.v.dot(offset);
                    const double r2 = double(other.radius) * double(other.radius);
                    for (std::size_t s = 0; s < kernel_points.size(); ++s) {
                      const double u = rule_.link * kernel_points[s][0] - a,
                                   v = rule_.link * kernel_points[s][1] - b;
                      is_covered[s] |= u * u + v * v < r2;
                    }
                  });
              const auto covered = std::count(is_covered.begin(), is_covered.end(), true);
              if (covered == 0) return;
              const double over_water = double(covered) / double(kernel_points.size());
              own.share = static_cast<float>(water.of(particle) / over_water);
              const double thin = thinness(rule_, volume / over_water);
              is_deep[item] = thin == 0;
              // A drop alone is as high as it is wide: the field draws it.
              own.thin = own.is_linked ? static_cast<float>(thin) : 0.0f;
            });
  for (std::size_t i = 0; i < items_.size(); ++i)
    if (is_deep[i]) items_[i].radius = 0;
}

namespace {

/// The film at a vertex.
struct FilmAt {
  double thickness = 0;
  Vec3 normal = Vec3::Zero();
  double weight = 0;
  double height = 0;  ///< mean of its particles
};

/// The film at x, whose distance from obstacles is known.
FilmAt film_at(const Film& film, const NearParticles& near, const Vec3& x, double distance,
               const FilmKernel& kernel) {
  const FilmRule& rule = film.rule();
  FilmAt at;
  for (std::size_t c = 0; c < near.count; ++c) {
    const FilmParticle* p = film.find(near.particle[c]);
    if (!p) continue;
    const AlongFilm along(*p, x - Vec3(near.x[c], near.y[c], near.z[c]));
    const double k = kernel(along.rho_squared);
    if (!(k > 0)) continue;
    const double slack = height_slack * rule.spacing + slope_slack * std::sqrt(along.rho_squared);
    if (std::abs(along.height - distance) > slack) continue;
    at.thickness += double(p->share) * k;
    at.normal += k * vec(p->normal);
    at.weight += k;
    at.height += k * double(p->height);
  }
  if (at.weight > 0) {
    at.normal.normalize();
    at.height /= at.weight;
  }
  return at;
}

/// The distance of a film's lower side from the obstacle [cells].
double film_lower(const FilmRule& rule, const FilmAt& film, double wetness, double thickness) {
  return rule.clearance + (1 - wetness) * std::max(0.0, film.height - thickness / 2 - rule.clearance);
}

/// How far a vertex of a film moves along its normal [cells]. It is at the distance `now`.
double film_shift(const FilmRule& rule, const FilmAt& film, double wetness, double now) {
  const double on_grid = film_lower(rule, film, wetness, rule.grid_height);
  const double above = std::clamp((now - on_grid) / rule.grid_height, 0.0, 1.0);
  return film_lower(rule, film, wetness, film.thickness) + film.thickness * above - now;
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
    for (std::size_t b = from; b < to; ++b) {
      const std::uint32_t begin = mesh.first_vertex[b], end = mesh.first_vertex[b + 1];
      if (begin == end || grid.blocks[b].near == none) continue;
      near.gather(particles, no_volumes, grid.blocks[b].at, -1, side + 1, float(rule.link));
      const Vec3 origin = grid.origin(grid.blocks[b]);
      for (std::uint32_t v = begin; v < end; ++v) {
        const double distance = mesh.distances[v];
        const Vec3 place = vec(mesh.positions[v]);
        if (!(distance < rule.band) || (within_clip && !within_clip->contains(place))) continue;
        const FilmAt at = film_at(film, near, (place - origin) / grid.cell, distance, kernel);
        if (!(at.weight > 0)) continue;
        const double share =
            thinness(rule, at.thickness) * std::clamp((rule.band - 1 - distance) / fade, 0.0, 1.0);
        result.thickness[v] = static_cast<float>(at.thickness);
        result.share[v] = static_cast<float>(share);
        const NodeRef& inner = mesh.inside_nodes[v];
        const std::uint32_t inner_near = grid.blocks[inner.block].near;
        const double wetness =
            inner_near == none ? mode == ObstacleMode::touch
                               : double(film_wetness(mode, grid.nears[inner_near], std::size_t(inner.node)));
        const double now = distance + at.normal.dot(place - vec(polygonised[v])) / grid.cell;
        // Into the water only, where there is no obstacle: lower sides go up, all others down.
        const bool is_lower = double(grid.distance(inner)) > distance &&
                              now < film_lower(rule, at, wetness, rule.grid_height) + at_lower_side;
        const double shift = share * film_shift(rule, at, wetness, now);
        const double inwards = is_lower ? std::max(0.0, shift) : std::min(0.0, shift);
        const Vec3 moved = place + inwards * grid.cell * at.normal;
        mesh.positions[v] = {float(moved.x()), float(moved.y()), float(moved.z())};
      }
    }
  });
  return result;
}

}  // namespace oilskin::reconstruction
