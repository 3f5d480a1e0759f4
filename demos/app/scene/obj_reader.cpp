#include "scene/obj_reader.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "scene/fields.h"

namespace oilskin::demo {
namespace {

constexpr double max_coordinate = 1e9;  // [m]; beyond it, it is a typing error

struct Line {
  const std::string& file;
  std::size_t number;

  [[noreturn]] void fail(const std::string& why) const {
    throw SceneError(file + ":" + std::to_string(number) + ": " + why);
  }
};

Vec3 read_vertex(std::istringstream& words, const Line& line) {
  Vec3 x;
  for (int k = 0; k < 3; ++k) {
    std::string word;
    if (!(words >> word)) line.fail("a vertex needs three coordinates");
    char* end = nullptr;
    x[k] = std::strtod(word.c_str(), &end);
    if (*end != '\0' || !std::isfinite(x[k]) || std::abs(x[k]) > max_coordinate)
      line.fail("coordinate \"" + word + "\" must be a finite number within ±1e9");
  }
  return x;
}

/// The index before the first slash of a word such as 3/1/2, counted from 0.
std::uint32_t read_index(const std::string& word, std::size_t vertices, const Line& line) {
  const std::string digits = word.substr(0, word.find('/'));
  char* end = nullptr;
  const long index = std::strtol(digits.c_str(), &end, 10);
  if (digits.empty() || *end != '\0') line.fail("\"" + word + "\" is no vertex index");
  const long count = static_cast<long>(vertices);
  const long zero_based = index > 0 ? index - 1 : count + index;
  if (index == 0 || zero_based < 0 || zero_based >= count)
    line.fail("vertex index " + digits + " is out of range, there are " + std::to_string(vertices) +
              " vertices above this line (1 to " + std::to_string(vertices) + ", or negative)");
  return static_cast<std::uint32_t>(zero_based);
}

void read_face(std::istringstream& words, const Line& line, Mesh& mesh) {
  std::vector<std::uint32_t> corners;
  for (std::string word; words >> word;) {
    if (word[0] == '#') break;
    corners.push_back(read_index(word, mesh.vertices.size(), line));
  }
  if (corners.size() < 3) line.fail("a face needs three corners or more");
  for (std::size_t i = 2; i < corners.size(); ++i)
    mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

}  // namespace

Mesh read_obj(std::istream& in, const std::string& name) {
  Mesh mesh;
  std::string text;
  for (std::size_t number = 1; std::getline(in, text); ++number) {
    const Line line{name, number};
    std::istringstream words(text);
    std::string kind;
    words >> kind;
    if (kind == "v") mesh.vertices.push_back(read_vertex(words, line));
    if (kind == "f") read_face(words, line, mesh);
  }
  if (mesh.triangles.empty()) throw SceneError(name + ": holds no faces (lines that begin with f)");
  return mesh;
}

Mesh read_obj_file(const std::string& path) {
  std::ifstream in(path);
  if (!in || std::filesystem::is_directory(path)) throw SceneError(path + ": the mesh file cannot be read");
  return read_obj(in, path);
}

void load(PlacedMesh& placed, const std::string& directory) {
  const std::filesystem::path path = std::filesystem::path(directory) / placed.file;
  placed.mesh = read_obj_file(path.string());
  const Eigen::Quaterniond rotate(placed.rotate[3], placed.rotate[0], placed.rotate[1], placed.rotate[2]);
  for (Vec3& x : placed.mesh.vertices) x = rotate * (placed.scale * x) + placed.translate;
}

}  // namespace oilskin::demo
