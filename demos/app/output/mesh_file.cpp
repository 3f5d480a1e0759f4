#include "output/mesh_file.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "output/write_file.h"

namespace oilskin::demo {
namespace {

/// Little-endian bytes, whatever the machine's order.
template <class T>
void append(std::string& bytes, T value) {
  std::uint32_t bits;
  static_assert(sizeof value == sizeof bits, "PLY knows floats and ints of 32 bits");
  std::memcpy(&bits, &value, sizeof bits);
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(bits >> shift & 0xff);
}

void append(std::string& bytes, const std::vector<Triangle>& triangles) {
  for (const Triangle& t : triangles) {
    bytes += static_cast<char>(3);
    for (const std::uint32_t v : t) append(bytes, static_cast<std::int32_t>(v));
  }
}

const std::string comment = "comment made with ";

std::string header(const SurfaceFile& file) {
  std::string text = "ply\nformat binary_little_endian 1.0\n" + comment + file.made_with +
                     "\nelement vertex " + std::to_string(file.mesh.positions.size()) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"})
    text += std::string("property float ") + name + "\n";
  for (const VertexChannel& channel : file.channels) {
    const bool is_integer = std::holds_alternative<std::vector<std::int32_t>>(channel.values);
    for (const std::string& name : channel.properties)
      text += std::string("property ") + (is_integer ? "int " : "float ") + name + "\n";
  }
  return text + "element face " + std::to_string(file.mesh.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

void append(std::string& bytes, const VertexChannel& channel, std::size_t vertex) {
  const std::size_t n = channel.components();
  std::visit(
      [&](const auto& values) {
        for (std::size_t k = 0; k < n; ++k) append(bytes, values[n * vertex + k]);
      },
      channel.values);
}

std::string body(const SurfaceFile& file) {
  const WaterMesh& mesh = file.mesh;
  std::size_t per_vertex = 24;
  for (const VertexChannel& channel : file.channels) per_vertex += 4 * channel.components();
  std::string bytes;
  bytes.reserve(mesh.positions.size() * per_vertex + mesh.triangles.size() * 13);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (const float x : mesh.positions[i]) append(bytes, x);
    for (const float n : mesh.normals[i]) append(bytes, n);
    for (const VertexChannel& channel : file.channels) append(bytes, channel, i);
  }
  append(bytes, mesh.triangles);
  return bytes;
}

}  // namespace

void write_ply(const std::string& path, const SurfaceFile& file) {
  write_file(path, header(file) + body(file));
}

void write_wet_mesh(const std::string& path, const SurfaceMotion& motion, Span<const float> wetness) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(motion.x_t1.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nproperty float wetness\n"
      "element face " +
      std::to_string(motion.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < motion.x_t1.size(); ++i) {
    for (const double x : motion.x_t1[i]) append(bytes, static_cast<float>(x));
    append(bytes, wetness[i]);
  }
  append(bytes, motion.triangles);
  write_file(path, bytes);
}

std::string ply_made_with(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string line;
  for (int lines = 0; lines < 20 && std::getline(in, line) && line != "end_header"; ++lines)
    if (line.compare(0, comment.size(), comment) == 0) return line.substr(comment.size());
  return "";
}

bool ply_is_whole(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string line;
  std::uint64_t vertices = 0, faces = 0, properties = 0;
  while (std::getline(in, line) && line != "end_header") {
    std::istringstream words(line);
    std::string word, name;
    words >> word >> name;
    if (word == "element") words >> (name == "vertex" ? vertices : faces);
    if (word == "property" && name != "list") ++properties;
  }
  if (line != "end_header") return false;
  const auto header = static_cast<std::uint64_t>(in.tellg());
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  return !error && size == header + vertices * 4 * properties + faces * 13;
}

}  // namespace oilskin::demo
