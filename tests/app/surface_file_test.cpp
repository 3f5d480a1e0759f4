// Files of the water mesh for other programs: read back by readers that share no code with the writers.
#include "output/surface_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <sstream>

#include "app/program.h"
#include "output/gltf_file.h"
#include "output/mesh_file.h"
#include "output/output_error.h"
#include "output/vdb_file.h"
#include "scene/fields.h"
#include "scene/mesh_options.h"

namespace oilskin::test {
namespace {

using demo::SurfaceFile;
using demo::VertexChannel;
using Json = nlohmann::json;

/// A tetrahedron with numbers of its own at each vertex.
WaterMesh tetrahedron() {
  WaterMesh mesh;
  mesh.positions = {{0, 0, 0}, {0.1f, 0, 0}, {0, 0.25f, 0}, {0, 0, -3}};
  mesh.normals = {{0.6f, 0, 0.8f}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  mesh.velocities = {{1, 2, 2}, {0, -3, 4}, {0, 0, 0}, {0.5f, 0, 0}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  mesh.thickness = {0, 0.002f, 0.001f, 0};
  mesh.nearest = {2, 0, 1, WaterMesh::no_particle};
  return mesh;
}

const std::vector<std::uint64_t> ids = {7, 0x8000000bu, 70000};

std::vector<VertexChannel> all_channels(const WaterMesh& mesh, Span<const ObstacleMesh> obstacles = {}) {
  return demo::vertex_channels(demo::known_channels(), {mesh, obstacles, ids, 0.01});
}

SurfaceFile file_of(const WaterMesh& mesh) {
  return {mesh, all_channels(mesh), R"({"cell":0.004})", 0.004};
}

template <class T>
T number_at(const std::string& bytes, std::size_t at) {
  T value = {};
  EXPECT_LE(at + sizeof value, bytes.size());
  if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

const std::vector<float>& floats_of(const VertexChannel& channel) {
  return std::get<std::vector<float>>(channel.values);
}

TEST(VertexChannels, come_in_their_order_with_their_values) {
  const WaterMesh mesh = tetrahedron();
  const std::vector<VertexChannel> channels = all_channels(mesh);
  ASSERT_EQ(channels.size(), demo::known_channels().size());
  for (std::size_t i = 0; i < channels.size(); ++i) EXPECT_EQ(channels[i].name, demo::known_channels()[i]);
  EXPECT_EQ(floats_of(channels[0])[5], 4);
  EXPECT_EQ(floats_of(channels[1]), (std::vector<float>{3, 5, 0, 0.5f}));
  EXPECT_EQ(floats_of(channels[2]), (std::vector<float>{0, 0, 0, 0}));
  EXPECT_EQ(floats_of(channels[3]), mesh.thickness);
  const auto& id = std::get<std::vector<std::int32_t>>(channels[4].values);
  EXPECT_EQ(id, (std::vector<std::int32_t>{70000, 7, std::int32_t(0x8000000bu), -1}));
  // In whatever order they are asked for; what was not asked for is not there.
  const auto two = demo::vertex_channels({"id", "speed"}, {mesh, {}, ids, 0.01});
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].name, "speed");
}

TEST(VertexChannels, without_their_data_are_left_out) {
  WaterMesh mesh = tetrahedron();
  mesh.velocities.clear();
  mesh.thickness.clear();
  const auto channels = demo::vertex_channels(demo::known_channels(), {mesh, {}, {}, 0.01});
  ASSERT_EQ(channels.size(), 1u);
  EXPECT_EQ(channels[0].name, "wetness");
  const WaterMesh empty;
  EXPECT_TRUE(demo::vertex_channels(demo::known_channels(), {empty, {}, ids, 0.01}).empty());
}

TEST(VertexChannels, wetness_is_that_of_the_nearest_point_of_cloth_within_reach) {
  const std::vector<Vec3> corners = {Vec3(-1, 0, -1), Vec3(3, 0, -1), Vec3(-1, 0, 3)};
  const std::vector<Triangle> face = {{0, 1, 2}};
  // x + 1 over 4: linear.
  const std::vector<float> saturation = {0, 1, 0};
  const std::vector<ObstacleMesh> obstacles = {{corners, face}, {corners, face, saturation}};
  WaterMesh mesh = tetrahedron();
  mesh.positions = {{0, 0.004f, 0}, {0.5f, -0.004f, 0.25f}, {0, 0.02f, 0}, {1, 0.001f, 0}};
  const auto channels = demo::vertex_channels({"wetness"}, {mesh, obstacles, {}, 0.01});
  const std::vector<float> expected = {0.25f, 0.375f, 0, 0.5f};
  for (std::size_t v = 0; v < 4; ++v) EXPECT_NEAR(floats_of(channels[0])[v], expected[v], 1e-6) << v;
}

TEST(PlyFile, has_every_channel_behind_the_normal) {
  const Folder folder;
  const WaterMesh mesh = tetrahedron();
  demo::write_surface(folder.path(), 3, {"ply"}, file_of(mesh));
  const std::string bytes = folder.read("surface_0003.ply");
  const std::string end = "end_header\n";
  const std::size_t start = bytes.find(end) + end.size();
  std::istringstream header(bytes.substr(0, start));
  std::string names;
  for (std::string line; std::getline(header, line);)
    if (line.compare(0, 9, "property ") == 0 && line.find("list") == std::string::npos)
      names += line.substr(9) + ",";
  EXPECT_EQ(names,
            "float x,float y,float z,float nx,float ny,float nz,float vx,float vy,float vz,float speed,"
            "float wetness,float thickness,int id,");
  constexpr std::size_t stride = 52;
  ASSERT_EQ(bytes.size(), start + 4 * stride + 4 * 13);
  EXPECT_EQ(number_at<float>(bytes, start + stride + 32), 4);  // vz of vertex 1
  EXPECT_EQ(number_at<float>(bytes, start + stride + 36), 5);  // its speed
  EXPECT_EQ(number_at<float>(bytes, start + stride + 44), mesh.thickness[1]);
  EXPECT_EQ(number_at<std::int32_t>(bytes, start + 48), 70000);  // id of vertex 0
  EXPECT_EQ(demo::surface_made_with(folder.path("surface_0003.ply"), "ply"), R"({"cell":0.004})");
}

/// The chunks of a binary glTF file.
struct Glb {
  Json json;
  std::string binary;

  explicit Glb(const std::string& bytes) {
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(number_at<std::uint32_t>(bytes, 4), 2u);
    EXPECT_EQ(number_at<std::uint32_t>(bytes, 8), bytes.size());
    const std::size_t length = number_at<std::uint32_t>(bytes, 12);
    json = Json::parse(bytes.substr(20, length), nullptr, false);
    if (bytes.size() > 20 + length) binary = bytes.substr(28 + length);
  }
  std::size_t start_of(const Json& accessor) const {
    const Json& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    EXPECT_EQ(view.value("byteOffset", 0) % 4, 0);
    return view.value("byteOffset", std::size_t(0)) + accessor.value("byteOffset", std::size_t(0));
  }
  const Json& attribute(const std::string& name) const {
    return json["accessors"][json["meshes"][0]["primitives"][0]["attributes"][name].get<std::size_t>()];
  }
  template <class T>
  T value(const Json& accessor, std::size_t i) const {
    return number_at<T>(binary, start_of(accessor) + i * sizeof(T));
  }
};

class GltfFile : public testing::Test {
 protected:
  void SetUp() override {
    if (!demo::gltf_available()) GTEST_SKIP() << "built without TinyGLTF";
  }
  Folder folder;
};

TEST_F(GltfFile, holds_the_floats_and_triangles_of_the_mesh) {
  const WaterMesh mesh = tetrahedron();
  demo::write_surface(folder.path(), 3, {"glb"}, file_of(mesh));
  const Glb glb(folder.read("surface_0003.glb"));
  const Json& position = glb.attribute("POSITION");
  EXPECT_EQ(position["count"], 4);
  EXPECT_EQ(position["type"], "VEC3");
  EXPECT_EQ(position["min"], Json({0, 0, -3}));
  EXPECT_EQ(position["max"][0].get<float>(), 0.1f);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(glb.value<float>(position, i), mesh.positions[i / 3][i % 3]);
    EXPECT_EQ(glb.value<float>(glb.attribute("NORMAL"), i), mesh.normals[i / 3][i % 3]);
    EXPECT_EQ(glb.value<float>(glb.attribute("_VELOCITY"), i), mesh.velocities[i / 3][i % 3]);
  }
  const Json& indices = glb.json["accessors"][glb.json["meshes"][0]["primitives"][0]["indices"].get<int>()];
  ASSERT_EQ(indices["count"], 12);
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_EQ(glb.value<std::uint32_t>(indices, i), mesh.triangles[i / 3][i % 3]);
  EXPECT_EQ(demo::surface_made_with(folder.path("surface_0003.glb"), "glb"), R"({"cell":0.004})");
}

TEST_F(GltfFile, has_channels_as_attributes_of_its_own_and_integers_as_halves) {
  const WaterMesh mesh = tetrahedron();
  demo::write_surface(folder.path(), 3, {"glb"}, file_of(mesh));
  const Glb glb(folder.read("surface_0003.glb"));
  EXPECT_EQ(glb.attribute("_SPEED")["type"], "SCALAR");
  EXPECT_EQ(glb.value<float>(glb.attribute("_SPEED"), 1), 5);
  EXPECT_EQ(glb.attribute("_WETNESS")["count"], 4);
  const Json& id = glb.attribute("_ID");
  EXPECT_EQ(id["type"], "VEC2");
  EXPECT_EQ(id["componentType"], 5123);
  for (std::size_t v = 0; v < 3; ++v) {
    const std::uint32_t low = glb.value<std::uint16_t>(id, 2 * v),
                        high = glb.value<std::uint16_t>(id, 2 * v + 1);
    EXPECT_EQ(low + 65536 * high, ids[mesh.nearest[v]]);
  }
}

TEST_F(GltfFile, of_no_water_has_no_scene) {
  const WaterMesh mesh;
  demo::write_surface(folder.path(), 0, {"glb"}, file_of(mesh));
  const Glb glb(folder.read("surface_0000.glb"));
  EXPECT_EQ(glb.json["asset"]["version"], "2.0");
  EXPECT_FALSE(glb.json.contains("scenes"));
  EXPECT_FALSE(glb.json.contains("meshes"));
  EXPECT_EQ(demo::surface_made_with(folder.path("surface_0000.glb"), "glb"), R"({"cell":0.004})");
}

TEST_F(GltfFile, that_is_damaged_was_made_with_nothing_known) {
  const WaterMesh mesh = tetrahedron();
  demo::write_surface(folder.path(), 3, {"glb"}, file_of(mesh));
  const std::string whole = folder.read("surface_0003.glb");
  for (const std::size_t n : {std::size_t(0), std::size_t(19), std::size_t(60)}) {
    const std::string path = folder.write("short.glb", whole.substr(0, n));
    EXPECT_EQ(demo::surface_made_with(path, "glb"), "") << n;
  }
  EXPECT_EQ(demo::surface_made_with(folder.write("other.glb", "of another program"), "glb"), "");
}

TEST(SurfaceFiles, of_formats_whose_library_is_not_there_are_refused_by_its_package) {
  EXPECT_NO_THROW(demo::require_formats({"ply"}));
  const std::pair<bool, std::string> expected[] = {
      {demo::gltf_available(), R"("glb" needs TinyGLTF (Debian: libtinygltf-dev))"},
      {demo::vdb_available(), R"("vdb" needs OpenVDB (Debian: libopenvdb-dev))"}};
  for (const auto& [available, text] : expected) {
    std::string message;
    try {
      demo::require_formats({"ply", text.substr(1, 3)});
    } catch (const demo::SceneError& e) {
      message = e.what();
    }
    EXPECT_EQ(message.empty(), available);
    if (available) continue;
    EXPECT_NE(message.find(text), std::string::npos) << message;
  }
}

TEST(SurfaceFiles, that_cannot_be_written_leave_nothing_behind) {
  const Folder folder;
  const WaterMesh mesh = tetrahedron();
  for (const std::string& format : demo::known_formats()) {
    try {
      demo::require_formats({format});
    } catch (const demo::SceneError&) {
      continue;
    }
    EXPECT_THROW(demo::write_surface(folder.path("absent"), 0, {format}, file_of(mesh)), demo::OutputError);
    // A folder is where the file is to go.
    const std::string taken = "surface_0001." + format;
    std::filesystem::create_directories(folder.path(taken + "/full"));
    EXPECT_THROW(demo::write_surface(folder.path(), 1, {format}, file_of(mesh)), demo::OutputError);
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    EXPECT_TRUE(entry.is_directory()) << entry.path();
}

TEST(SurfaceFiles, of_the_default_channels_are_made_with_what_earlier_versions_wrote) {
  demo::WaterMeshSettings settings;
  const std::string before = demo::made_with(settings, 0.01);
  EXPECT_EQ(before.find("channels"), std::string::npos);
  settings.formats = {"ply", "vdb"};
  EXPECT_EQ(demo::made_with(settings, 0.01), before);
  settings.channels = {"velocity", "id"};
  EXPECT_NE(demo::made_with(settings, 0.01).find(R"("channels":["velocity","id"])"), std::string::npos);
}

}  // namespace
}  // namespace oilskin::test
