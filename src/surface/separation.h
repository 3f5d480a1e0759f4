/// How far are two triangles apart, at least? A direction along which both project to intervals with a gap
/// proves that gap, however the direction was found. So the answer is safe where closest features are ill
/// conditioned: at worst it is too small.
#pragma once

#include "surface/obstacles.h"

namespace oilskin::surface {

/// A lower bound of the distance of two closed triangles [m], rounding included; 0 where none was found.
/// Within rounding of the distance itself for triangles that are not slivers of a few ulp, unless it is
/// `enough`: then what was found first will do.
double certified_distance(const Corners& t, const Corners& c,
                          double enough = std::numeric_limits<double>::infinity());

/// Is it certain that the distance is more than `limit`? The same answer as certified_distance() > limit.
bool certified_apart(const Corners& t, const Corners& c, double limit);

}  // namespace oilskin::surface
