/// Particles so close that the kernel does not part them: its slope falls to 0 with their distance, and what
/// is in one place stays there (F.86).
#pragma once

#include "fluid/pressure/step_state.h"

namespace oilskin::fluid {

/// Below it a pair is close [dx]. Settled water has no pair below 0.6; layers that contact alone holds have
/// some below a quarter.
constexpr double closest_spacing = 0.1;

/// Adds to state.dv what parts each close pair that is slower than (r₀ − r)/t with that speed, along its
/// line. The momentum of a pair does not change. After run_explicit_sums() has set state.is_close.
/// `support_radius`: H [m].
void part_close_pairs(StepState& state, double spacing, double support_radius);

}  // namespace oilskin::fluid
