#include "study/cases/case_table.h"

#include <cmath>

namespace oilskin::demo {

double Quantity::error() const {
  const double by = scale > 0 ? scale : std::abs(reference);
  const double off = std::abs(value - reference) / by;
  return std::isfinite(off) ? off : never;
}

const std::vector<ValidationCase>& validation_cases() {
  static const std::vector<ValidationCase> all = {
      weight_case(),       dam_case(),          plate_case(90),      plate_case(60),     plate_case(30),
      moving_plate_case(), poiseuille_case(),   couette_case(),      slope_case(),       film_case(),
      half_pipe_case(),    taylor_green_case(), sheet_levels_case(), equal_heads_case(), buoyancy_case(),
      vessels_case(),      arch_case(),         pins_case(),         hammock_case(),     bag_case(),
      free_cloth_case(),   sloshing_case(),     torricelli_case(),   drift_case()};
  return all;
}

const ValidationCase& validation_case(const std::string& name) {
  std::vector<std::string> names;
  for (const ValidationCase& c : validation_cases()) {
    if (c.name == name) return c;
    names.push_back(c.name);
  }
  throw SceneError(name + ": there is no such validation case" + suggestion(name, names));
}

}  // namespace oilskin::demo
