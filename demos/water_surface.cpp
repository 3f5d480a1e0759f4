#include "water_surface.h"

#include <algorithm>
#include <chrono>
#include <sstream>

#include "fields.h"

namespace oilskin::demo {

bool MadeSurface::as_promised(SurfaceContact mode) const {
  const bool closed =
      check.open_edges + check.crowded_edges + check.misoriented_edges + check.pinched_vertices == 0;
  const bool keeps_away = mode == SurfaceContact::gap || mode == SurfaceContact::touch;
  return closed && (!keeps_away || check.clean());
}

Status check_water_surface(const WaterSurface& wanted, double spacing) {
  const auto range = [&](const char* key, double value, double least, double most) {
    std::ostringstream text;
    text << key << " is " << value << " m; it must be " << least << " … " << most << " m, of particles "
         << spacing << " m apart";
    return Status::refused(text.str());
  };
  if (wanted.cell > 0 && !(wanted.cell >= 0.1 * spacing && wanted.cell <= spacing))
    return range("cell", wanted.cell, 0.1 * spacing, spacing);
  if (!(wanted.gap <= spacing)) return range("gap", wanted.gap, 0, spacing);
  return surface_options(wanted, spacing, 0).validate();
}

SurfaceOptions surface_options(const WaterSurface& wanted, double spacing, int threads) {
  SurfaceOptions options;
  options.spacing = spacing;
  if (wanted.cell > 0) options.cell = wanted.cell / spacing;
  options.gap = wanted.gap;
  options.contact = wanted.mode;
  options.field = wanted.field;
  options.touch_range = wanted.touch_range;
  options.overlap_depth = wanted.overlap_depth;
  options.smoothing_iterations = wanted.smoothing;
  options.min_blob = wanted.min_blob;
  options.threads = threads;
  return options;
}

MadeSurface make_surface(const SurfaceInput& input, const SurfaceOptions& options) {
  MadeSurface made;
  const auto start = std::chrono::steady_clock::now();
  const Status status = reconstruct_surface(input, options, &made.mesh, &made.report);
  if (!status.ok()) throw SceneError("surface: " + status.message);
  made.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const bool keeps_away = options.contact == SurfaceContact::gap || options.contact == SurfaceContact::touch;
  made.check = check_surface(made.mesh, input.obstacles, keeps_away ? options.gap : 0, options.threads);
  return made;
}

void SurfaceTotals::add(const MadeSurface& made) {
  ++frames;
  triangles = made.mesh.triangles.size();
  intersecting_pairs += made.check.intersecting_pairs;
  near_pairs += made.check.near_pairs;
  submerged += made.check.submerged_components;
  flaws += made.check.open_edges + made.check.crowded_edges + made.check.misoriented_edges +
           made.check.pinched_vertices;
  least_distance = std::min(least_distance, made.check.least_distance);
  seconds += made.seconds;
}

}  // namespace oilskin::demo
