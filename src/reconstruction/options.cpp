#include <cmath>
#include <sstream>

#include "oilskin/reconstruction.h"

namespace oilskin {

namespace {

template <class T>
Status wrong(const char* field, const T& value, const char* range) {
  std::ostringstream s;
  s << field << " is " << value << "; it must be " << range;
  return Status::refused(s.str());
}

bool within(double x, double low, double high) {
  return x >= low && x <= high;
}

}  // namespace

Status ReconstructionOptions::validate() const {
  if (!within(spacing, 1e-6, 1e3)) return wrong("spacing", spacing, "1e-6 … 1e3 m");
  if (!within(cell, 0.1, 1)) return wrong("cell", cell, "0.1 … 1 (spacings)");
  if (!within(kernel_radius, 1.5, 4)) return wrong("kernel_radius", kernel_radius, "1.5 … 4 (spacings)");
  if (!within(particle_radius, 0.1, 1))
    return wrong("particle_radius", particle_radius, "0.1 … 1 (spacings)");
  if (static_cast<int>(field) < 0 || static_cast<int>(field) > static_cast<int>(ReconstructionField::density))
    return wrong("field", static_cast<int>(field), "a SurfaceField");
  if (static_cast<int>(contact) < 0 || static_cast<int>(contact) > static_cast<int>(ObstacleMode::overlap))
    return wrong("contact", static_cast<int>(contact), "a SurfaceContact");
  if (!within(gap, 0, spacing)) return wrong("gap", gap, "0 … 1 spacing, in metres");
  if (!within(touch_range, 0, 1.5)) return wrong("touch_range", touch_range, "0 … 1.5 (spacings)");
  if (!within(overlap_depth, 0, spacing))
    return wrong("overlap_depth", overlap_depth, "0 … 1 spacing, in metres");
  if (smoothing_iterations < 0 || smoothing_iterations > 1000)
    return wrong("smoothing_iterations", smoothing_iterations, "0 … 1000");
  if (clip) {
    for (int a = 0; a < 3; ++a)
      if (!(std::isfinite(clip->min[a]) && std::isfinite(clip->max[a]) && clip->min[a] < clip->max[a]))
        return wrong("clip", clip->min[a], "a finite box with min < max");
  }
  if (!(min_blob >= 0) || !std::isfinite(min_blob))
    return wrong("min_blob", min_blob, "finite and ≥ 0 (spacings³)");
  if (!(memory_limit > 0)) return wrong("memory_limit", memory_limit, "> 0 bytes");
  if (threads < 0 || threads > 1024) return wrong("threads", threads, "0 … 1024");
  return {};
}

}  // namespace oilskin
