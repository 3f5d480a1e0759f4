#include <cmath>

#include "core/refuse.h"
#include "oilskin/reconstruction.h"

namespace oilskin {

Status ReconstructionOptions::validate() const {
  if (!within(spacing, 1e-6, 1e3)) return refuse_value("spacing", spacing, "1e-6 … 1e3 m");
  if (!within(cell, 0.1, 1)) return refuse_value("cell", cell, "0.1 … 1 (spacings)");
  if (!within(kernel_radius, 1.5, 4))
    return refuse_value("kernel_radius", kernel_radius, "1.5 … 4 (spacings)");
  if (!within(particle_radius, 0.1, 1))
    return refuse_value("particle_radius", particle_radius, "0.1 … 1 (spacings)");
  if (static_cast<int>(field) < 0 || static_cast<int>(field) > static_cast<int>(ReconstructionField::density))
    return refuse_value("field", static_cast<int>(field), "a ReconstructionField");
  if (static_cast<int>(contact) < 0 || static_cast<int>(contact) > static_cast<int>(ObstacleMode::wet))
    return refuse_value("contact", static_cast<int>(contact), "an ObstacleMode");
  if (!within(gap, 0, spacing)) return refuse_value("gap", gap, "0 … 1 spacing, in metres");
  if (!within(touch_range, 0, 1.5)) return refuse_value("touch_range", touch_range, "0 … 1.5 (spacings)");
  if (!within(wet_saturation, 0, 1)) return refuse_value("wet_saturation", wet_saturation, "0 … 1");
  if (!within(wet_blend, 0, 1)) return refuse_value("wet_blend", wet_blend, "0 … 1 (wet_saturation)");
  if (!within(overlap_depth, 0, spacing))
    return refuse_value("overlap_depth", overlap_depth, "0 … 1 spacing, in metres");
  if (smoothing_iterations < 0 || smoothing_iterations > 1000)
    return refuse_value("smoothing_iterations", smoothing_iterations, "0 … 1000");
  if (clip) {
    for (int a = 0; a < 3; ++a)
      if (!(std::isfinite(clip->min[a]) && std::isfinite(clip->max[a]) && clip->min[a] < clip->max[a]))
        return refuse_value("clip", clip->min[a], "a finite box with min < max");
  }
  if (!(min_blob >= 0) || !std::isfinite(min_blob))
    return refuse_value("min_blob", min_blob, "finite and ≥ 0 (spacings³)");
  if (!(memory_limit > 0)) return refuse_value("memory_limit", memory_limit, "> 0 bytes");
  if (threads < 0 || threads > 1024) return refuse_value("threads", threads, "0 … 1024");
  return {};
}

Status EllipsoidOptions::validate() const {
  if (!within(spacing, 1e-6, 1e3)) return refuse_value("spacing", spacing, "1e-6 … 1e3 m");
  if (!within(reach, 1, 4)) return refuse_value("reach", reach, "1 … 4 (spacings)");
  if (!within(max_stretch, 1, 20)) return refuse_value("max_stretch", max_stretch, "1 … 20");
  if (min_neighbours < 0 || min_neighbours > 1000)
    return refuse_value("min_neighbours", min_neighbours, "0 … 1000");
  if (!within(smoothing, 0, 1)) return refuse_value("smoothing", smoothing, "0 … 1");
  if (!within(gap, 0, spacing)) return refuse_value("gap", gap, "0 … 1 spacing, in metres");
  if (threads < 0 || threads > 1024) return refuse_value("threads", threads, "0 … 1024");
  return {};
}

}  // namespace oilskin
