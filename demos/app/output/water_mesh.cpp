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
  return check.open_edges + check.crowded_edges + check.misoriented_edges + check.pinched_vertices +
         check.turned_components;
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

std::vector<std::string> doubts_about(Span<const Vec3> positions, double spacing) {
  // Of water at rest it is about 0.9; where water is pressed, half of that.
  constexpr double nearest_min = 0.5, nearest_max = 2.5;
  constexpr std::size_t many = 100;
  std::vector<std::string> doubts;
  if (positions.size() < many) return doubts;
  std::vector<Vec3> sorted(positions.begin(), positions.end());
  const auto is_before = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::sort(sorted.begin(), sorted.end(), is_before);
  std::size_t doubled = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) doubled += sorted[i] == sorted[i - 1];
  if (doubled > 0)
    doubts.push_back(std::to_string(doubled) + " of " + std::to_string(positions.size()) +
                     " particles lie where another one lies");
  const double nearest = median_nearest_distance(positions);
  if (nearest > 0 && (nearest < nearest_min * spacing || nearest > nearest_max * spacing)) {
    std::ostringstream text;
    text << "half of the particles have their nearest neighbour within " << nearest << " m, the spacing is "
         << spacing << " m: is it that of these particles?";
    doubts.push_back(text.str());
  }
  return doubts;
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
