#include "scene/scene_library.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "scene/fields.h"
#include "scene/scene_reader.h"

namespace oilskin::demo {
namespace {

namespace fs = std::filesystem;

std::string find_scene_file(const std::string& scene) {
  if (scene.find('/') != std::string::npos || fs::path(scene).extension() == ".json") {
    if (!fs::exists(scene)) throw SceneError(scene + ": there is no such scene file");
    return scene;
  }
  const fs::path shipped = fs::path(scenes_directory()) / (scene + ".json");
  if (fs::exists(shipped)) return shipped.string();
  const std::vector<std::string> all = shipped_scenes();
  throw SceneError(scene + ": there is no such scene" + suggestion(scene, all) + ". Scenes: " + joined(all) +
                   ", or a path to a .json file");
}

}  // namespace

std::string scenes_directory() {
  if (const char* told = std::getenv("OILSKIN_SCENES")) return told;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path installed = program.parent_path().parent_path() / "share" / "oilskin" / "scenes";
  if (!error && fs::is_directory(installed)) return installed.string();
  return OILSKIN_SCENES_DIR;
}

std::vector<std::string> shipped_scenes() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(scenes_directory(), error))
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

Scene load_scene(const RunOptions& options) {
  const std::string file = find_scene_file(options.scene);
  Json json = read_json_file(file);
  if (!json.is_object()) throw SceneError(file + ": must hold a JSON object");
  if (options.duration) json["duration"] = *options.duration;
  if (options.dt) json["dt"] = *options.dt;
  if (options.seed) json["seed"] = *options.seed;
  if (options.frames_per_second)
    apply_override(json, "pictures.frames_per_second=" + std::to_string(*options.frames_per_second));
  for (const std::string& assignment : options.set) apply_override(json, assignment);
  Scene scene = read_scene(json, fs::path(file).parent_path().string());
  if (scene.name.empty()) scene.name = fs::path(file).stem().string();
  return scene;
}

}  // namespace oilskin::demo
