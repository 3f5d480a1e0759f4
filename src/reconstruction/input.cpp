// What the reconstruction accepts.
#include <cmath>

#include "core/refuse.h"
#include "reconstruction/run.h"

namespace oilskin::reconstruction {

Status validate_input(const ReconstructionInput& input, double spacing) {
  const std::size_t n = input.positions.size();
  const auto wrong_count = [n](const std::string& name, std::size_t count) {
    return refuse(name, " has ", count, " values; there are ", n, " positions");
  };
  if (n >= 0xfffffff0u) return Status::refused("positions: more than 2^32 − 16");
  if (!input.velocities.empty() && input.velocities.size() != n)
    return wrong_count("velocities", input.velocities.size());
  if (!input.volumes.empty() && input.volumes.size() != n)
    return wrong_count("volumes", input.volumes.size());
  const double most = max_particle_volume(spacing);
  for (std::size_t i = 0; i < input.volumes.size(); ++i)
    if (!within(input.volumes[i], 0, most))
      return refuse("volume ", i, " is ", input.volumes[i], "; it must be 0 … ", most,
                    " m³ (1000 spacings³)");
  for (std::size_t a = 0; a < input.attributes.size(); ++a) {
    const ParticleAttribute& attribute = input.attributes[a];
    const std::string name = "attribute " + std::to_string(a);
    if (attribute.components < 1)
      return refuse(name, ": components is ", attribute.components, "; it must be ≥ 1");
    if (attribute.values.size() != n * std::size_t(attribute.components))
      return wrong_count(name + " of " + std::to_string(attribute.components) + " components",
                         attribute.values.size());
  }
  return validate_obstacles(input.obstacles);
}

}  // namespace oilskin::reconstruction

namespace oilskin {

/// A thousand: ten times as wide a particle as the others. The rest: however the limit was computed.
double max_particle_volume(double spacing) {
  return 1000 * std::pow(spacing, 3) * (1 + 1e-9);
}

}  // namespace oilskin
