/// Scenes without an engine.
#pragma once

#include "hosts/simulation.h"

namespace oilskin::demo {

/// Throws SceneError for what is refused.
std::unique_ptr<Simulation> make_mock_simulation(const Scene& scene, const SimulationOptions& options);

}  // namespace oilskin::demo
