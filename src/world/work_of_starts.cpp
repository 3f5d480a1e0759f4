#include "world/work_of_starts.h"

#include <algorithm>
#include <limits>

#include "fluid/stability.h"
#include "world/point_cells.h"

namespace oilskin::world {

namespace {

/// Largest vertical distance of particles in a column of water, and largest distance from its axis [dx].
constexpr double column_gap = 2, column_radius = 1;

/// A start in water.
struct Submerged {
  Vec3 x;
  double pressure = 0;  ///< the largest within H [Pa]
};

std::vector<Submerged> find_submerged(const std::vector<Vec3>& starts, const fluid::Particles& particles,
                                      std::size_t live, double reach) {
  Box bounds;
  for (const Vec3& x : starts) bounds.add(x);
  bounds = bounds.inflated(reach);
  PointCells cells(reach);
  for (std::size_t i = 0; i < live; ++i)
    if (particles.pressure[i] > 0 && bounds.contains(particles.position[i]))
      cells.add(i, particles.position[i]);
  std::vector<Submerged> found;
  for (const Vec3& x : starts) {
    double pressure = 0;
    cells.for_near(x, [&](std::size_t i) { pressure = std::max(pressure, particles.pressure[i]); });
    if (pressure > 0) found.push_back({x, pressure});
  }
  return found;
}

/// How far water reaches up from a place [m]. `heights` of the particles in the column, in any order.
double depth_of(double height, std::vector<double>& heights, double spacing) {
  std::sort(heights.begin(), heights.end());
  double top = height;
  for (const double h : heights) {
    if (h > top + column_gap * spacing) break;
    top = std::max(top, h);
  }
  return top - height;
}

}  // namespace

double work_of_starts(const std::vector<fluid::Start>& starts, const std::vector<fluid::Outcome>& outcomes,
                      const fluid::Particles& particles, std::size_t live, const Vec3& gravity,
                      const FluidSettings& fluid, double particle_mass) {
  const double g = gravity.norm();
  std::vector<Vec3> places;
  for (std::size_t k = 0; k < starts.size(); ++k)
    if (starts[k].volume == 0 && outcomes[k] == fluid::Outcome::emitted) places.push_back(starts[k].position);
  if (places.empty() || !(g > 0)) return 0;
  const std::vector<Submerged> submerged =
      find_submerged(places, particles, live, fluid::support_radius(fluid));
  if (submerged.empty()) return 0;

  const Vec3 up = -gravity / g;
  const auto across = [&](const Vec3& x) { return Vec3(x - x.dot(up) * up); };
  Box bounds;
  double lowest = std::numeric_limits<double>::infinity();
  for (const Submerged& s : submerged) {
    bounds.add(across(s.x));
    lowest = std::min(lowest, s.x.dot(up));
  }
  const double radius = column_radius * fluid.spacing;
  bounds = bounds.inflated(radius);
  PointCells columns(radius);
  for (std::size_t i = 0; i < live; ++i) {
    const Vec3& x = particles.position[i];
    if (x.dot(up) >= lowest && bounds.contains(across(x))) columns.add(i, across(x));
  }

  double work = 0;
  std::vector<double> heights;
  for (const Submerged& s : submerged) {
    const double height = s.x.dot(up);
    heights.clear();
    columns.for_near(across(s.x), [&](std::size_t i) {
      if (const double h = particles.position[i].dot(up); h >= height) heights.push_back(h);
    });
    const double depth = depth_of(height, heights, fluid.spacing);
    work += particle_mass * std::min(g * depth, s.pressure / fluid.rest_density);
  }
  return work;
}

}  // namespace oilskin::world
