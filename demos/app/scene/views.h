/// From where a scene is looked at, and the ends of its colour scales.
#pragma once

#include "scene/scene.h"

namespace oilskin::demo {

/// The colours of a scale of the water, from deep blue to pale foam at equal distances: red, green, blue.
/// Lightness rises evenly, so that it reads in grey as well.
constexpr double water_colour_stops[6][3] = {{0.06, 0.13, 0.34}, {0.08, 0.30, 0.58}, {0.13, 0.49, 0.74},
                                             {0.30, 0.68, 0.83}, {0.58, 0.84, 0.88}, {0.90, 0.97, 0.95}};

/// What the scene fixes, at its start.
Box extents(const Scene& scene);

/// The scene's views; where it has none, from above and from below, around everything that the scene fixes.
std::vector<View> views_of(const Scene& scene);

/// The end of the scale of speeds [m/s]: what the fastest nozzle gives, and a little for the fall.
double colour_end(const Scene& scene);

}  // namespace oilskin::demo
