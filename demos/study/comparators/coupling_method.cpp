#include "study/comparators/coupling_method.h"

#include <stdexcept>

#include "study/comparators/make_methods.h"

namespace oilskin::study {

const char* name_of(Method method) {
  switch (method) {
    case Method::oilskin:
      return "oilskin";
    case Method::paper:
      return "paper";
    case Method::repulsion:
      return "repulsion";
    case Method::penalty:
      return "penalty";
    case Method::boundary_particles:
      return "boundary_particles";
    case Method::position_based:
      return "position_based";
  }
  return "";
}

double wall_distance(Method method) {
  return method == Method::boundary_particles ? 1 : 0.5;
}

Vec3 CouplingMethod::momentum() const {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& v : velocities()) sum += v;
  return particle_mass() * sum;
}

std::unique_ptr<CouplingMethod> make_method(Method method, const MethodSettings& settings) {
  if (!(settings.spacing > 0 && settings.rest_density > 0 && settings.thickness > 0 &&
        settings.tolerance > 0))
    throw std::invalid_argument("spacing, rest_density, thickness and tolerance must be > 0");
  if (!(settings.viscosity >= 0) || settings.max_substeps.value_or(1) < 1)
    throw std::invalid_argument("viscosity must be >= 0, max_substeps >= 1");
  switch (method) {
    case Method::oilskin:
    case Method::paper:
    case Method::repulsion:
      return make_world_method(method, settings);
    case Method::penalty:
      return make_penalty_method(settings);
    case Method::boundary_particles:
      return make_boundary_particle_method(settings);
    case Method::position_based:
      return make_position_based_method(settings);
  }
  throw std::invalid_argument("there is no such method");
}

}  // namespace oilskin::study
