#include "output/mesh_file.h"

#include <cstring>
#include <fstream>

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

std::string header(const WaterMesh& mesh, const std::string& made_with) {
  std::string text = "ply\nformat binary_little_endian 1.0\n" + comment + made_with + "\nelement vertex " +
                     std::to_string(mesh.positions.size()) + "\n";
  const char* names[] = {"x", "y", "z", "nx", "ny", "nz", "vx", "vy", "vz"};
  const int count = mesh.velocities.empty() ? 6 : 9;
  for (int i = 0; i < count; ++i) text += std::string("property float ") + names[i] + "\n";
  return text + "element face " + std::to_string(mesh.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string body(const WaterMesh& mesh) {
  std::string bytes;
  bytes.reserve(mesh.positions.size() * 36 + mesh.triangles.size() * 13);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (const float x : mesh.positions[i]) append(bytes, x);
    for (const float n : mesh.normals[i]) append(bytes, n);
    if (!mesh.velocities.empty())
      for (const float v : mesh.velocities[i]) append(bytes, v);
  }
  append(bytes, mesh.triangles);
  return bytes;
}

}  // namespace

void write_water_mesh(const std::string& path, const WaterMesh& mesh, const std::string& made_with) {
  write_file(path, header(mesh, made_with) + body(mesh));
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

std::string mesh_made_with(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string line;
  for (int lines = 0; lines < 20 && std::getline(in, line) && line != "end_header"; ++lines)
    if (line.compare(0, comment.size(), comment) == 0) return line.substr(comment.size());
  return "";
}

}  // namespace oilskin::demo
