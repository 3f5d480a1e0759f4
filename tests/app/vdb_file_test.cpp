// Level sets of water meshes, opened again by OpenVDB: volume, signs, cavities, velocities, equal bytes.
#include "output/vdb_file.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetMeasure.h>

#include "app/program.h"
#include "geometry/nearest_surface.h"
#include "geometry/winding.h"
#include "scene/fields.h"

namespace oilskin::test {
namespace {

constexpr double spacing = 0.01;

/// A block of water with a sheet in it, which the gap keeps dry: a cavity. The velocity is linear.
struct Water {
  std::vector<Vec3> positions, velocities;
  std::vector<Vec3> sheet = {Vec3(0.06, 0.101, 0.06), Vec3(0.14, 0.101, 0.06), Vec3(0.06, 0.101, 0.14),
                             Vec3(0.14, 0.101, 0.14)};
  std::vector<Triangle> faces = {{0, 2, 1}, {1, 2, 3}};
  WaterMesh mesh;
  double volume = 0;

  explicit Water(double gap) {
    for (int z = 0; z < 20; ++z)
      for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 20; ++x) positions.push_back(spacing * Vec3(x + 0.5, y + 0.5, z + 0.5));
    for (const Vec3& p : positions) velocities.push_back(Vec3(1, 10 * p.x(), 0));
    ReconstructionInput input;
    input.positions = positions;
    input.velocities = velocities;
    input.obstacles.push_back({sheet, faces});
    ReconstructionOptions options;
    options.spacing = spacing;
    options.gap = gap;
    ReconstructionReport report;
    const Status status = reconstruct_surface(input, options, &mesh, &report);
    EXPECT_TRUE(status.ok()) << status.message;
    volume = report.volume;
  }
  demo::SurfaceFile file() const {
    return {mesh, demo::vertex_channels({"velocity"}, {mesh, {}, {}, spacing}), R"({"cell":0.005})",
            0.5 * spacing};
  }
};

struct Grids {
  openvdb::FloatGrid::Ptr surface;
  openvdb::Vec3SGrid::Ptr velocity;
};

Grids read(const std::string& path) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open();
  Grids grids;
  grids.surface = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("surface"));
  if (file.hasGrid("velocity"))
    grids.velocity = openvdb::gridPtrCast<openvdb::Vec3SGrid>(file.readGrid("velocity"));
  return grids;
}

