// What is refused, skipped, and what empty input gives.
#include <gtest/gtest.h>

#include <cmath>

#include "reconstruction/runs.h"
#include "reconstruction/scenes.h"

namespace oilskin {
namespace {

const std::vector<Vec3> two = {Vec3(0, 0, 0), Vec3(0.004, 0, 0)};

ReconstructionInput input_of(const std::vector<Vec3>& particles) {
  ReconstructionInput in;
  in.positions = particles;
  return in;
}

struct Refusal {
  const char* message;  // begins with the field
  void (*spoil)(ReconstructionOptions&);
};

class Refused : public testing::TestWithParam<Refusal> {};

TEST_P(Refused, with_the_field_and_the_mesh_stays) {
  ReconstructionOptions options;
  GetParam().spoil(options);
  WaterMesh mesh;
  mesh.positions.push_back({1, 2, 3});
  const Status status = reconstruct_surface(input_of(two), options, &mesh);
  EXPECT_EQ(status.message.substr(0, std::string(GetParam().message).size()), GetParam().message)
      << status.message;
  EXPECT_EQ(mesh.positions.size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(
    Options, Refused,
    testing::Values(
        Refusal{"spacing is 0;", [](ReconstructionOptions& o) { o.spacing = 0; }},
        Refusal{"spacing is nan;", [](ReconstructionOptions& o) { o.spacing = std::nan(""); }},
        Refusal{"cell is 0;", [](ReconstructionOptions& o) { o.cell = 0; }},
        Refusal{"cell is -1;", [](ReconstructionOptions& o) { o.cell = -1; }},
        Refusal{"cell is 1.5;", [](ReconstructionOptions& o) { o.cell = 1.5; }},
        Refusal{"kernel_radius is 1;", [](ReconstructionOptions& o) { o.kernel_radius = 1; }},
        Refusal{"particle_radius is 0;", [](ReconstructionOptions& o) { o.particle_radius = 0; }},
        Refusal{"field is 9;",
                [](ReconstructionOptions& o) { o.field = static_cast<ReconstructionField>(9); }},
        Refusal{"contact is -1;",
                [](ReconstructionOptions& o) { o.contact = static_cast<ObstacleMode>(-1); }},
        Refusal{"gap is -0.001;", [](ReconstructionOptions& o) { o.gap = -0.001; }},
        Refusal{"gap is 0.1;", [](ReconstructionOptions& o) { o.gap = 0.1; }},
        Refusal{"touch_range is 2;", [](ReconstructionOptions& o) { o.touch_range = 2; }},
        Refusal{"contact is 6;", [](ReconstructionOptions& o) { o.contact = static_cast<ObstacleMode>(6); }},
        Refusal{"wet_saturation is 1.5;", [](ReconstructionOptions& o) { o.wet_saturation = 1.5; }},
        Refusal{"wet_blend is -1;", [](ReconstructionOptions& o) { o.wet_blend = -1; }},
        Refusal{"overlap_depth is 1;", [](ReconstructionOptions& o) { o.overlap_depth = 1; }},
        Refusal{"smoothing_iterations is -1;", [](ReconstructionOptions& o) { o.smoothing_iterations = -1; }},
        Refusal{"clip is 1;",
                [](ReconstructionOptions& o) {
                  o.clip = Box{Vec3::Ones(), Vec3::Zero()};
                }},
        Refusal{"min_blob is -1;", [](ReconstructionOptions& o) { o.min_blob = -1; }},
        Refusal{"memory_limit is 0;", [](ReconstructionOptions& o) { o.memory_limit = 0; }},
        Refusal{"threads is -1;", [](ReconstructionOptions& o) { o.threads = -1; }}));

TEST(Input, arrays_and_obstacles_that_do_not_fit_are_refused_by_name) {
  WaterMesh mesh;
  const ReconstructionOptions options;
  const auto message = [&](const ReconstructionInput& in) {
    return reconstruct_surface(in, options, &mesh).message;
  };
  ReconstructionInput in = input_of(two);
  const std::vector<Vec3> one_velocity = {Vec3::Zero()};
  in.velocities = one_velocity;
  EXPECT_EQ(message(in), "velocities has 1 values; there are 2 positions");
  in = input_of(two);
  const std::vector<float> three = {1, 2, 3};
  in.attributes.push_back({three, 2});
  EXPECT_EQ(message(in), "attribute 0 of 2 components has 3 values; there are 2 positions");
  in.attributes[0].components = 0;
  EXPECT_EQ(message(in), "attribute 0: components is 0; it must be ≥ 1");
  in = input_of(two);
  const std::vector<Vec3> bad = {Vec3::Zero(), Vec3(0, std::nan(""), 0), Vec3::Zero()};
  const std::vector<Triangle> face = {{0, 1, 2}}, beyond = {{0, 1, 3}};
  in.obstacles.push_back({bad, face});
  EXPECT_EQ(message(in), "obstacle 0: vertex 1 is not finite");
  const std::vector<Vec3> good = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()};
  in.obstacles[0] = {good, beyond};
  EXPECT_EQ(message(in), "obstacle 0: triangle 0 names vertex 3; there are 3");
  const std::vector<Triangle> face_of_good = {{0, 1, 2}};
  const std::vector<float> short_by_one = {0, 1}, not_finite = {0, std::nanf(""), 1};
  in.obstacles[0] = {good, face_of_good, short_by_one};
  EXPECT_EQ(message(in), "obstacle 0: saturation has 2 values; there are 3 vertices");
  in.obstacles[0].saturation = not_finite;
  EXPECT_EQ(message(in), "obstacle 0: saturation 1 is not finite");
}

/// A triangle 4 mm under the two particles, one of its corners at x = `far`.
std::vector<Vec3> reaching_out_to(double far) {
  return {Vec3(-1, -1, -0.004), Vec3(-1, 1, -0.004), Vec3(far, 0, -0.004)};
}

TEST(Input, a_corner_too_far_out_for_its_numbers_is_refused_unless_it_is_nowhere_near) {
  const std::vector<Triangle> face = {{0, 1, 2}};
  const ReconstructionOptions options;
  WaterMesh mesh;
  for (const double far : {1e15, 1e300, 12345678.9}) {
    const std::vector<Vec3> vertices = reaching_out_to(far);
    ReconstructionInput in = input_of(two);
    in.obstacles.push_back({vertices, face});
    const std::string message = reconstruct_surface(in, options, &mesh).message;
    EXPECT_EQ(message.substr(0, 39), "obstacle 0: triangle 0 has a corner at ") << message;
  }
  for (const double far : {1e3, 1e6}) {  // a wide floor, floats hold it exactly
    const std::vector<Vec3> vertices = reaching_out_to(far);
    ReconstructionInput in = input_of(two);
    in.obstacles.push_back({vertices, face});
    const WaterMesh above = test::reconstruct(in, options);
    EXPECT_TRUE(check_mesh(above, in.obstacles, options.gap).clean()) << far;
    EXPECT_GE(check_mesh(above, {}, 0).components, 1u);
  }
  // What is wholly elsewhere changes nothing.
  const std::vector<Vec3> elsewhere = {Vec3(1e15, 0, 0), Vec3(1e15, 1, 0), Vec3(2e15, 0, 1)};
  ReconstructionInput in = input_of(two);
  const WaterMesh plain = test::reconstruct(in, options);
  in.obstacles.push_back({elsewhere, face});
  EXPECT_EQ(test::reconstruct(in, options).positions, plain.positions);
}

TEST(Input, no_particles_give_an_empty_mesh) {
  ReconstructionOptions options;
  WaterMesh mesh;
  mesh.positions.push_back({1, 2, 3});
  ASSERT_TRUE(reconstruct_surface(ReconstructionInput(), options, &mesh).ok());
  EXPECT_TRUE(mesh.positions.empty() && mesh.triangles.empty() && mesh.normals.empty());
  EXPECT_TRUE(check_mesh(mesh, {}, 0).clean());
  // … nor does water that is all outside the clip box
  options.clip = Box{Vec3::Constant(5), Vec3::Constant(6)};
  ASSERT_TRUE(reconstruct_surface(input_of(two), options, &mesh).ok());
  EXPECT_TRUE(mesh.triangles.empty());
}

TEST(Input, particles_that_are_not_finite_or_far_out_are_skipped_and_counted) {
  const ReconstructionOptions options;
  const WaterMesh plain = test::reconstruct(input_of(two), options);
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<Vec3> spoiled = {Vec3(0, 0, 0), Vec3(std::nan(""), 0, 0), Vec3(0, -inf, 0),
                                     Vec3(0, 0, 1e300), Vec3(0.004, 0, 0)};
  ReconstructionReport report;
  const WaterMesh mesh = test::reconstruct(input_of(spoiled), options, &report);
  EXPECT_EQ(report.particles_skipped, 3u);
  EXPECT_EQ(mesh.positions, plain.positions);
  EXPECT_EQ(mesh.triangles, plain.triangles);
  std::vector<Vec3> velocities(3, Vec3::UnitX());
  velocities[1].z() = std::nan("");
  const std::vector<Vec3> three = {Vec3(0, 0, 0), Vec3(0.002, 0.001, 0), Vec3(0.004, 0, 0)};
  ReconstructionInput moving = input_of(three);
  moving.velocities = velocities;
  const WaterMesh of_moving = test::reconstruct(moving, options, &report);
  EXPECT_EQ(report.particles_skipped, 1u);
  EXPECT_EQ(of_moving.positions, plain.positions);
}

TEST(Input, more_memory_than_allowed_is_refused_with_the_numbers) {
  test::Random random(31);
  std::vector<Vec3> spray;
  for (int i = 0; i < 20000; ++i) spray.push_back(random.in_cube(100));
  ReconstructionOptions options;
  options.memory_limit = 20e6;
  WaterMesh mesh;
  const Status status = reconstruct_surface(input_of(spray), options, &mesh);
  EXPECT_NE(status.message.find("memory_limit is 20 MB"), std::string::npos) << status.message;
  EXPECT_NE(status.message.find("would need"), std::string::npos);
  options.memory_limit = 1e5;
  EXPECT_EQ(reconstruct_surface(input_of(spray), options, &mesh).message.substr(0, 21),
            "sorting the particles");
  options.memory_limit = 4e9;
  ReconstructionReport report;
  spray.resize(500);
  ASSERT_TRUE(reconstruct_surface(input_of(spray), options, &mesh, &report).ok());
  EXPECT_GT(report.bytes, 1e6);
  EXPECT_LT(report.bytes, 2e8);
}

TEST(Input, many_particles_in_one_place_take_no_more_than_their_number) {
  const std::vector<Vec3> heap(200000, Vec3(0.01, 0.02, 0.03));
  const WaterMesh mesh = test::reconstruct(input_of(heap), ReconstructionOptions());
  test::expect_closed(check_mesh(mesh, {}, 0));
  EXPECT_FALSE(mesh.triangles.empty());
}

}  // namespace
}  // namespace oilskin
