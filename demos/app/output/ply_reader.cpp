#include "output/ply_reader.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include "scene/fields.h"

namespace oilskin::demo {
namespace {

struct Property {
  std::string name, type;
  std::size_t at = 0, size = 0;  // bytes within the vertex

  bool is_float() const {
    return type == "float" || type == "float32" || type == "double" || type == "float64";
  }
};

struct Header {
  std::size_t vertices = 0, faces = 0, stride = 0;
  std::vector<Property> properties;
  std::string format;
  std::size_t end = 0;  // where the data begins
};

/// Reads one file; every step names what is missing.
class PlyReader {
 public:
  explicit PlyReader(const std::string& path) : path_(path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) fail("cannot be opened");
    std::ostringstream all;
    all << in.rdbuf();
    bytes_ = all.str();
  }

  StoredMesh read() {
    read_header();
    if (header_.format == "ascii") make_binary();
    StoredMesh mesh;
    read_vertices(mesh);
    read_wetness(mesh);
    read_faces(mesh);
    return mesh;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const { throw SceneError(path_ + ": " + why); }

  static std::size_t size_of(const std::string& type) {
    for (const char* t : {"char", "uchar", "int8", "uint8"})
      if (type == t) return 1;
    for (const char* t : {"short", "ushort", "int16", "uint16"})
      if (type == t) return 2;
    for (const char* t : {"int", "uint", "float", "int32", "uint32", "float32"})
      if (type == t) return 4;
    return type == "double" || type == "float64" ? 8 : 0;
  }

  std::string next_line() {
    const std::size_t end = bytes_.find('\n', header_.end);
    if (end == std::string::npos || end - header_.end > 1000)
      fail("is no PLY file, or its header is cut short");
    std::string line = bytes_.substr(header_.end, end - header_.end);
    header_.end = end + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return line;
  }

  void read_header() {
    if (next_line() != "ply") fail("is no PLY file");
    bool of_vertices = false, has_list = false;
    for (std::string line = next_line(); line != "end_header"; line = next_line()) {
      std::istringstream words(line);
      std::string word, type, name;
      words >> word >> type;
      if (word == "format") header_.format = type;
      if (word == "element") {
        long long count = -1;
        words >> count;
        if (count < 0) fail("has no sensible number of \"" + type + "\"");
        of_vertices = type == "vertex";
        if (!of_vertices && type != "face") fail("has elements \"" + type + "\"; vertex and face are known");
        (of_vertices ? header_.vertices : header_.faces) = static_cast<std::size_t>(count);
      }
      if (word != "property") continue;
      if (of_vertices) {
        words >> name;
        if (size_of(type) == 0) fail("has vertices with a property of type \"" + type + "\"");
        header_.properties.push_back({name, type, header_.stride, size_of(type)});
        header_.stride += size_of(type);
      } else {
        std::string count_type, index_type;
        words >> count_type >> index_type;
        if (type != "list" || has_list || size_of(count_type) != 1 || size_of(index_type) != 4)
          fail("has faces that are no single list of int");
        has_list = true;
      }
    }
    if (header_.format != "binary_little_endian" && header_.format != "ascii")
      fail("must be in the format binary_little_endian or ascii");
    if (header_.faces > 0 && !has_list) fail("has faces without vertices");
  }

  double next_number(std::istream& in) const {
    double value = 0;
    if (!(in >> value)) fail("is cut short, or has a word that is no number");
    return value;
  }
  template <class T>
  static void append(T value, std::string& to) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    to.append(bytes, sizeof value);
  }
  /// Of an integer.
  template <class T>
  void append_whole(double value, std::string& to) const {
    if (!(value >= 0 && value <= double(std::numeric_limits<T>::max()) && value == std::floor(value)))
      fail("has " + std::to_string(value) + " where a number of corners or a vertex must be");
    append(static_cast<T>(value), to);
  }
  /// The same file as binary little endian. Only floats and doubles keep their values: no other is read.
  void make_binary() {
    std::istringstream in(bytes_.substr(header_.end));
    std::string binary = bytes_.substr(0, header_.end);
    for (std::size_t i = 0; i < header_.vertices; ++i)
      for (const Property& p : header_.properties) {
        const double value = next_number(in);
        if (p.is_float() && p.size == 8)
          append(value, binary);
        else if (p.is_float())
          append(static_cast<float>(value), binary);
        else
          binary.append(p.size, '\0');
      }
    for (std::size_t f = 0; f < header_.faces; ++f) {
      const double corners = next_number(in);
      append_whole<std::uint8_t>(corners, binary);
      for (int k = 0; k < int(corners); ++k) append_whole<std::uint32_t>(next_number(in), binary);
    }
    bytes_ = std::move(binary);
  }

  const Property& coordinate(const char* name) const {
    for (const Property& p : header_.properties)
      if (p.name == name && p.is_float()) return p;
    fail(std::string("has vertices without ") + name);
  }

  void read_vertices(StoredMesh& mesh) {
    const Property axes[3] = {coordinate("x"), coordinate("y"), coordinate("z")};
    if (header_.vertices > (bytes_.size() - header_.end) / header_.stride) fail("is cut short");
    mesh.vertices.resize(header_.vertices);
    for (std::size_t i = 0; i < header_.vertices; ++i)
      for (int k = 0; k < 3; ++k) {
        const char* at = bytes_.data() + header_.end + i * header_.stride + axes[k].at;
        float single;
        std::memcpy(&single, at, sizeof single);
        mesh.vertices[i][k] = single;
        if (axes[k].size == 8) std::memcpy(&mesh.vertices[i][k], at, 8);
        if (!std::isfinite(mesh.vertices[i][k])) fail("vertex " + std::to_string(i) + " is not finite");
      }
  }

  /// Of other types it is somebody else's.
  void read_wetness(StoredMesh& mesh) const {
    for (const Property& p : header_.properties) {
      if (p.name != "wetness" || (p.type != "float" && p.type != "float32")) continue;
      mesh.wetness.resize(header_.vertices);
      for (std::size_t i = 0; i < header_.vertices; ++i) {
        std::memcpy(&mesh.wetness[i], bytes_.data() + header_.end + i * header_.stride + p.at, sizeof(float));
        if (!std::isfinite(mesh.wetness[i]))
          fail("wetness of vertex " + std::to_string(i) + " is not finite");
      }
    }
  }

  void read_faces(StoredMesh& mesh) {
    std::size_t at = header_.end + header_.vertices * header_.stride;
    for (std::size_t f = 0; f < header_.faces; ++f) {
      const std::size_t corners = at < bytes_.size() ? static_cast<unsigned char>(bytes_[at]) : 0;
      if (corners < 3)
        fail(at < bytes_.size() ? "face " + std::to_string(f) + " has no three corners" : "is cut short");
      if (bytes_.size() - at - 1 < 4 * corners) fail("is cut short");
      std::vector<std::uint32_t> index(corners);
      std::memcpy(index.data(), bytes_.data() + at + 1, 4 * corners);
      at += 1 + 4 * corners;
      for (const std::uint32_t i : index)
        if (i >= header_.vertices)
          fail("face " + std::to_string(f) + " names vertex " + std::to_string(static_cast<std::int32_t>(i)) +
               "; there are " + std::to_string(header_.vertices));
      for (std::size_t k = 2; k < corners; ++k) mesh.triangles.push_back({index[0], index[k - 1], index[k]});
    }
  }

  std::string path_, bytes_;
  Header header_;
};

}  // namespace

StoredMesh read_ply(const std::string& path) {
  return PlyReader(path).read();
}

}  // namespace oilskin::demo
