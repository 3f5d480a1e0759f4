#include "scene/scene_reader.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>

#include "scene/obj_reader.h"
#include "scene/scene_format.h"
#include "scene/unused_keys.h"

namespace oilskin::demo {
namespace {

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> parts;
  std::istringstream in(path);
  for (std::string part; std::getline(in, part, '.');) parts.push_back(part);
  if (path.back() == '.') parts.emplace_back();
  return parts;
}

Json& element(Json& array, const std::string& part, const std::string& path) {
  char* end = nullptr;
  const unsigned long index = std::strtoul(part.c_str(), &end, 10);
  if (part.empty() || *end != '\0')
    throw SceneError("--set " + path + ": \"" + part + "\" must be an index, for it addresses a list");
  if (index > array.size())
    throw SceneError("--set " + path + ": index " + part + " is out of range, the list holds " +
                     std::to_string(array.size()));
  if (index == array.size()) array.push_back(Json());
  return array[index];
}

/// Watches the parser. Refuses JSON that is nested deeper than any scene file, since copying it could exhaust
/// the stack, and objects that have a key twice.
class KeyWatch {
 public:
  explicit KeyWatch(std::string name) : name_(std::move(name)) {}

  bool operator()(int depth, Json::parse_event_t event, Json& parsed) {
    constexpr int deepest = 64;
    if (depth > deepest)
      throw SceneError(name_ + ": is nested more than " + std::to_string(deepest) + " levels deep");
    if (event == Json::parse_event_t::object_start) keys_.emplace_back();
    if (event == Json::parse_event_t::object_end) keys_.pop_back();
    if (event == Json::parse_event_t::key && !keys_.back().insert(parsed.get<std::string>()).second)
      twice_ = parsed.get<std::string>();
    return true;
  }
  /// Of the whole text.
  void check() const {
    if (!twice_.empty()) throw SceneError(name_ + ": the key \"" + twice_ + "\" stands twice in one object");
  }

 private:
  std::string name_, twice_;
  std::vector<std::set<std::string>> keys_;
};

/// Cloths of one Bullet world share its sub-steps.
void check_substeps(const Scene& scene) {
  for (std::size_t i = 1; i < scene.cloth.size(); ++i)
    if (scene.cloth[i].substeps != scene.cloth[0].substeps)
      throw SceneError("cloth." + std::to_string(i) + ".substeps: is " +
                       std::to_string(scene.cloth[i].substeps) + ", must be " +
                       std::to_string(scene.cloth[0].substeps) +
                       " as for cloth.0: one world has one number of sub-steps");
}

void check_pins(const Scene& scene) {
  for (std::size_t c = 0; c < scene.cloth.size(); ++c) {
    const Cloth& cloth = scene.cloth[c];
    const std::string key = "cloth." + std::to_string(c) + ".pins";
    const bool grid_words = cloth.pins.kind == PinKind::corners || cloth.pins.kind == PinKind::border;
    if (cloth.mesh && cloth.pins.kind == PinKind::corners)
      throw SceneError(key + ": \"corners\" needs a grid; name nodes or boxes for a mesh");
    const int nodes =
        cloth.mesh ? static_cast<int>(cloth.mesh->mesh.vertices.size()) : cloth.grid[0] * cloth.grid[1];
    for (std::size_t i = 0; i < cloth.pins.nodes.size() && !grid_words; ++i)
      if (cloth.pins.nodes[i] >= nodes)
        throw SceneError(key + "." + std::to_string(i) + ": is " + std::to_string(cloth.pins.nodes[i]) +
                         ", must be a node, from 0 to " + std::to_string(nodes - 1));
  }
}

void check_status(const Status& status, const std::string& key) {
  if (!status.ok()) throw SceneError(key + ": " + status.message);
}

/// The library's own ranges come last, so that none is forgotten here.
void check_library_settings(const Scene& scene) {
  check_status(scene.world.validate(), "scene");
  check_status(scene.fluid.validate(), "fluid");
  check_status(scene.contact.validate(), "contact");
  for (std::size_t i = 0; i < scene.cloth.size(); ++i)
    check_status(scene.cloth[i].surface.validate(), "cloth." + std::to_string(i));
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    check_status(scene.bodies[i].surface.validate(), "bodies." + std::to_string(i));
}

void load_mesh(PlacedMesh& mesh, const std::string& directory, const std::string& key) {
  try {
    load(mesh, directory);
  } catch (const SceneError& e) {
    throw SceneError(key + ".mesh: " + e.what());
  }
}

void load_meshes(Scene& scene) {
  for (std::size_t i = 0; i < scene.cloth.size(); ++i)
    if (scene.cloth[i].mesh) load_mesh(*scene.cloth[i].mesh, scene.directory, "cloth." + std::to_string(i));
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (auto* mesh = std::get_if<PlacedMesh>(&scene.bodies[i].shape))
      load_mesh(*mesh, scene.directory, "bodies." + std::to_string(i));
  for (std::size_t i = 0; i < scene.emitters.size(); ++i)
    if (auto* emitter = std::get_if<PlacedMeshEmitter>(&scene.emitters[i].shape))
      load_mesh(emitter->mesh, scene.directory, "emitters." + std::to_string(i));
}

SceneError not_a_container(const std::string& path, const std::string& part, const Json& place) {
  const std::string value = place.dump();
  return SceneError("--set " + path + ": \"" + part + "\" addresses a part of " + value +
                    ", which is neither an object nor a list");
}

}  // namespace

void apply_override(Json& scene, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  const std::string path = assignment.substr(0, equals);
  if (equals == std::string::npos || path.empty())
    throw SceneError("--set " + assignment + ": must be KEY=VALUE, e.g. cloth.0.thickness=0.0005");
  Json* place = &scene;
  for (const std::string& part : split(path)) {
    if (part.empty()) throw SceneError("--set " + path + ": a part of the path is empty");
    if (place->is_null()) *place = Json::object();
    if (place->is_array()) {
      place = &element(*place, part, path);
    } else if (place->is_object()) {
      place = &(*place)[part];
    } else {
      throw not_a_container(path, part, *place);
    }
  }
  const std::string text = assignment.substr(equals + 1);
  KeyWatch watch("--set " + path);
  const Json value = Json::parse(text, std::ref(watch), false);
  if (!value.is_discarded()) watch.check();
  *place = value.is_discarded() ? Json(text) : value;
}

Json parse_json(const std::string& text, const std::string& name) {
  KeyWatch watch(name);
  Json json;
  try {
    json = Json::parse(text, std::ref(watch));
  } catch (const Json::exception& e) {
    throw SceneError(name + ": is not JSON: " + e.what());
  }
  watch.check();
  return json;
}

Json read_json_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  if (!in || std::filesystem::is_directory(path)) throw SceneError(path + ": the scene file cannot be read");
  return parse_json(text.str(), path);
}

Scene read_scene(const Json& json, const std::string& directory) {
  if (!json.is_object()) throw SceneError("scene: must be a JSON object");
  Scene scene;
  scene.directory = directory;
  Fields fields = Fields::reader(json, "");
  describe(fields, scene);
  fields.finish();
  load_meshes(scene);
  check_substeps(scene);
  check_pins(scene);
  check_library_settings(scene);
  scene.notes = unused_keys(json, scene);
  return scene;
}

Json write_scene(const Scene& scene) {
  Scene copy = scene;
  Json json;
  Fields fields = Fields::writer(json);
  describe(fields, copy);
  return json;
}

}  // namespace oilskin::demo
