/// The makers of the methods, for make_method() alone.
#pragma once

#include "study/comparators/coupling_method.h"

namespace oilskin::study {

/// `method`: oilskin, paper or repulsion.
std::unique_ptr<CouplingMethod> make_world_method(Method method, const MethodSettings& settings);
std::unique_ptr<CouplingMethod> make_penalty_method(const MethodSettings& settings);
std::unique_ptr<CouplingMethod> make_boundary_particle_method(const MethodSettings& settings);
std::unique_ptr<CouplingMethod> make_position_based_method(const MethodSettings& settings);

}  // namespace oilskin::study
