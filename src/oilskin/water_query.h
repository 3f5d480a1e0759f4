/// @file
/// Questions about the water between two steps.
#pragma once

#include "oilskin/world.h"

namespace oilskin {

/// The water at one point.
struct WaterSample {
  /// Σ m W with the kernel poly6 [kg/m³]; walls add nothing, so it is lower beside a wall or a free surface.
  double density = 0;
  /// Σ m W v / Σ m W of World::motions() [m/s]; zero where no particle is within H.
  Vec3 velocity = Vec3::Zero();
};

/// A particle that was found.
struct WaterHit {
  /// Whether there is one; the other fields are set only then.
  bool found = false;
  /// The index of the particle in storage order.
  std::size_t particle = 0;
  /// ray(): where the ray enters the ball of the particle; nearest(): the particle's position [m].
  Vec3 place = Vec3::Zero();
  /// ray(): from the particle to `place`, unit; nearest(): zero.
  Vec3 normal = Vec3::Zero();
};

/// A copy of the particles of a world. It does not change the world, and does not follow it: make a new one
/// after each step. All functions are const and write nothing but their result: any number of threads may
/// call them at the same time. sample() reads the cells of width H around the point, sorted at construction,
/// O(n log n); the others visit all particles, O(n).
class WaterQuery {
 public:
  /// Copies the present particles. Particles that are not finite are left out of sample().
  explicit WaterQuery(const World& world);

  /// The volume at rest density [m³] of the particles whose centre is in the closed box. Refuses a box that
  /// is not finite or has min > max on an axis.
  Status volume(const Box& box, double* cubic_metres) const;
  /// The same in the closed ball of `radius` ≥ 0 around `center` [m].
  Status volume(const Vec3& center, double radius, double* cubic_metres) const;
  /// Density and velocity at a finite point [m].
  Status sample(const Vec3& point, WaterSample* water) const;
  /// The particle nearest to a finite point [m]; the first in storage order of equals.
  Status nearest(const Vec3& point, WaterHit* hit) const;
  /// The first ball of radius dx/2 around a particle that the way from → to [m] enters. A ball in which the
  /// way starts is not hit. Refuses points that are not finite, or equal.
  Status ray(const Vec3& from, const Vec3& to, WaterHit* hit) const;
  /// The level of the water on the line through `point` [m] along `up`: the largest s [m] for which the
  /// density of sample() at point + s·up/|up| is half of the rest density or more; negative below the point.
  /// At the surface of settled water it is half. Single particles do not count. `found` is false, and s zero,
  /// where the line has no such place. Refuses numbers that are not finite, and up = 0. Visits all particles.
  Status level(const Vec3& point, const Vec3& up, double* s, bool* found) const;
  /// Whether the centre of a particle is within `distance` ≥ 0 of a finite point [m]. Up to H it reads the
  /// cells around the point.
  Status is_near(const Vec3& point, double distance, bool* is) const;

  /// The positions that were copied [m].
  Span<const Vec3> positions() const { return position_; }
  /// The masses that were copied [kg].
  Span<const double> masses() const { return mass_; }
  /// ρ0 [kg/m³].
  double rest_density() const { return rest_density_; }
  /// dx [m].
  double spacing() const { return spacing_; }

 private:
  using Cell = std::array<double, 3>;
  Cell cell_of(const Vec3& x) const;
  template <class F>
  void visit_cells(const Vec3& point, double radius, const F& f) const;
  double kernel(double distance) const;
  /// A particle beside a line.
  struct Beside {
    double along, squared_distance, mass;
  };
  std::vector<Beside> beside_line(const Vec3& point, const Vec3& up) const;
  double density_on_line(const std::vector<Beside>& beside, double at) const;
  template <class Inside>
  double volume_where(const Inside& inside) const;

  std::vector<Vec3> position_, motion_;
  std::vector<double> mass_;
  std::vector<std::pair<Cell, std::size_t>> cells_;  // sorted
  double support_radius_, spacing_, rest_density_;
};

}  // namespace oilskin
