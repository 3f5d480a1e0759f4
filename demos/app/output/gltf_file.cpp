#include "output/gltf_file.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "oilskin/version.h"
#include "output/output_error.h"
#include "output/write_file.h"
#include "scene/fields.h"

namespace oilskin::demo {
namespace {

// Arrays are copied as they lie in memory; glTF is little endian.
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);

using Halves = std::array<std::uint16_t, 2>;

/// Builds a model whose arrays lie one after the other in one buffer.
class GltfModel {
 public:
  explicit GltfModel(const SurfaceFile& file);

  std::string bytes();

 private:
  /// Returns the number of the accessor.
  int add(const void* data, std::size_t count, std::size_t size, int component, int type, int target);
  int add_positions(const WaterMesh& mesh);
  int add_channel(const VertexChannel& channel);
  void add_mesh(const SurfaceFile& file);

  tinygltf::Model model_;
};

GltfModel::GltfModel(const SurfaceFile& file) {
  model_.asset.version = "2.0";
  model_.asset.generator = "oilskin " OILSKIN_VERSION_STRING;
  model_.asset.extras = tinygltf::Value({{"made_with", tinygltf::Value(file.made_with)}});
  // Arrays of length 0 are not allowed.
  if (!file.mesh.triangles.empty()) add_mesh(file);
}

int GltfModel::add(const void* data, std::size_t count, std::size_t size, int component, int type,
                   int target) {
  std::vector<unsigned char>& bytes = model_.buffers[0].data;
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = bytes.size();
  view.byteLength = count * size;
  view.target = target;
  const auto* const first = static_cast<const unsigned char*>(data);
  bytes.insert(bytes.end(), first, first + view.byteLength);
  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model_.bufferViews.size());
  accessor.componentType = component;
  accessor.count = count;
  accessor.type = type;
  model_.bufferViews.push_back(view);
  model_.accessors.push_back(accessor);
  return static_cast<int>(model_.accessors.size()) - 1;
}

int GltfModel::add_positions(const WaterMesh& mesh) {
  const int number = add(mesh.positions.data(), mesh.positions.size(), sizeof mesh.positions[0],
                         TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
  std::vector<double> low(3, std::numeric_limits<double>::infinity()), high(3, -low[0]);
  for (const auto& p : mesh.positions)
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], double(p[k]));
      high[k] = std::max(high[k], double(p[k]));
    }
  model_.accessors.back().minValues = low;
  model_.accessors.back().maxValues = high;
  return number;
}

int GltfModel::add_channel(const VertexChannel& channel) {
  const int types[] = {TINYGLTF_TYPE_SCALAR, TINYGLTF_TYPE_VEC2, TINYGLTF_TYPE_VEC3, TINYGLTF_TYPE_VEC4};
  if (const auto* floats = std::get_if<std::vector<float>>(&channel.values))
    return add(floats->data(), floats->size() / channel.components(), sizeof(float) * channel.components(),
               TINYGLTF_COMPONENT_TYPE_FLOAT, types[channel.components() - 1], TINYGLTF_TARGET_ARRAY_BUFFER);
  std::vector<Halves> halves;
  for (const std::int32_t value : std::get<std::vector<std::int32_t>>(channel.values)) {
    const auto bits = static_cast<std::uint32_t>(value);
    halves.push_back({static_cast<std::uint16_t>(bits & 0xffff), static_cast<std::uint16_t>(bits >> 16)});
  }
  return add(halves.data(), halves.size(), sizeof(Halves), TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
             TINYGLTF_TYPE_VEC2, TINYGLTF_TARGET_ARRAY_BUFFER);
}

void GltfModel::add_mesh(const SurfaceFile& file) {
  const WaterMesh& mesh = file.mesh;
  model_.buffers.emplace_back();
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.attributes["POSITION"] = add_positions(mesh);
  primitive.attributes["NORMAL"] =
      add(mesh.normals.data(), mesh.normals.size(), sizeof mesh.normals[0], TINYGLTF_COMPONENT_TYPE_FLOAT,
          TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
  for (const VertexChannel& channel : file.channels) {
    std::string name = "_" + channel.name;
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
    primitive.attributes[name] = add_channel(channel);
  }
  primitive.indices =
      add(mesh.triangles.data(), 3 * mesh.triangles.size(), sizeof(std::uint32_t),
          TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  tinygltf::Mesh water;
  water.name = "water";
  water.primitives.push_back(primitive);
  model_.meshes.push_back(water);
  tinygltf::Node node;
  node.name = "water";
  node.mesh = 0;
  model_.nodes.push_back(node);
  model_.scenes.emplace_back();
  model_.scenes[0].nodes.push_back(0);
  model_.defaultScene = 0;
}

std::string GltfModel::bytes() {
  std::ostringstream out(std::ios::binary);
  tinygltf::TinyGLTF gltf;
  if (!gltf.WriteGltfSceneToStream(&model_, out, false, true)) return "";
  return out.str();
}

/// Bytes that the arrays of the mesh take.
std::uint64_t size_of(const SurfaceFile& file) {
  std::uint64_t per_vertex = 24;
  for (const VertexChannel& channel : file.channels) per_vertex += 4 * channel.components();
  return per_vertex * file.mesh.positions.size() + 12 * std::uint64_t(file.mesh.triangles.size());
}

}  // namespace

bool gltf_available() {
  return true;
}

void write_gltf(const std::string& path, const SurfaceFile& file) {
  // The header has 32 bits for the length of all; the text of the options and arrays' names takes the rest.
  constexpr std::uint64_t max_bytes = 0xfff00000u;
  if (size_of(file) > max_bytes)
    throw OutputError(path + ": cannot be written: its mesh is larger than a glTF file may be (4 GiB)");
  const std::string bytes = GltfModel(file).bytes();
  if (bytes.empty()) throw OutputError(path + ": cannot be written by TinyGLTF");
  write_file(path, bytes);
}

std::string gltf_made_with(const std::string& path) {
  // The header: magic number, version, length; then length and type of the chunk of JSON.
  std::uint32_t head[5] = {};
  std::ifstream in(path, std::ios::binary);
  constexpr std::uint32_t magic = 0x46546c67u, json_chunk = 0x4e4f534au, max_text = 1u << 20;
  if (!in.read(reinterpret_cast<char*>(head), sizeof head) || head[0] != magic || head[4] != json_chunk ||
      head[3] > max_text)
    return "";
  std::string text(head[3], ' ');
  if (!in.read(text.data(), static_cast<std::streamsize>(text.size()))) return "";
  const Json json = Json::parse(text, nullptr, false);
  const Json::json_pointer where("/asset/extras/made_with");
  return !json.is_discarded() && json.contains(where) && json[where].is_string()
             ? json[where].get<std::string>()
             : "";
}

bool gltf_is_whole(const std::string& path) {
  std::uint32_t head[3] = {};  // magic number, version, length
  std::ifstream in(path, std::ios::binary);
  std::error_code error;
  return in.read(reinterpret_cast<char*>(head), sizeof head) &&
         std::filesystem::file_size(path, error) == head[2] && !error;
}

}  // namespace oilskin::demo
