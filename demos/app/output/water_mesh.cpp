#include "output/water_mesh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

#include "scene/fields.h"

namespace oilskin::demo {
namespace {

/// Edges and vertices that a closed surface has none of.
std::size_t flaws_of(const MeshCheck& check) {
  return check.open_edges + check.crowded_edges + check.misoriented_edges + check.pinched_vertices;
}

/// Over a sample of the particles that is spread evenly through their order.
double median_nearest_distance(Span<const Vec3> positions) {
  constexpr std::size_t sample = 101;
  const std::size_t n = positions.size(), count = std::min(n, sample);
  std::vector<double> nearest;
  for (std::size_t s = 0; s < count; ++s) {
    const std::size_t i = s * n / count;
    double minimum = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < n; ++k)
      if (k != i) minimum = std::min(minimum, (positions[k] - positions[i]).squaredNorm());
    nearest.push_back(std::sqrt(minimum));
  }
  const auto middle = nearest.begin() + std::ptrdiff_t(count / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}

bool keeps_away(ObstacleMode mode) {
  return mode == ObstacleMode::gap || mode == ObstacleMode::touch || mode == ObstacleMode::wet;
}

}  // namespace

bool MadeMesh::as_promised(ObstacleMode mode) const {
  return keeps_away(mode) ? check.clean() : flaws_of(check) == 0;
}

Status check_spacing(Span<const Vec3> positions, double spacing, const std::string& which) {
  // Water at rest has neighbours at about a spacing, pressed water half of that; spray that is sparse all
  // over may have them anywhere.
  constexpr double nearest_min = 0.2, nearest_max = 100;
  constexpr std::size_t many = 100;
  if (positions.size() < 2) return {};
  const double nearest = median_nearest_distance(positions);
  const bool too_wide = nearest > 0 && nearest < nearest_min * spacing;
  const bool too_narrow = positions.size() >= many && nearest > nearest_max * spacing;
  if (!too_wide && !too_narrow) return {};
  std::ostringstream text;
  text << which << ": is " << spacing << " m, but half of the " << positions.size()
       << " particles have their nearest neighbour within " << nearest
       << " m: it should be about that. Is it in metres?";
  return Status::refused(text.str());
}

std::vector<double> water_volumes(std::size_t count, Span<const float> mass_ratio, double particle_mass,
                                  double rest_density) {
  std::vector<double> volumes(count, particle_mass / rest_density);
  for (std::size_t i = 0; i < mass_ratio.size(); ++i) volumes[i] *= double(mass_ratio[i]);
  return volumes;
}

MadeMesh make_mesh(const ReconstructionInput& input, const ReconstructionOptions& options) {
  MadeMesh made;
  const auto start = std::chrono::steady_clock::now();
  const Status status = reconstruct_surface(input, options, &made.mesh, &made.report);
  if (!status.ok()) throw SceneError("surface: " + status.message);
  made.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  made.check =
      check_mesh(made.mesh, input.obstacles, keeps_away(options.contact) ? options.gap : 0, options.threads);
  return made;
}

void MeshTotals::add(const MadeMesh& made) {
  ++frames;
  triangles = made.mesh.triangles.size();
  intersecting_pairs += made.check.intersecting_pairs;
  too_close_pairs += made.check.too_close_pairs;
  submerged += made.check.submerged_components;
  flaws += flaws_of(made.check);
  min_distance = std::min(min_distance, made.check.min_distance);
  seconds += made.seconds;
}

}  // namespace oilskin::demo
