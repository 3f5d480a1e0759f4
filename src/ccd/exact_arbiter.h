/// The exact answer where rounding cannot decide. Internal to the room.
#pragma once

#include "ccd/point_triangle.h"

namespace oilskin::ccd::detail {

/// Do the paths touch, and when first? Exact for any finite input, flat and degenerate triangles included.
/// The time is that of the first touch, rounded down to a multiple of 2⁻⁵² or by a few units more. What is
/// not finite is a hit at 0.
///
/// Takes some microseconds for coordinates of similar size and 192 KiB of stack (no other memory).
Meeting exact_meeting(const PointTriangleMotion& m);

}  // namespace oilskin::ccd::detail
