/// Scene files: JSON → Scene and back.
#pragma once

#include <string>
#include <vector>

#include "scene/fields.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// Sets one key by its dotted path, e.g. cloth.0.thickness=0.0005. The value is JSON, or else a text. Objects
/// on the way are made where they are missing; places of lists must exist (or be the next one). Throws
/// SceneError.
void apply_override(Json& scene, const std::string& assignment);

/// Parses text; a key that is written twice in one object is refused. `name` stands in messages.
Json parse_json(const std::string& text, const std::string& name);
Json read_json_file(const std::string& path);

/// Checks everything that can be checked without a world, and loads the meshes. The checks of the run are
/// read by Acceptance (checks/acceptance.h). Throws SceneError.
Scene read_scene(const Json& json, const std::string& directory);

/// The scene with every value as resolved, `acceptance` as it was read; read_scene() of it gives the same
/// scene.
Json write_scene(const Scene& scene);

}  // namespace oilskin::demo
