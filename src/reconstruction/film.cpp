#include "reconstruction/film.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reconstruction/film_kernel.h"
#include "reconstruction/near_film.h"
#include "reconstruction/nearest_triangle.h"

namespace oilskin::reconstruction {

namespace {

/// Distances along films in spacings, see FilmRule.
constexpr double film_reach = 1, column_reach = 2.2, link = 3, min_radius = 0.66, max_radius = 1.6;

/// Between two obstacles nearer to each other than this all water is a film, and from this on it fades [dx].
/// All particles there but those at the gap have both within the reach.
constexpr double slot_width = 3.5, slot_fades_from = 3.2, opposite_reach = 3.2;

/// In a tube no column over an obstacle holds all of the water: where there are obstacles on both sides
/// within this [dx].
constexpr double tube_reach = 1.7;

/// Discs become smaller where less than this of a column is a film.
constexpr double full_disc = 0.3;

/// Where the obstacle facing a film has this part of the water of the one beside it, a column over it is of a
/// tube, not of a corner.
constexpr double most_facing = 0.1;

/// Vertices of films only move inwards, so films between two obstacles are that much thicker on the grid.
constexpr double grid_excess = 1.1;

/// Two films are drawn apart where this much is dry between them on the grid [cells], and at most this part
/// of the water is farther from both obstacles than film_reach.
constexpr double dry_between = 1, most_joined = 0.05;

/// A film between two obstacles reaches down to the one that it is nearer to by this [dx]. In the middle it
/// stays where it is.
constexpr double nearer_by = 0.5;

/// Films are at least this thick on the grid: in cells, more than √2, so that rows of nodes lie inside that
/// are joined by edges, whatever the slope; in spacings, since vertices move into the water only: what is
/// above would be lost.
constexpr double min_grid_height = 1.45, min_height_in_spacings = 1;

/// Discs of two particles at this fraction of their distance close the space between four.
constexpr double radius_of_distance = 0.62;

/// 1 between obstacles that are nearer to each other than slot_fades_from, 0 beyond slot_width.
double squeezed(const FilmRule& rule, float width) {
  return std::clamp((slot_width - double(width) / rule.spacing) / (slot_width - slot_fades_from), 0.0, 1.0);
}

/// Offset of b from a, split into height over a's plane and distance along it.
struct AlongFilm {
  double height, rho_squared;
  AlongFilm(const FilmParticle& a, const Vec3& offset)
      : height(double(a.height) + vec(a.normal).dot(offset)),
        rho_squared(std::max(0.0, offset.squaredNorm() - std::pow(vec(a.normal).dot(offset), 2))) {}
};

/// Water over the place of a particle of a film, weighted by the film's kernel.
struct ColumnSum {
  double volume = 0;           ///< per area [cells]
  Vec3 moment = Vec3::Zero();  ///< of the offsets

