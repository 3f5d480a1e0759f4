// A mesher that is used again: the bits of a new one, whatever it meshed before, and memory that does not
// grow.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "reconstruction/promise.h"

namespace oilskin {
namespace {

using test::WaterScene;

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const WaterMesh& a, const WaterMesh& b) {
  EXPECT_TRUE(same_bits(a.positions, b.positions));
  EXPECT_TRUE(same_bits(a.normals, b.normals));
  EXPECT_TRUE(same_bits(a.triangles, b.triangles));
  EXPECT_TRUE(same_bits(a.velocities, b.velocities));
  EXPECT_TRUE(same_bits(a.thickness, b.thickness));
  EXPECT_TRUE(same_bits(a.nearest, b.nearest));
  ASSERT_EQ(a.attributes.size(), b.attributes.size());
  for (std::size_t n = 0; n < a.attributes.size(); ++n) {
    EXPECT_EQ(a.attributes[n].components, b.attributes[n].components);
    EXPECT_TRUE(same_bits(a.attributes[n].values, b.attributes[n].values));
  }
}

void expect_same(const ReconstructionReport& a, const ReconstructionReport& b) {
  EXPECT_EQ(a.blocks, b.blocks);
  EXPECT_EQ(a.cut_edges, b.cut_edges);
  EXPECT_EQ(a.nodes_cleared, b.nodes_cleared);
  EXPECT_EQ(a.repair_rounds, b.repair_rounds);
  EXPECT_EQ(a.blobs_removed, b.blobs_removed);
  EXPECT_EQ(a.drops, b.drops);
  EXPECT_EQ(a.vertices_held, b.vertices_held);
  EXPECT_EQ(a.volume, b.volume);
  EXPECT_EQ(a.bytes, b.bytes);
}

/// A call of a sequence.
struct Call {
  WaterScene scene;
  ReconstructionOptions options;
  bool has_velocities = false;
};

Call call(const WaterScene& scene, double cell, ObstacleMode mode) {
  Call c{scene, test::options_for(scene, cell, 0.1, mode)};
  c.has_velocities = mode == ObstacleMode::touch;
  c.options.nearest = mode == ObstacleMode::gap;
  return c;
}

/// Meshes the call with the mesher and with the function, on 1 and 2 threads, and compares.
void expect_fresh_bits(const Call& c, WaterMesher& mesher, WaterMesh& mesh) {
  ReconstructionInput input = c.scene.input();
  std::vector<Vec3> velocities;
  for (const Vec3& p : c.scene.particles) velocities.emplace_back(p.y(), -p.x(), p.z());
  std::vector<float> heights;
  for (const Vec3& p : c.scene.particles) heights.push_back(float(p.z()));
  if (c.has_velocities) input.velocities = velocities;
  if (c.has_velocities) input.attributes.push_back({heights, 1});
  ReconstructionOptions options = c.options;
  for (const int threads : {2, 1}) {
    options.threads = threads;
    WaterMesh fresh;
    ReconstructionReport report, fresh_report;
    ASSERT_TRUE(mesher.reconstruct(input, options, &mesh, &report).ok());
    ASSERT_TRUE(reconstruct_surface(input, options, &fresh, &fresh_report).ok());
    expect_same(mesh, fresh);
    expect_same(report, fresh_report);
  }
}

WaterScene without_obstacles(WaterScene s) {
  s.vertices.clear();
  s.triangles.clear();
  return s;
}

/// An obstacle that a mesher keeps and a single call does not.
TEST(Reuse, gives_these_bits_with_an_obstacle_far_away) {
  for (const double distance : {25.0, 30.0, 40.0}) {
    WaterScene s;
    s.spacing = 1;
    s.particles = {Vec3::Zero(), Vec3(0.7, 0, 0)};
    s.vertices = {Vec3(distance, 0, 0), Vec3(distance, 1, 0), Vec3(distance, 0, 1)};
    s.triangles = {{0, 1, 2}};
    Call c = call(s, 0.5, ObstacleMode::gap);
    for (const bool keep : {true, false}) {
      c.options.keep_volume = keep;
      c.options.smoothing_iterations = 40;
      WaterMesher mesher;
      WaterMesh mesh;
      expect_fresh_bits(c, mesher, mesh);
      const WaterMesh alone = test::reconstruct(without_obstacles(s).input(), c.options);
      EXPECT_TRUE(same_bits(mesh.positions, alone.positions));
    }
  }
}

WaterScene without_particles(WaterScene s) {
  s.particles.clear();
  return s;
}

/// The particles move by `by` [dx], the sheet stays.
WaterScene moved(WaterScene s, const Vec3& by) {
  for (Vec3& p : s.particles) p += by * s.spacing;
  s.push_off(0.2);
  return s;
}

TEST(Reuse, gives_the_bits_of_a_new_call_in_any_order_of_inputs) {
  const WaterScene small = test::vee_scene(0.05), large = test::wavy_scene(true, 0.08, 16),
                   film = test::wavy_scene(false, 0.08, 16);
  WaterScene wet = film, other = film;
  wet.wet([](const Vec3& v) { return v.x() > 0.04; });
  for (Vec3& v : other.vertices) v.z() -= 1e-4;
  Call smooth = call(large, 0.8, ObstacleMode::gap), blobs = call(film, 0.5, ObstacleMode::touch),
       clipped = call(film, 0.5, ObstacleMode::gap), plain = call(film, 0.5, ObstacleMode::touch);
  smooth.options.smoothing_iterations = 3;
  blobs.options.min_blob = 5;
  clipped.options.clip = Box{Vec3::Constant(0.02), Vec3::Constant(0.05)};
  plain.options.keep_volume = false;
  const Call calls[] = {call(small, 0.5, ObstacleMode::touch),
                        call(large, 0.5, ObstacleMode::gap),
                        call(film, 0.5, ObstacleMode::touch),
                        call(moved(film, Vec3(0.3, 0.1, 0)), 0.5, ObstacleMode::touch),
                        call(moved(film, Vec3(8, 3, 0)), 0.5, ObstacleMode::touch),
                        call(other, 0.5, ObstacleMode::touch),
                        call(wet, 0.5, ObstacleMode::wet),
                        call(film, 0.5, ObstacleMode::wet),
                        call(without_particles(film), 0.5, ObstacleMode::touch),
                        call(without_obstacles(film), 0.5, ObstacleMode::touch),
                        call(film, 0.5, ObstacleMode::overlap),
                        call(film, 0.5, ObstacleMode::none),
                        smooth,
                        blobs,
                        clipped,
                        plain,
                        call(small, 1, ObstacleMode::touch),
                        call(without_particles(small), 1, ObstacleMode::none),
                        call(large, 0.5, ObstacleMode::reset)};
  WaterMesher mesher;
  WaterMesh mesh;
  for (std::size_t n = 0; n < std::size(calls); ++n) {
    SCOPED_TRACE(n);
    expect_fresh_bits(calls[n], mesher, mesh);
  }
}

TEST(Reuse, gives_the_bits_of_a_new_call_after_refusals) {
  const WaterScene s = test::wavy_scene(false, 0.06, 12);
  const Call good = call(s, 0.5, ObstacleMode::touch);
  WaterMesher mesher;
  WaterMesh mesh;
  expect_fresh_bits(good, mesher, mesh);
  const WaterMesh before = mesh;
  ReconstructionOptions options = good.options;
  std::vector<std::string> messages;
  const auto refuse = [&](const ReconstructionInput& input) {
    const Status status = mesher.reconstruct(input, options, &mesh);
    EXPECT_FALSE(status.ok());
    expect_same(mesh, before);
    options = good.options;
    messages.push_back(status.message);
    expect_fresh_bits(good, mesher, mesh);
  };
  options.cell = 0;
  refuse(s.input());
  ReconstructionReport report;
  const WaterScene other = moved(s, Vec3(5, 0, 0));
  test::reconstruct(other.input(), options, &report);
  for (const double share : {1e-3, 0.2, 0.5, 0.95}) {  // refused at different stages
    options.memory_limit = share * report.bytes;
    refuse(other.input());
  }
  std::vector<Vec3> vertices = s.vertices;
  vertices[3].y() = std::nan("");
  ReconstructionInput input = s.input();
  input.obstacles[0].vertices = vertices;
  refuse(input);
  EXPECT_NE(messages.front().find("cell"), std::string::npos);
  EXPECT_NE(messages.back().find("not finite"), std::string::npos);
}

TEST(Reuse, keeps_its_memory_over_100_calls) {
  const WaterScene s = test::vee_scene(0.05);
  WaterMesher mesher;
  WaterMesh mesh;
  EXPECT_LT(mesher.bytes(), 1000u);
  std::size_t kept = 0;
  for (int n = 0; n < 100; ++n) {
    const WaterScene at = moved(s, Vec3(0.01 * (n % 5), 0, 0));
    ASSERT_TRUE(
        mesher.reconstruct(at.input(), test::options_for(at, 0.8, 0.1, ObstacleMode::touch), &mesh).ok());
    if (n == 9) kept = mesher.bytes();
    if (n > 9) {
      EXPECT_LE(mesher.bytes(), kept) << n;
    }
  }
  EXPECT_GT(kept, 10000u);
  const std::size_t mesh_bytes = mesh.positions.capacity() * sizeof(mesh.positions[0]);
  EXPECT_LE(mesh_bytes, 4 * mesh.positions.size() * sizeof(mesh.positions[0]));
}

}  // namespace
}  // namespace oilskin
