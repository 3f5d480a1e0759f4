// Bytes → the scene reader, or the reader of OBJ meshes where they begin with "o ". Each must give a scene or
// a message; a scene that was read is written and read again.
#include <filesystem>
#include <fstream>
#include <sstream>

#include "checks/acceptance.h"
#include "fuzz/fuzz_target.h"
#include "scene/obj_reader.h"
#include "scene/scene_reader.h"

namespace oilskin::fuzz {

namespace {

/// Every key that names a file names this one: the fuzzer must not read /dev/zero.
void name_small_mesh(demo::Json& json) {
  if (!json.is_structured()) return;
  for (auto& [key, value] : json.items()) {
    if ((key == "mesh" || key == "file") && value.is_string()) value = "tetrahedron.obj";
    name_small_mesh(value);
  }
}

void read_mesh(const std::string& text) {
  std::istringstream in(text);
  try {
    const demo::Mesh mesh = demo::read_obj(in, "fuzz.obj");
    for (const Triangle& t : mesh.triangles)
      for (std::uint32_t v : t) expect(v < mesh.vertices.size(), "triangles name vertices that there are");
  } catch (const demo::SceneError&) {
  }
}

void read_scene(const std::string& text) {
  try {
    demo::Json json = demo::parse_json(text, "fuzz.json");
    name_small_mesh(json);
    const demo::Scene scene = demo::read_scene(json, OILSKIN_FUZZ_DATA);
    const demo::Json written = demo::resolved_scene(scene, demo::Acceptance(scene));
    const demo::Scene again = demo::read_scene(written, OILSKIN_FUZZ_DATA);
    expect(demo::resolved_scene(again, demo::Acceptance(again)) == written,
           "what is written of a scene reads as the same scene");
  } catch (const demo::SceneError&) {
  }
}

}  // namespace

std::vector<std::vector<std::uint8_t>> seeds() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(OILSKIN_SCENES))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<std::vector<std::uint8_t>> all;
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    all.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  const std::string mesh = "o quad\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf -4/1/1 -3 -2\n";
  all.emplace_back(mesh.begin(), mesh.end());
  return all;
}

}  // namespace oilskin::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 1 << 16) return 0;
  const std::string text(reinterpret_cast<const char*>(data), size);
  text.compare(0, 2, "o ") == 0 ? oilskin::fuzz::read_mesh(text) : oilskin::fuzz::read_scene(text);
  return 0;
}
