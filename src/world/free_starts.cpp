#include "world/free_starts.h"

#include <algorithm>

#include "world/point_cells.h"

namespace oilskin::world {

namespace {

/// Least distance of a point of a volume from surfaces [dx]. A lattice beside one has half a spacing. Nearer
/// points count as compressed by up to a half: filled around a sphere, a tank made a tenth of its energy
/// (docs/decisions/0029-volumes-that-cross-walls.md).
constexpr double from_surfaces = 0.2;

/// From other water [dx]: no place in a full cubic lattice is farther than 0.87 from its points.
constexpr double from_water = 0.9;

/// Blocks points of volumes at surfaces.
void block_crowded(const std::vector<fluid::Start>& starts, const std::vector<Vec3>& points,
                   Span<const StandingSurface> surfaces, double spacing, const Workers& workers,
                   std::vector<std::uint8_t>& blocked) {
  std::vector<std::uint8_t> of_volumes = blocked;
  for (std::size_t k = 0; k < starts.size(); ++k) of_volumes[k] |= starts[k].volume == 0;
  block_crowded_points(surfaces, from_surfaces * spacing, spacing, points, workers, of_volumes);
  for (std::size_t k = 0; k < starts.size(); ++k)
    if (starts[k].volume != 0) blocked[k] = of_volumes[k];
}

/// Blocks points of volumes near to particles, and to points of volumes before them.
void block_taken(const std::vector<fluid::Start>& starts, double distance, Span<const Vec3> particles,
                 std::vector<fluid::Outcome>& outcomes) {
  Box bounds;
  for (std::size_t k = 0; k < starts.size(); ++k)
    if (starts[k].volume != 0 && outcomes[k] == fluid::Outcome::emitted) bounds.add(starts[k].position);
  bounds = bounds.inflated(distance);
  PointCells taken(distance);
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (bounds.contains(particles[i])) taken.add(i, particles[i]);
  for (std::size_t begin = 0, end = 0; begin < starts.size(); begin = end) {
    while (end < starts.size() && starts[end].volume == starts[begin].volume) ++end;
    if (starts[begin].volume == 0) continue;
    for (std::size_t k = begin; k < end; ++k)
      if (outcomes[k] == fluid::Outcome::emitted && taken.has_near(starts[k].position))
        outcomes[k] = fluid::Outcome::blocked;
    for (std::size_t k = begin; k < end && end < starts.size(); ++k)
      if (outcomes[k] == fluid::Outcome::emitted) taken.add(k, starts[k].position);
  }
}

}  // namespace

std::vector<fluid::Outcome> judge_starts(const std::vector<fluid::Start>& starts, const FluidSettings& fluid,
                                         const Box& kill_box, const ActiveSurfaces& surfaces,
                                         const fluid::Particles& particles, const Workers& workers) {
  const std::vector<StandingSurface> standing = surfaces.at_start();
  std::vector<Vec3> points;
  points.reserve(starts.size());
  for (const fluid::Start& s : starts) points.push_back(s.position);
  std::vector<std::uint8_t> blocked = find_blocked_points(standing, points, workers);
  const bool has_volumes =
      std::any_of(starts.begin(), starts.end(), [](const fluid::Start& s) { return s.volume != 0; });
  if (has_volumes && fluid.boundary == BoundaryModel::mirrored)
    block_crowded(starts, points, standing, fluid.spacing, workers, blocked);
  std::vector<fluid::Outcome> outcomes(points.size(), fluid::Outcome::emitted);
  for (std::size_t k = 0; k < points.size(); ++k)
    if (blocked[k] || !kill_box.contains(points[k])) outcomes[k] = fluid::Outcome::blocked;
  if (has_volumes) block_taken(starts, from_water * fluid.spacing, particles.position, outcomes);
  return outcomes;
}

}  // namespace oilskin::world
