/// What the reader says of a scene.
#pragma once

#include <string>

#include "checks/acceptance.h"
#include "scene/scene_reader.h"

namespace oilskin::test {

/// The refusal of a scene, with its acceptance checks; empty where it is accepted.
inline std::string message_of(const std::string& json) {
  try {
    const demo::Scene scene = demo::read_scene(demo::parse_json(json, "test"), ".");
    demo::Acceptance acceptance(scene);
  } catch (const demo::SceneError& e) {
    return e.what();
  }
  return "";
}

}  // namespace oilskin::test
