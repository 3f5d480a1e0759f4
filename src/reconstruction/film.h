/// Water that lies on obstacles in a layer thinner than the grid resolves. The grid draws it as a layer of a
/// cell or more, from discs around the particles; afterwards vertices move towards the obstacle until the
/// layer has the thickness that the water there gives it. Lengths in cells.
#pragma once

#include <algorithm>
#include <optional>

#include "reconstruction/obstacles.h"
#include "reconstruction/particle_blocks.h"
#include "reconstruction/polygonise.h"
#include "reconstruction/water.h"

namespace oilskin::reconstruction {

struct FilmRule {
  double spacing = 0;       ///< dx [cells]
  double clearance = 0;     ///< d*: the lower side of films
  double grid_height = 0;   ///< thickness of films on the grid
  double band = 0;          ///< vertices farther from obstacles are not of a film
  double film_reach = 0;    ///< particles nearer to an obstacle than this form films
  double column_reach = 0;  ///< particles nearer than this count for the thickness
  double link = 0;          ///< particles of a film are not farther apart than this; radius of the mean
  double min_radius = 0, max_radius = 0;  ///< of discs
};

/// Distances of nodes are needed up to this [cells], so that the upper side of films lies between two of
/// them.
double film_band(const ReconstructionOptions& options, double clearance);

FilmRule film_rule(const ReconstructionOptions& options, double clearance);

/// A particle near an obstacle. One between two obstacles that face each other is near both.
struct FilmParticle {
  std::array<float, 3> normal;  ///< unit, away from the nearest point of an obstacle
  float height = 0;             ///< distance from it
  float radius = 0;             ///< of its disc; 0: it does not form a film
  float radius_in_sight = 0;    ///< the same without distant neighbours that nearer ones hide
  bool is_linked = false;       ///< there is another one within the link
  float thin = 0;               ///< 1: its column of water is a film, 0: it is not
  float share = 0;              ///< its volume over the part of its kernel that lies over water [cells³]
  /// Towards this obstacle, where obstacles attract films: 1 all of the way that is free, 0 none of it.
  float sinks = 1;
  float mean_height = 0;                    ///< of the film around it
  float grid_height = 0;                    ///< thickness of its film on the grid
  std::uint32_t other = none;               ///< the number of the same particle at the obstacle opposite
  float other_height = 0, other_sinks = 0;  ///< mean height and `sinks` there
  float opposite_height = 0;                ///< distance from the obstacle opposite
  float squeezed = 0;  ///< 1: the two are so near to each other that all water between them is a film, 0: not
  float in_corner = 0;  ///< 1: with the water at an obstacle beside it the column is no film, 0: it is
};

/// A film over an obstacle and, perhaps, below another one.
struct FilmLayer {
  double height = 0, sinks = 1;
  double grid_height = 0;  ///< its thickness on the grid
  double opposite = 0;     ///< 1: there is an obstacle opposite, 0: there is none
  double other_height = 0, other_sinks = 0;
  double squeezed = 0, thin = 0;

  FilmLayer() = default;
  /// `wetness`: 1 where films reach down to the obstacle, 0 where they stay where the particles are.
  FilmLayer(const FilmParticle& p, double wetness)
      : height(double(p.mean_height)),
        sinks(wetness * double(p.sinks)),
        grid_height(double(p.grid_height)),
        opposite(p.other == none ? 0 : 1),
        other_height(double(p.other_height)),
        other_sinks(wetness * double(p.other_sinks)),
        squeezed(double(p.squeezed)),
        thin(double(p.thin)) {}

  /// The distance of its middle from the obstacle, with this thickness and the clearance of both (R.40).
  double middle(double thickness, double clearance) const;
  double lower(double thickness, double clearance) const {
    return std::max(clearance, middle(thickness, clearance) - thickness / 2);
  }
};

class Film {
 public:
  Film() = default;
  /// The obstacles' queries must be prepared; `cell` in metres.
  Film(const FilmRule& rule, const ParticleBlocks& particles, const Water& water, const Obstacles& obstacles,
       double cell, const Workers& workers);

  bool empty() const { return items_.empty(); }
  const FilmRule& rule() const { return rule_; }
  /// Null if particle p of ParticleBlocks is not near an obstacle.
  const FilmParticle* find(std::uint32_t p) const {
    return items_.empty() || index_[p] == none ? nullptr : &items_[index_[p]];
  }
  /// The same particle at the obstacle opposite, or null.
  const FilmParticle* opposite(const FilmParticle& item) const {
    return item.other == none ? nullptr : &items_[item.other];
  }

 private:
  void find_heights(const ParticleBlocks& particles, const Obstacles& obstacles, double cell,
                    const Workers& workers);
  template <class F>
  void for_items(const ParticleBlocks& particles, double reach, const Workers& workers, const F& f) const;
  void part_films(const ParticleBlocks& particles, const Water& water, const Workers& workers);
  bool forms_film(const FilmParticle& item) const;
  void find_radii(const ParticleBlocks& particles, const Workers& workers);
  void find_shares(const ParticleBlocks& particles, const Water& water, const Workers& workers);

  FilmRule rule_;
  std::vector<std::uint32_t> index_;  // per particle: its item, or none
  std::vector<FilmParticle> items_;
};

/// 1 where films reach down to the obstacle, 0 where they stay where the particles are.
inline float film_wetness(ObstacleMode mode, const NearBlock& near, std::size_t node) {
  if (mode != ObstacleMode::wet) return mode == ObstacleMode::touch ? 1.0f : 0.0f;
  return near.wetness.empty() ? 0.0f : near.wetness[node];
}

/// Films at the vertices of the mesh.
struct FilmVertices {
  std::vector<float> thickness;  ///< of the water there [cells]; 0 away from films
  std::vector<float> share;      ///< 1: the vertex is of a film, 0: it is not
};

/// Moves the vertices of films to the thickness of the water, but not those on the sides of `clip`.
/// `polygonised`: the positions to which mesh.distances belong.
FilmVertices thin_films(const Film& film, ObstacleMode mode, const ParticleBlocks& particles,
                        const Grid& grid, const std::vector<std::array<float, 3>>& polygonised,
                        const std::optional<Box>& clip, RawMesh& mesh, const Workers& workers);

}  // namespace oilskin::reconstruction
