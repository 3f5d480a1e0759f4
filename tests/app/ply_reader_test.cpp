// Meshes that a run stored: read back as written, and whatever is damaged is refused by name.
#include "output/ply_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "app/program.h"
#include "output/mesh_file.h"
#include "scene/fields.h"

namespace oilskin::test {
namespace {

WaterMesh a_mesh() {
  WaterMesh mesh;
  mesh.positions = {{0, 0, 0}, {0.1f, 0, 0}, {0, 0.25f, 0}, {0, 0, -3}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.velocities.assign(4, {1, 2, 3});
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
  return mesh;
}

std::string bytes_of_mesh(const Folder& folder) {
  const WaterMesh mesh = a_mesh();
  demo::write_ply(folder.path("mesh.ply"),
                  {mesh, demo::vertex_channels({"velocity"}, {mesh, {}, {}, 1}), R"({"cell":0.004})", 0.004});
  return folder.read("mesh.ply");
}

TEST(PlyReader, reads_what_was_written) {
  const Folder folder;
  bytes_of_mesh(folder);
  const demo::StoredMesh read = demo::read_ply(folder.path("mesh.ply"));
  ASSERT_EQ(read.vertices.size(), 4u);
  EXPECT_EQ(read.vertices[1], Vec3(0.1f, 0, 0));
  EXPECT_EQ(read.vertices[3], Vec3(0, 0, -3));
  EXPECT_EQ(read.triangles, a_mesh().triangles);
  EXPECT_EQ(demo::ply_made_with(folder.path("mesh.ply")), R"({"cell":0.004})");
  EXPECT_EQ(demo::ply_made_with(folder.path("no.ply")), "");
}

TEST(PlyReader, reads_the_wetness_of_cloth_as_the_run_wrote_it) {
  const Folder folder;
  SurfaceMotion cloth;
  cloth.x_t1 = {Vec3(0, 0, 0), Vec3(0.5, 0, 0), Vec3(0, 0.25, 0)};
  cloth.triangles = {{0, 1, 2}};
  const std::vector<float> wetness = {0, 0.625f, 1.25f};
  demo::write_wet_mesh(folder.path("cloth.ply"), cloth, wetness);
  const demo::StoredMesh read = demo::read_ply(folder.path("cloth.ply"));
  EXPECT_EQ(read.wetness, wetness);
  EXPECT_EQ(read.vertices, cloth.x_t1);
  EXPECT_EQ(read.triangles, cloth.triangles);
  // Other meshes have none; nor is a property of the name with another type one.
  bytes_of_mesh(folder);
  EXPECT_TRUE(demo::read_ply(folder.path("mesh.ply")).wetness.empty());
  std::string other = folder.read("cloth.ply");
  other.replace(other.find("float wetness"), 13, "int32 wetness");
  EXPECT_TRUE(demo::read_ply(folder.write("other.ply", other)).wetness.empty());
  demo::write_wet_mesh(folder.path("bad.ply"), cloth, std::vector<float>{0, std::nanf(""), 1});
  EXPECT_THROW(demo::read_ply(folder.path("bad.ply")), demo::SceneError);
}

TEST(PlyReader, reads_text_as_the_same_mesh) {
  const Folder folder;
  const std::string head =
      "ply\nformat ascii 1.0\ncomment of another program\nelement vertex 4\nproperty double x\nproperty "
      "float y\n"
      "property float z\nproperty uchar red\nproperty float wetness\nelement face 2\n"
      "property list uchar int vertex_indices\nend_header\n";
  const std::string body = "0 0 0 255 0\n0.1 0 0 7 0.5\n0 0.25 0 7 1\n0 0 -3e0 7 0\n3 0 1 2\n4 0 3 1 2\n";
  const demo::StoredMesh read = demo::read_ply(folder.write("text.ply", head + body));
  ASSERT_EQ(read.vertices.size(), 4u);
  EXPECT_EQ(read.vertices[1], Vec3(0.1, 0, 0));
  EXPECT_EQ(read.vertices[2], Vec3(0, 0.25f, 0));
  EXPECT_EQ(read.vertices[3], Vec3(0, 0, -3));
  EXPECT_EQ(read.wetness, (std::vector<float>{0, 0.5f, 1, 0}));
  EXPECT_EQ(read.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 3, 1}, {0, 1, 2}}));
  const std::string wrong[] = {head + body.substr(0, body.size() - 3), head + "0 0 no 255 0\n",
                               head + "0 0 0 1 0\n0 0 0 1 0\n0 0 0 1 0\n0 0 0 1 0\n3 0 1 -2\n3 0 1 2\n",
                               head + "0 0 0 1 0\n0 0 0 1 0\n0 0 0 1 0\n0 0 0 1 0\n3 0 1 4\n3 0 1 2\n",
                               head + "0 0 0 1 0\n0 0 0 1 0\n0 0 0 1 0\n0 0 0 1 0\n1e9 0 1 2\n"};
  for (const std::string& text : wrong)
    EXPECT_THROW(demo::read_ply(folder.write("wrong.ply", text)), demo::SceneError) << text;
}

TEST(PlyReader, every_truncation_is_refused_by_name) {
  const Folder folder;
  const std::string whole = bytes_of_mesh(folder);
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const std::string path = folder.write("short.ply", whole.substr(0, n));
    try {
      demo::read_ply(path);
      ADD_FAILURE() << n << " of " << whole.size() << " bytes were taken for a mesh";
    } catch (const demo::SceneError& e) {
      EXPECT_NE(std::string(e.what()).find("short.ply: "), std::string::npos) << e.what();
    }
  }
}

TEST(PlyReader, what_is_no_mesh_is_refused) {
  const Folder folder;
  const std::string whole = bytes_of_mesh(folder);
  const auto refuses = [&](const std::string& changed, const char* why) {
    try {
      demo::read_ply(folder.write("bad.ply", changed));
      ADD_FAILURE() << "should say: " << why;
    } catch (const demo::SceneError& e) {
      EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
    }
  };
  const auto with = [&](const std::string& what, const std::string& instead) {
    std::string s = whole;
    return s.replace(s.find(what), what.size(), instead);
  };
  refuses("", "no PLY file");
  refuses(with("little", "big"), "binary_little_endian");
  refuses(with("float x", "int32 x"), "without x");
  refuses(with("vertex 4\n", "vertex -4\n"), "number");
  refuses(with("vertex 4\n", "vertex 4000000000\n"), "cut short");
  refuses(with("float z", "float w"), "without z");
  refuses(with("element face", "element edge"), "edge");
  std::string index = whole;
  const std::uint32_t many = 2000000000;
  std::memcpy(&index[index.size() - 4], &many, 4);
  refuses(index, "face 1 names vertex 2000000000; there are 4");
  std::string number = whole;
  const float nan = std::nanf("");
  std::memcpy(&number[number.find("end_header\n") + 11], &nan, 4);
  refuses(number, "vertex 0 is not finite");
  std::string flat = whole;
  flat[flat.size() - 13] = 2;
  refuses(flat, "no three corners");
}

}  // namespace
}  // namespace oilskin::test
