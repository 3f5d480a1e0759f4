/// The box around a box that is put elsewhere.
#pragma once

#include "oilskin/types.h"

namespace oilskin {

/// `place` gives where a point goes; it is linear, and a constant.
template <class F>
Box box_around(const Box& box, const F& place) {
  Box around;
  for (int c = 0; c < 8; ++c)
    around.add(place(Vec3(c & 1 ? box.max.x() : box.min.x(), c & 2 ? box.max.y() : box.min.y(),
                          c & 4 ? box.max.z() : box.min.z())));
  return around;
}

}  // namespace oilskin
