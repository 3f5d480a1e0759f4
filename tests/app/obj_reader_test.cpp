#include "scene/obj_reader.h"

#include <gtest/gtest.h>

#include <sstream>

#include "scene/fields.h"

namespace oilskin::demo {
namespace {

Mesh read(const std::string& text) {
  std::istringstream in(text);
  return read_obj(in, "test.obj");
}

std::string message_of(const std::string& text) {
  try {
    read(text);
  } catch (const SceneError& e) {
    return e.what();
  }
  return "";
}

const std::string square = "# a square\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\r\nv 0 1 0\nvn 0 0 1\n";

TEST(ObjReader, fans_polygons_and_skips_normals_and_textures) {
  const Mesh mesh = read(square + "f 1/1/1 2//1 3/2 4 # a comment\n");
  ASSERT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.vertices[2], Vec3(1, 1, 0));
}

TEST(ObjReader, counts_negative_indices_from_the_end) {
  EXPECT_EQ(read(square + "f -4 -3 -2\n").triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(ObjReader, names_the_line_of_what_is_wrong) {
  EXPECT_NE(message_of(square + "f 1 2 5\n").find("test.obj:7: vertex index 5 is out of range"),
            std::string::npos);
  EXPECT_NE(message_of(square + "f 1 2 0\n").find("test.obj:7"), std::string::npos);
  EXPECT_NE(message_of(square + "f 1 2 -5\n").find("test.obj:7"), std::string::npos);
  EXPECT_NE(message_of(square + "f 1 2\n").find("three corners"), std::string::npos);
  EXPECT_NE(message_of(square + "f 1 two 3\n").find("\"two\""), std::string::npos);
  EXPECT_NE(message_of("v 0 0\n").find("test.obj:1"), std::string::npos);
  EXPECT_NE(message_of("v 0 0 nan\n").find("\"nan\""), std::string::npos);
  EXPECT_NE(message_of(square).find("no faces"), std::string::npos);
  EXPECT_NE(message_of("").find("no faces"), std::string::npos);
}

}  // namespace
}  // namespace oilskin::demo
