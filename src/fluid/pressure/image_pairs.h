/// The pressure gradient along walls that the images of a particle's neighbours add (docs/theory/boundary.md,
/// section 5).
///
/// Walls push along their normals, so that a particle at a wall lacks the part of the pressure gradient along
/// the wall that comes from beyond it: 15 % at one wall, 31 % in a slot of one spacing, and the pressures
/// were higher by as much. In a mirror the image of j acts on i along the wall with the opposite of what the
/// image of i does to j, so it is a pair term of i and j.
#pragma once

#include "fluid/pressure/step_state.h"
#include "fluid/pressure/tensor_array.h"

namespace oilskin::fluid {

/// Adds f_ij (B.32) to the stored slopes w'/q of the pairs at walls.
void add_image_slopes(StepState& state);
/// The same, and adds what that changes of Σ w'/q Δ and of Σ |w'|² (Record::w) to the particles' `sums`, and
/// of Σ w'/q Δ ⊗ Δ to `moments`; the latter may be empty.
void add_image_slopes(StepState& state, std::vector<Record>& sums, TensorArray& moments);

}  // namespace oilskin::fluid
