#include "output/vdb_file.h"

#include <openvdb/io/Stream.h>
#include <openvdb/math/Proximity.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "geometry/winding.h"
#include "oilskin/version.h"
#include "output/output_error.h"
#include "output/write_file.h"

namespace oilskin::demo {
namespace {

constexpr float half_width = 3;  // of the narrow band [cells]

// A file begins with a magic number, three versions and a flag, a UUID, and the metadata
// (openvdb/io/Archive.h).
constexpr std::size_t uuid_at = 8 + 3 * 4 + 1, uuid_length = 36;

/// The mesh as OpenVDB reads it, in cells.
class CellMesh {
 public:
  CellMesh(const WaterMesh& mesh, double cell) : mesh_(mesh), cell_(cell) {}

  // Named by OpenVDB.
  std::size_t polygonCount() const { return mesh_.triangles.size(); }
  std::size_t pointCount() const { return mesh_.positions.size(); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t n, std::size_t v, openvdb::Vec3d& at) const {
    at = point(mesh_.triangles[n][v]);
  }

  openvdb::Vec3d point(std::uint32_t vertex) const {
    const auto& p = mesh_.positions[vertex];
    return openvdb::Vec3d(double(p[0]), double(p[1]), double(p[2])) / cell_;
  }

 private:
  const WaterMesh& mesh_;
  double cell_;
};

/// openvdb::tools::meshToLevelSet() fills cavities, such as those that the gap leaves around cloth in water.
/// So the signs are ours.
void set_signs(const SurfaceFile& file, openvdb::FloatGrid& grid) {
  const Winding winding(file.mesh.positions, file.mesh.triangles, file.cell);
  for (auto it = grid.beginValueOn(); it; ++it) {
    const openvdb::Coord c = it.getCoord();
    if (winding.at(c.x(), c.y(), c.z()) > 0) it.setValue(-*it);
  }
  openvdb::tools::signedFloodFill(grid.tree(), /*threaded=*/false);
}

openvdb::FloatGrid::Ptr make_level_set(const SurfaceFile& file, openvdb::Int32Grid& nearest) {
  const auto cells = openvdb::math::Transform::createLinearTransform(file.cell);
  openvdb::FloatGrid::Ptr grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      CellMesh(file.mesh, file.cell), *cells, half_width, half_width, openvdb::tools::UNSIGNED_DISTANCE_FIELD,
      &nearest);
  set_signs(file, *grid);
  grid->setName("surface");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

/// Of the point of the triangle that is nearest to `at` [cells].
openvdb::Vec3f velocity_at(const SurfaceFile& file, const CellMesh& cells, std::int32_t triangle,
                           const openvdb::Vec3d& at) {
  const Triangle& t = file.mesh.triangles[static_cast<std::size_t>(triangle)];
  openvdb::Vec3d weights;
  openvdb::math::closestPointOnTriangleToPoint(cells.point(t[0]), cells.point(t[1]), cells.point(t[2]), at,
                                               weights);
  openvdb::Vec3d v(0, 0, 0);
  for (int k = 0; k < 3; ++k) {
    const auto& own = file.mesh.velocities[t[static_cast<std::size_t>(k)]];
    v += weights[k] * openvdb::Vec3d(double(own[0]), double(own[1]), double(own[2]));
  }
  return openvdb::Vec3f(v);
}

openvdb::Vec3SGrid::Ptr make_velocity(const SurfaceFile& file, const openvdb::FloatGrid& surface,
                                      const openvdb::Int32Grid& nearest) {
  auto grid = openvdb::Vec3SGrid::create(openvdb::Vec3f(0));
  grid->setTransform(surface.transform().copy());
  grid->setName("velocity");
  grid->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
  auto triangles = nearest.getConstAccessor();
  auto velocities = grid->getAccessor();
  const CellMesh cells(file.mesh, file.cell);
  for (auto it = surface.cbeginValueOn(); it; ++it) {
    const openvdb::Coord c = it.getCoord();
    velocities.setValue(c, velocity_at(file, cells, triangles.getValue(c), c.asVec3d()));
  }
  return grid;
}

bool wants_velocity(const SurfaceFile& file) {
  return std::any_of(file.channels.begin(), file.channels.end(),
                     [](const VertexChannel& c) { return c.name == "velocity"; });
}

openvdb::GridPtrVec make_grids(const SurfaceFile& file) {
  openvdb::Int32Grid nearest(-1);
  openvdb::GridPtrVec grids;
  const openvdb::FloatGrid::Ptr surface = make_level_set(file, nearest);
  grids.push_back(surface);
  if (wants_velocity(file)) grids.push_back(make_velocity(file, *surface, nearest));
  return grids;
}

/// OpenVDB marks each file by a random UUID. One of the content takes its place, so that equal content gives
/// equal files.
void set_uuid(std::string& bytes) {
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (std::size_t i = uuid_at + uuid_length; i < bytes.size(); ++i)
    hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 1099511628211u;
  char text[uuid_length + 1];
  std::snprintf(text, sizeof text, "%08x-%04x-8000-8000-%012llx", static_cast<unsigned>(hash >> 32),
                static_cast<unsigned>(hash >> 16 & 0xffff),
                static_cast<unsigned long long>(hash & 0xffffffffffffu));
  bytes.replace(uuid_at, uuid_length, text);
}

std::string bytes_of(const SurfaceFile& file) {
  openvdb::MetaMap about;
  about.insertMeta("creator", openvdb::StringMetadata("oilskin " OILSKIN_VERSION_STRING));
  about.insertMeta("made_with", openvdb::StringMetadata(file.made_with));
  std::ostringstream out(std::ios::binary);
  openvdb::io::Stream(out).write(make_grids(file), about);
  std::string bytes = out.str();
  set_uuid(bytes);
  return bytes;
}

/// Its length and its characters; the stream fails where they are not there.
std::string read_text(std::istream& in) {
  constexpr std::uint32_t max_length = 1u << 20;
  std::uint32_t length = 0;
  in.read(reinterpret_cast<char*>(&length), sizeof length);
  if (!in || length > max_length) in.setstate(std::ios::failbit);
  if (!in) return "";
  std::string text(length, ' ');
  in.read(text.data(), static_cast<std::streamsize>(length));
  return text;
}

}  // namespace

bool vdb_available() {
  return true;
}

void write_vdb(const std::string& path, const SurfaceFile& file) {
  openvdb::initialize();
  std::string bytes;
  try {
    // One thread: oneTBB would take all cores, whatever --threads says.
    tbb::task_arena(1).execute([&] { bytes = bytes_of(file); });
  } catch (const openvdb::Exception& e) {
    throw OutputError(path + ": cannot be written by OpenVDB: " + e.what());
  }
  write_file(path, bytes);
}

std::string vdb_made_with(const std::string& path) {
  // The grids are not read; nor does OpenVDB read the metadata: of a file that is cut short it takes lengths
  // for granted.
  std::ifstream in(path, std::ios::binary);
  std::uint32_t magic = 0, count = 0;
  if (!in.read(reinterpret_cast<char*>(&magic), sizeof magic) || magic != openvdb::OPENVDB_MAGIC) return "";
  in.seekg(uuid_at + uuid_length);
  if (!in.read(reinterpret_cast<char*>(&count), sizeof count)) return "";
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string name = read_text(in), type = read_text(in);
    std::string value = read_text(in);
    if (!in) return "";
    if (name == "made_with" && type == "string") return value;
  }
  return "";
}

}  // namespace oilskin::demo