  void add(double part, const Vec3& offset) {
    volume += part;
    moment += part * offset;
  }
  void add(const ColumnSum& o) {
    volume += o.volume;
    moment += o.moment;
  }
};

/// The water of a column that is nearer to an obstacle beside that of the film and has the film's particle
/// above it: in a corner the two share the water between them. In a tube, where the obstacle is also on the
/// other side, it does not count.
ColumnSum water_in_corner(const FilmRule& rule, const NearFilm& near, const FilmParticle& own, const Vec3& x,
                          const Water& water, const FilmKernel& kernel) {
  ColumnSum beside;
  double facing = 0;
  near.for_beside(own.normal, x, rule.link, [&](std::size_t c) {
    const FilmParticle& other = near.item(c);
    const Vec3 offset = near.place(c) - x;
    const AlongFilm along(own, offset), back(other, -offset);
    if (!(along.height > 0 && back.height > 0)) return;
    const double part = water.of(near.particle(c)) * kernel(along.rho_squared);
    if (vec(own.normal).dot(vec(other.normal)) < -0.5)
      facing += part;
    else if (along.height < rule.column_reach)
      beside.add(part, offset);
  });
  if (!(beside.volume > 0)) return {};
  const double share = std::max(0.0, 1 - facing / (most_facing * beside.volume));
  return {share * beside.volume, share * beside.moment};
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
constexpr std::size_t kernel_points = 24;
constexpr std::array<float, kernel_points> kernel_x = {
    0.0725f, -0.0933f, 0.0144f, 0.1196f,  -0.2215f, 0.2118f, -0.0715f, -0.1378f,
    0.3023f, -0.3180f, 0.1551f, 0.1161f,  -0.3546f, 0.4220f, -0.2615f, -0.0614f,
    0.3841f, -0.5274f, 0.3935f, -0.0270f, -0.3960f, 0.6513f, -0.5804f, 0.1728f};
constexpr std::array<float, kernel_points> kernel_y = {
    0.0000f, 0.0855f, -0.1641f, 0.1560f, -0.0392f, -0.1347f, 0.2661f, -0.2654f,
    0.1104f, 0.1313f, -0.3315f, 0.3701f, -0.2055f, -0.0928f, 0.3720f, -0.4741f,
    0.3237f, 0.0218f, -0.3915f, 0.5842f, -0.4746f, 0.0876f,  0.4039f, -0.7683f};

/// The largest distance of these points from the middle.
constexpr double farthest_kernel_point = 0.79;

/// Which points of the kernel discs cover.
class Coverage {
 public:
  explicit Coverage(double reach) : reach_(static_cast<float>(reach)) {}
  /// A disc around (x, y).
  void add(double x, double y, double radius) {
    const auto at_x = static_cast<float>(x), at_y = static_cast<float>(y), r = static_cast<float>(radius);
    for (std::size_t s = 0; s < kernel_points && covered_ != all; s += 8) {
      const simd::F8 u = simd::F8::load(&kernel_x[s]) * reach_ - at_x,
                     v = simd::F8::load(&kernel_y[s]) * reach_ - at_y;
      covered_ |= greater_mask(r * r, u * u + v * v) << s;
    }
  }
  /// The part of them that discs cover.
  double share() const { return double(__builtin_popcount(covered_)) / double(kernel_points); }

 private:
  static constexpr std::uint32_t all = (1u << kernel_points) - 1;
  float reach_;
  std::uint32_t covered_ = 0;
};

/// The nearest neighbour in each of six sectors.
class Sectors {
 public:
  explicit Sectors(const Vec3& normal) : frame_(normal) {}
  void add(const Vec3& offset) {
    const Eigen::Vector2d at(frame_.u.dot(offset), frame_.v.dot(offset));
    // Lines at 0, 60 and 120 degrees separate the sectors.
    const double slope = 1.7320508;
    const bool above60 = at.y() > slope * at.x(), above120 = at.y() > -slope * at.x();
    const std::size_t sector =
        at.y() >= 0 ? (above120 ? (above60 ? 1u : 0u) : 2u) : (above120 ? 5u : (above60 ? 3u : 4u));
    Neighbour& nearest = nearest_[sector];
    const double distance = at.norm();
    if (nearest.distance == 0 || distance < nearest.distance) nearest = {at, distance};
  }
  /// The largest of the distances, 0 without neighbours.
  double farthest() const {
    double result = 0;
    for (const Neighbour& n : nearest_) result = std::max(result, n.distance);
    return result;
  }
  /// The same of those that no other one, nearer to both, lies between.
  double farthest_in_sight() const {
    double result = 0;
    for (const Neighbour& n : nearest_) {
      const auto is_between = [&n](const Neighbour& other) {
        return other.distance > 0 && other.distance < n.distance && (other.at - n.at).norm() < n.distance;
      };
      if (n.distance > result && std::none_of(nearest_.begin(), nearest_.end(), is_between))
        result = n.distance;
    }
    return result;
  }

 private:
  struct Neighbour {
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    double distance = 0;
  };
  TangentFrame frame_;
  std::array<Neighbour, 6> nearest_;
};

/// 1 at the edge of dense water, as at the surface of a pool beside a wall. There a distant neighbour may be
/// alone in its sector, without a gap to be closed. `volume`: mean water per area within the link, `moment`:
/// its first moment.
double dense_edge(const FilmRule& rule, double volume, double moment) {
  const double dx = rule.spacing;
  const double dense = (volume / dx - 0.4) / 0.2, off = (moment / std::max(volume * dx, 1e-30) - 0.4) / 0.2;
  return std::clamp(dense, 0.0, 1.0) * std::clamp(off, 0.0, 1.0);
}

double film_grid_height(const ReconstructionOptions& o) {
  return std::max(min_grid_height, min_height_in_spacings / o.cell);
}

}  // namespace

double film_band(const ReconstructionOptions& o, double clearance) {
  return clearance + film_grid_height(o) + fade + 1.05;
}

FilmRule film_rule(const ReconstructionOptions& o, double clearance) {
  FilmRule r;
  r.spacing = 1 / o.cell;
  r.clearance = clearance;
  r.band = film_band(o, clearance);
  r.grid_height = film_grid_height(o);
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
  part_films(particles, water, workers);
  find_radii(particles, workers);
  find_shares(particles, water, workers);
}

void Film::find_heights(const ParticleBlocks& particles, const Obstacles& obstacles, double cell,
                        const Workers& workers) {
  const Box bounds = obstacles.bounds().inflated(rule_.column_reach * cell);
  std::vector<std::vector<std::pair<std::uint32_t, FilmParticle>>> found(particles.blocks.size());
  const double dx = rule_.spacing * cell, reach = opposite_reach * dx;
  workers.for_chunks(particles.blocks.size(), 16, [&](std::size_t from, std::size_t to, std::size_t) {
    NearestTriangle nearest_triangle;
    for (std::size_t b = from; b < to; ++b) {
      Box box;
      for (std::size_t i = particles.begin[b]; i < particles.begin[b + 1]; ++i) {
        const Vec3 x = cell * particles.place(b, i);
        if (bounds.contains(x)) box.add(x);
      }
      if (!(box.min.x() <= box.max.x())) continue;
      nearest_triangle.set(obstacles, box, reach);
      nearest_triangle.set_planes();
      for (std::size_t i = particles.begin[b]; i < particles.begin[b + 1]; ++i) {
        const Vec3 x = cell * particles.place(b, i);
        if (!bounds.contains(x)) continue;
        const ClosestPoint nearest = nearest_triangle.find(x, rule_.column_reach * cell);
        if (!(nearest.distance > 0 && nearest.distance < rule_.column_reach * cell)) continue;
        FilmParticle p;
        const Vec3 n = nearest.offset / nearest.distance;
        p.normal = {float(n.x()), float(n.y()), float(n.z())};
        p.height = static_cast<float>(nearest.distance / cell);
        found[b].emplace_back(static_cast<std::uint32_t>(i), p);
        const ClosestPoint opposite = nearest_triangle.find_opposite(x, n);
        if (!(opposite.distance < reach && nearest.distance + opposite.distance < slot_width * dx)) continue;
        if (nearest_triangle.is_enclosed(x, n, tube_reach * dx)) continue;
        const Vec3 m = opposite.offset / opposite.distance;
        p.normal = {float(m.x()), float(m.y()), float(m.z())};
        p.height = static_cast<float>(opposite.distance / cell);
        found[b].emplace_back(static_cast<std::uint32_t>(i), p);
      }
    }
  });
  for (const auto& block : found)
    for (const auto& [particle, item] : block) {
      if (index_.empty()) index_.assign(particles.size(), none);
      const auto at = static_cast<std::uint32_t>(items_.size());
      items_.push_back(item);
      if (index_[particle] == none) {
        index_[particle] = at;
      } else {
        items_[at].other = index_[particle];
        items_[index_[particle]].other = at;
      }
    }
}

/// Calls f(number of the item, particle, its place, particles around) for every particle near an obstacle.
template <class F>
void Film::for_items(const ParticleBlocks& particles, double reach, const Workers& workers,
                     const F& f) const {
  if (items_.empty()) return;
  const std::vector<float> no_volumes;
  workers.for_chunks(particles.blocks.size(), 8, [&](std::size_t from, std::size_t to, std::size_t) {
    NearParticles near;
    NearFilm near_film;
    for (std::size_t b = from; b < to; ++b) {
      bool gathered = false;
      for (std::size_t i = particles.begin[b]; i < particles.begin[b + 1]; ++i) {
        if (index_[i] == none) continue;
        if (!gathered) {
          near.gather(particles, no_volumes, particles.blocks[b], 0, side, float(reach));
          near_film.set(*this, near);
          gathered = true;
        }
        const Vec3 x(particles.x[i], particles.y[i], particles.z[i]);
        for (const std::uint32_t item : {index_[i], items_[index_[i]].other})
          if (item != none) f(item, static_cast<std::uint32_t>(i), x, near_film);
      }
    }
  });
}

/// Where two obstacles have a film each, without water between the films, and the grid has space for both,
/// each particle is near one of them only.
void Film::part_films(const ParticleBlocks& particles, const Water& water, const Workers& workers) {
  const FilmKernel kernel(rule_.link);
  const double least_width = 2 * (rule_.clearance + rule_.grid_height) + dry_between;
  const auto width_at = [&](const FilmParticle& p) {
    const FilmParticle* const across = opposite(p);
    return across ? double(p.height) + double(across->height) : std::numeric_limits<double>::infinity();
  };
  const auto nearer_at = [&](const FilmParticle& p) {
    const FilmParticle* const across = opposite(p);
    return double(across ? std::min(p.height, across->height) : p.height);
  };
  const auto is_wide = [&](const FilmParticle& p) { return p.other != none && width_at(p) >= least_width; };
  if (std::none_of(items_.begin(), items_.end(), is_wide)) return;
  std::vector<std::uint8_t> is_apart(items_.size(), 0);
  for_items(particles, rule_.link, workers,
            [&](std::uint32_t item, std::uint32_t, const Vec3& x, const NearFilm& near) {
              const FilmParticle& own = items_[item];
              const double width = width_at(own);
              if (!is_wide(own) || double(own.height) > width / 2) return;
              double all = 0, joined = 0, height = 0;
              near.for_same_film(rule_, own, x, rule_.link, [&](std::size_t c, double rho2) {
                const FilmParticle& p = near.item(c);
                const double volume = water.of(near.particle(c)) * kernel(rho2), nearer = nearer_at(p);
                all += volume;
                height += volume * nearer;
                if (nearer > rule_.film_reach || width_at(p) < least_width) joined += volume;
              });
              const double half = rule_.grid_height / 2,
                           top = std::max(rule_.clearance + half, height / all) + half;
              is_apart[item] = joined <= most_joined * all && width > 2 * top + dry_between;
            });
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (!is_apart[i]) continue;
    items_[items_[i].other].other = none;
    items_[i].other = none;
  }
}

/// Between two obstacles everything is one film over both.
bool Film::forms_film(const FilmParticle& item) const {
  return item.other != none || double(item.height) < rule_.film_reach;
}

void Film::find_radii(const ParticleBlocks& particles, const Workers& workers) {
  for_items(particles, rule_.link, workers,
            [&](std::uint32_t item, std::uint32_t particle, const Vec3& x, const NearFilm& near) {
              FilmParticle& own = items_[item];
              if (!forms_film(own)) return;
              Sectors sectors(vec(own.normal));
              near.for_same_film(rule_, own, x, rule_.link, [&](std::size_t c, double) {
                if (near.particle(c) != particle && forms_film(near.item(c))) sectors.add(near.place(c) - x);
              });
              const auto radius = [&](double distance) {
                return static_cast<float>(
                    std::clamp(radius_of_distance * distance, rule_.min_radius, rule_.max_radius));
              };
              own.is_linked = sectors.farthest() > 0;
              own.radius = radius(sectors.farthest());
              own.radius_in_sight = radius(sectors.farthest_in_sight());
            });
}

/// The share of a particle is its volume over the part of its kernel that lies over discs. Also takes
/// particles under deep water out of films.
void Film::find_shares(const ParticleBlocks& particles, const Water& water, const Workers& workers) {
  const double reach = std::max(rule_.link, farthest_kernel_point * rule_.link + rule_.max_radius);
  const FilmKernel kernel(rule_.link);
  // Only when all are known: neighbours read the radii.
  std::vector<float> in_film(items_.size(), 1.0f);
  std::vector<float> edge(items_.size(), 0.0f);
  for_items(particles, reach, workers,
            [&](std::uint32_t item, std::uint32_t particle, const Vec3& x, const NearFilm& near) {
              FilmParticle& own = items_[item];
              const FilmParticle* const opposite_of_own = opposite(own);
              const TangentFrame frame(vec(own.normal));
              Coverage coverage(rule_.link);
              double weight = 0, height = 0;
              ColumnSum column;
              near.for_same_film(rule_, own, x, reach, [&](std::size_t c, double rho2) {
                const FilmParticle& other = near.item(c);
                const Vec3 offset = near.place(c) - x;
                column.add(water.of(near.particle(c)) * kernel(rho2), offset);
                if (!(other.radius > 0)) return;
                if (opposite_of_own) {
                  weight += kernel(rho2);
                  height += kernel(rho2) * double(other.height);
                }
                coverage.add(frame.u.dot(offset), frame.v.dot(offset), double(other.radius));
              });
              own.mean_height = weight > 0 ? static_cast<float>(height / weight) : own.height;
              own.grid_height = static_cast<float>(rule_.grid_height);
              ColumnSum all = column;
              if (!opposite_of_own) {
                all.add(water_in_corner(rule_, near, own, x, water, kernel));
                const Vec3 normal = vec(own.normal), along = all.moment - all.moment.dot(normal) * normal;
                edge[item] = static_cast<float>(dense_edge(rule_, all.volume, along.norm()));
              }
              const double over_water = coverage.share();
              if (over_water == 0) return;
              own.share = static_cast<float>(water.of(particle) / over_water);
              const double alone = thinness(rule_, column.volume / over_water);
              double thin = thinness(rule_, all.volume / over_water);
              if (alone > 0) own.in_corner = static_cast<float>(1 - thin / alone);
              if (opposite_of_own) {
                own.squeezed = static_cast<float>(squeezed(rule_, own.height + opposite_of_own->height));
                thin = std::max(thin, double(own.squeezed));
                own.grid_height = static_cast<float>(std::max(
                    rule_.grid_height, double(own.squeezed) * grid_excess * column.volume / over_water));
              }
              in_film[item] = static_cast<float>(std::min(1.0, thin / full_disc));
              // A drop alone is as high as it is wide: the field draws it.
              own.thin = own.is_linked ? static_cast<float>(thin) : 0.0f;
            });
  for (std::size_t i = 0; i < items_.size(); ++i) {
    FilmParticle& own = items_[i];
    own.radius += edge[i] * (own.radius_in_sight - own.radius);
    own.radius *= in_film[i];
    if (own.other == none) continue;
    FilmParticle& other = items_[own.other];
    own.radius *= in_film[own.other];
    own.other_height = other.mean_height;
    own.opposite_height = other.height;
    const double nearer = double(other.mean_height - own.mean_height) / (nearer_by * rule_.spacing);
    own.sinks = other.other_sinks = static_cast<float>(std::clamp(nearer, 0.0, 1.0));
    if (own.other > i) continue;
    // The columns over the two differ where one reaches farther: the thicker one counts.
    own.thin = other.thin = std::min(own.thin, other.thin);
    own.grid_height = other.grid_height = std::max(own.grid_height, other.grid_height);
  }
}

double FilmLayer::middle(double thickness, double clearance) const {
  const double lowest = clearance + thickness / 2;
  const auto way = [&](double above, double share) {
    return above > lowest ? share * (above - lowest) : above - lowest;
  };
  return height - way(height, sinks) + (opposite > 0 ? opposite * way(other_height, other_sinks) : 0);
}

}  // namespace oilskin::reconstruction
