// The scene of small_scene_text.h, ready to run.
#pragma once

#include "hosts/bullet_simulation.h"
#include "scene/scene_reader.h"
#include "view/small_scene_text.h"
#include "view/viewer.h"

namespace oilskin::test {

/// `host`: bullet or mock. `more`: overrides, as on the command line.
inline demo::Scene small_scene(const std::string& host = "mock", const std::vector<std::string>& more = {}) {
  demo::Json json = demo::parse_json(small_scene_text, "small");
  json["host"] = host;
  for (const std::string& assignment : more) demo::apply_override(json, assignment);
  return demo::read_scene(json, ".");
}

/// One thread: the tests run side by side.
inline demo::SimulationOptions one_thread() {
  demo::SimulationOptions options;
  options.threads = 1;
  return options;
}

inline demo::LiveScene live_scene(const demo::Scene& scene) {
  return demo::LiveScene(scene, one_thread(), demo::make_simulation);
}

inline void take_steps(demo::LiveScene& live, int count) {
  for (int k = 0; k < count; ++k) live.step();
}

}  // namespace oilskin::test
