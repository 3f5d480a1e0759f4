/// The cases, each in a file of its own; case_table.cpp lists them.
#pragma once

#include "study/cases/case.h"

namespace oilskin::demo {

ValidationCase weight_case();
ValidationCase dam_case();
ValidationCase poiseuille_case();
ValidationCase couette_case();
ValidationCase slope_case();
ValidationCase film_case();
ValidationCase half_pipe_case();
ValidationCase taylor_green_case();
ValidationCase sheet_levels_case();
ValidationCase equal_heads_case();
ValidationCase buoyancy_case();
ValidationCase vessels_case();
ValidationCase arch_case();
ValidationCase pins_case();
ValidationCase hammock_case();
ValidationCase bag_case();
ValidationCase free_cloth_case();
ValidationCase sloshing_case();
ValidationCase torricelli_case();
ValidationCase drift_case();
/// A jet at an angle to a plate [degrees].
ValidationCase plate_case(int angle);
/// A jet on a plate that moves away at half its speed.
ValidationCase moving_plate_case();

}  // namespace oilskin::demo
