/// All kernels for one type of eight lanes.
#pragma once

#include "fluid/pairs/edge_loops.h"
#include "fluid/pairs/gradient_loops.h"
#include "fluid/pairs/pair_loops.h"
#include "fluid/pairs/triangle_loops.h"

namespace oilskin::fluid {

template <class Lanes>
constexpr PairKernels kernels_of_lanes() {
  using Loops = PairLoops<Lanes>;
  return {Loops::start,
          Loops::density,
          Loops::pressure,
          Loops::pressure_exact,
          Loops::compression,
          GradientLoops<Lanes>::kernels(),
          Loops::columns,
          Loops::near,
          EdgeLoops<Lanes>::edges,
          TriangleLoops<Lanes>::hide,
          TriangleLoops<Lanes>::touching,
          TriangleLoops<Lanes>::closest};
}

}  // namespace oilskin::fluid