TEST(VdbFile, has_the_volume_of_the_mesh_and_its_cavity) {
  const Folder folder;
  const Water water(0.008);
  ASSERT_EQ(check_mesh(water.mesh, {}, 0).components, 2u) << "the sheet should lie in a cavity";
  demo::write_surface(folder.path(), 0, {"vdb"}, water.file());
  const Grids grids = read(folder.path("surface_0000.vdb"));
  EXPECT_EQ(grids.surface->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_DOUBLE_EQ(grids.surface->voxelSize()[0], 0.005);
  EXPECT_FLOAT_EQ(grids.surface->background(), 0.015f);
  EXPECT_NEAR(openvdb::tools::levelSetVolume(*grids.surface) / water.volume, 1, 0.02);
  EXPECT_GT(grids.surface->tree().getValue(openvdb::Coord(20, 20, 20)), 0) << "in the cavity";
  EXPECT_EQ(demo::surface_made_with(folder.path("surface_0000.vdb"), "vdb"), R"({"cell":0.005})");
}

/// Its triangles, to search for the nearest.
SurfaceMotion triangles_of(const WaterMesh& mesh) {
  SurfaceMotion motion;
  for (const auto& p : mesh.positions) motion.x_t1.push_back(Vec3(double(p[0]), double(p[1]), double(p[2])));
  motion.triangles = mesh.triangles;
  return motion;
}

TEST(VdbFile, has_no_voids_no_islands_and_the_distances_of_brute_force) {
  const Folder folder;
  const Water water(0.008);
  demo::write_surface(folder.path(), 0, {"vdb"}, water.file());
  const Grids grids = read(folder.path("surface_0000.vdb"));
  constexpr double cell = 0.005;
  const demo::Winding winding(water.mesh.positions, water.mesh.triangles, cell);
  const SurfaceMotion triangles = triangles_of(water.mesh);
  demo::NearestSurface nearest(3 * cell);
  nearest.add(triangles, 0);
  const auto values = grids.surface->getConstAccessor();
  std::size_t inside = 0, near = 0;
  for (int k = -5; k <= 45; ++k)
    for (int j = -5; j <= 45; ++j)
      for (int i = -5; i <= 45; ++i) {
        const double value = double(values.getValue(openvdb::Coord(i, j, k)));
        ASSERT_EQ(value<0, winding.at(i, j, k)> 0) << i << " " << j << " " << k << ": " << value;
        inside += value < 0;
        demo::NearestSurface::Hit hit;
        const bool found = nearest.find(cell * Vec3(i, j, k), &hit);
        const double exact = found ? hit.point.distance : 3 * cell;
        if (exact < cell) ++near;
        ASSERT_GE(std::abs(value), exact - 1e-4 * cell);
        // OpenVDB's own distances farther out are estimates: up to 0.7 cells too large here.
        ASSERT_LE(std::abs(value), exact + (exact < cell ? 1e-4 : 1) * cell);
      }
  EXPECT_GT(inside, 50000u);
  EXPECT_GT(near, 10000u);
}

TEST(VdbFile, has_the_velocity_of_the_nearest_point_of_the_mesh) {
  const Folder folder;
  const Water water(0);
  demo::write_surface(folder.path(), 0, {"vdb"}, water.file());
  const Grids grids = read(folder.path("surface_0000.vdb"));
  ASSERT_TRUE(grids.velocity);
  EXPECT_EQ(grids.velocity->activeVoxelCount(), grids.surface->activeVoxelCount());
  // Outside a face of constant x the nearest point has nearly that x, and so one velocity.
  const auto velocities = grids.velocity->getConstAccessor();
  const openvdb::Vec3f v = velocities.getValue(openvdb::Coord(41, 10, 10));
  EXPECT_NEAR(v[0], 1, 1e-5);
  EXPECT_NEAR(v[1], 2, 0.05);
  EXPECT_NEAR(v[2], 0, 1e-5);
  demo::SurfaceFile without = water.file();
  without.channels.clear();
  demo::write_surface(folder.path(), 1, {"vdb"}, without);
  EXPECT_FALSE(read(folder.path("surface_0001.vdb")).velocity);
}

TEST(VdbFile, of_the_same_mesh_has_the_same_bytes) {
  const Folder folder;
  const Water water(0.001);
  for (const int number : {0, 1}) demo::write_surface(folder.path(), number, {"vdb"}, water.file());
  const std::string first = folder.read("surface_0000.vdb");
  EXPECT_GT(first.size(), 10000u);
  EXPECT_EQ(folder.read("surface_0001.vdb"), first);
}

TEST(VdbFile, of_no_water_opens_and_is_empty) {
  const Folder folder;
  const WaterMesh mesh;
  demo::write_surface(folder.path(), 0, {"vdb"}, {mesh, {}, "{}", 0.005});
  const Grids grids = read(folder.path("surface_0000.vdb"));
  EXPECT_EQ(grids.surface->activeVoxelCount(), 0u);
  EXPECT_FLOAT_EQ(grids.surface->background(), 0.015f);
}

TEST(VdbFile, that_is_damaged_was_made_with_nothing_known) {
  const Folder folder;
  const WaterMesh mesh;
  demo::write_surface(folder.path(), 0, {"vdb"}, {mesh, {}, "{}", 0.005});
  const std::string whole = folder.read("surface_0000.vdb");
  EXPECT_EQ(demo::surface_made_with(folder.path("surface_0000.vdb"), "vdb"), "{}");
  for (std::size_t n = 0; n < 90; ++n)
    EXPECT_EQ(demo::surface_made_with(folder.write("short.vdb", whole.substr(0, n)), "vdb"), "") << n;
}

}  // namespace
}  // namespace oilskin::test
