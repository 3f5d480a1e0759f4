/// Scenes on Bullet's soft bodies. Compiled twice, for single and for double precision: a program has one of
/// them.
#pragma once

#include "hosts/simulation.h"

namespace oilskin::demo {

/// Throws SceneError for what is refused.
std::unique_ptr<Simulation> make_bullet_simulation(const Scene& scene, const SimulationOptions& options);

/// Bullet in the precision of this program, or the mock host, as the scene says. Throws SceneError.
std::unique_ptr<Simulation> make_simulation(const Scene& scene, const SimulationOptions& options);

/// The host that this program was built with: bullet or bullet64.
HostKind built_in_host();

}  // namespace oilskin::demo
