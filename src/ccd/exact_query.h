/// The exact answer where rounding cannot decide. Internal to the room.
#pragma once

#include "ccd/separation.h"

namespace oilskin::ccd::detail {

/// Do the paths touch, and when first? Exact for any finite input, flat and degenerate triangles included.
/// The time is that of the first touch, rounded down to a multiple of 2⁻⁵² or by a few units more. What is
/// not finite is a hit at 0.
///
/// Takes 2 to 10 µs where the coordinates of each axis differ by less than 2⁷⁰ in size, and more, up to 400
/// where the least numbers there are stand beside ordinary ones; 192 KiB of stack (no other memory).
Impact exact_impact(const PointTriangleMotion& m);

/// The same where it is known that nothing touches before `first` begins: of a touch within `first` no more
/// is asked than whether there is one; its time may be the beginning of `first`.
Impact exact_impact_from(const PointTriangleMotion& m, const TimeSpan& first);

enum class Placement { kPositiveSide, kNegativeSide, kInside, kOutside, kUnknown };

/// Where the point is at the start of the step (end = 0) or at its end (1): on which side of the triangle's
/// plane, the sign being that of the cubic; or in the plane, and inside or outside the closed triangle. A
/// tenth of the price of a meeting, but unknown where coordinates on one axis differ by more than 2⁷⁰ in
/// size, or the triangle has no area.
Placement exact_placement(const PointTriangleMotion& m, int end);

}  // namespace oilskin::ccd::detail
