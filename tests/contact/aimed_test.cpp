// Particles aimed where tests like to fail: exactly at nodes, at inner edges, at border edges in the plane of
// the sheet, at triangles without area; thousands of times too fast; at coordinates far away or scaled.
#include <gtest/gtest.h>

#include <cmath>

#include "support/particle_arrays.h"
#include "support/random.h"

namespace oilskin {
namespace {

using test::ParticleArrays;
using test::Random;

struct Outcome {
  std::uint64_t crossings = 0;
  std::vector<Vec3> ends;
};

// One interval of 1 ms with verify on.
Outcome shoot(std::vector<SurfaceMotion>& sheets, ParticleArrays& p, double dt = 1e-3) {
  std::vector<SurfaceMotion*> surfaces;
  for (SurfaceMotion& s : sheets) surfaces.push_back(&s);
  ParticleMotion motion = p.motion();
  ContactSettings settings;
  settings.verify = true;
  ContactReport report;
  StageSeconds seconds;
  const Status status = ContactSolver(settings, 1).resolve(dt, motion, surfaces, report, seconds);
  EXPECT_TRUE(status.ok()) << status.message;
  EXPECT_EQ(report.removed, 0u);
  for (std::size_t i = 0; i < p.id.size(); ++i) {
    EXPECT_TRUE(p.x_t1[i].allFinite());
    EXPECT_TRUE(p.velocity[i].allFinite());
  }
  return {report.crossings_found_by_verify, p.x_t1};
}

SurfaceMotion sheet(double mass, double thickness = 0.001) {
  return test::make_grid(5, 5, Vec3(-0.02, 0, -0.02), Vec3(0.04, 0, 0), Vec3(0, 0, 0.04), mass, thickness, 2,
                         Storage::float32);
}

class Speed : public ::testing::TestWithParam<double> {};

TEST_P(Speed, nothing_passes_at_nodes_edges_and_faces_of_free_and_pinned_sheets) {
  const double speed = GetParam();
  for (double mass : {0.0, 1e-6, 1e-2}) {
    for (int axis_aligned : {1, 0}) {
      std::vector<SurfaceMotion> sheets{sheet(mass)};
      ParticleArrays p;
      Random random(7);
      for (const Vec3& node : sheets[0].x_t0)
        for (const Triangle& t : {sheets[0].triangles[3], sheets[0].triangles[12]}) {
          const Vec3 edge = 0.5 * (sheets[0].x_t0[t[0]] + sheets[0].x_t0[t[1]]);
          const Vec3 face = (sheets[0].x_t0[t[0]] + sheets[0].x_t0[t[1]] + sheets[0].x_t0[t[2]]) / 3;
          for (const Vec3& target : {node, edge, face}) {
            const double side = random.uniform() < 0.5 ? -1 : 1;
            const Vec3 displacement =
                axis_aligned ? Vec3(0, -side, 0) : Vec3(Vec3(0, -side, 0) + 0.7 * random.in_cube(1));
            p.add(target - 0.5 * displacement * speed * 1e-3, displacement * speed, 1.25e-4);
          }
        }
      p.move(1e-3);
      const std::vector<Vec3> start = p.x_t0;
      const Outcome o = shoot(sheets, p);
      EXPECT_EQ(o.crossings, 0u) << "mass " << mass;
      if (!axis_aligned || mass != 0) continue;
      for (std::size_t i = 0; i < start.size(); ++i)
        if (std::abs(start[i].x()) < 0.0199 && std::abs(start[i].z()) < 0.0199) {
          EXPECT_GT(o.ends[i].y() * start[i].y(), 0) << "particle " << i << " changed sides";
        }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(MetresPerSecond, Speed, ::testing::Values(3.0, 50.0, 500.0, 5000.0));

TEST(Aimed, sliding_in_the_plane_of_the_sheet_into_its_border_edge_is_stopped) {
  std::vector<SurfaceMotion> sheets{sheet(0)};
  ParticleArrays p;
  p.add({-0.03, 0, 0.003}, {20, 0, 0}, 1e-4);
  p.add({-0.03, 0, 0.01}, {20, 0, 0}, 1e-4);  // along an edge line of the grid
  p.move(1e-3);
  const Outcome o = shoot(sheets, p);
  EXPECT_EQ(o.crossings, 0u);
  for (const Vec3& x : o.ends) EXPECT_LT(x.x(), -0.02);
}

TEST(Aimed, outside_the_border_nothing_is_stopped) {
  std::vector<SurfaceMotion> sheets{sheet(0)};
  ParticleArrays p;
  p.add({-0.0215, 0.01, 0}, {0, -20, 0}, 1e-4);  // 1.5 mm beside the border, thickness 1 mm
  p.move(1e-3);
  const Outcome o = shoot(sheets, p);
  EXPECT_EQ(o.ends[0], Vec3(-0.0215, 0.01 - 0.02, 0));
  EXPECT_EQ(p.velocity[0], Vec3(0, -20, 0));
}

TEST(Aimed, triangles_without_area_stop_what_is_aimed_at_them) {
  SurfaceMotion s;
  s.id = 1;
  s.x_t0 = {{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {2, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3.5, 0, 0}, {3, 0, 1e-12}};
  s.triangles = {{0, 1, 2}, {3, 4, 3}, {5, 6, 7}};
  s.x_t1 = s.x_t0;
  s.velocity.assign(8, Vec3::Zero());
  s.inverse_mass.assign(8, 0);
  s.thickness = 0.001;
  s.delta = minimum_separation(0.001, 4, Storage::float64);
  std::vector<SurfaceMotion> sheets{s};
  ParticleArrays p;
  for (double x : {0.3, 0.5, 1.0, 2.0, 3.25}) p.add({x, 0.01, 0}, {0, -20, 0}, 1e-4);
  p.add({0.3, 0.01, 0.0015}, {0, -20, 0}, 1e-4);  // beside the segment
  p.move(1e-3);
  const Outcome o = shoot(sheets, p);
  EXPECT_EQ(o.crossings, 0u);
  for (int i = 0; i < 5; ++i) EXPECT_GT(o.ends[i].y(), 0) << i;
  EXPECT_LT(o.ends[5].y(), 0);
}

TEST(Aimed, duplicate_triangles_stop_as_one) {
  for (int copies : {1, 3}) {
    std::vector<SurfaceMotion> sheets{sheet(1e-3)};
    const std::vector<Triangle> once = sheets[0].triangles;
    for (int k = 1; k < copies; ++k)
      for (const Triangle& t : once) sheets[0].triangles.push_back(k % 2 ? Triangle{t[2], t[1], t[0]} : t);
    ParticleArrays p;
    p.add({0.0031, 0.0008, 0.0057}, {1, -3, 0.5}, 1e-4);
    p.move(1e-3);
    const Outcome o = shoot(sheets, p);
    static Vec3 first_end, first_velocity;
    if (copies == 1) {
      first_end = o.ends[0];
      first_velocity = p.velocity[0];
    } else {
      EXPECT_EQ(o.ends[0], first_end);
      EXPECT_EQ(p.velocity[0], first_velocity);
    }
  }
}

TEST(Aimed, a_sheet_swept_through_resting_particles_at_any_speed_takes_them_along) {
  for (double speed : {1.0, 50.0, 500.0}) {
    for (double turn : {0.0, 3.0}) {  // also flipped over within the step
      std::vector<SurfaceMotion> sheets{sheet(0)};
      SurfaceMotion& s = sheets[0];
      const Eigen::Matrix3d rotation = Eigen::AngleAxisd(turn, Vec3(0.6, 0, 0.8)).toRotationMatrix();
      ParticleArrays p;
      Random random(3);
      for (int k = 0; k < 60; ++k)
        p.add(Vec3(random.uniform(-0.015, 0.015), random.uniform(0.0011, std::max(0.002, 0.8e-3 * speed)),
                   random.uniform(-0.015, 0.015)),
              Vec3::Zero(), 1e-4);
      for (std::size_t i = 0; i < s.x_t0.size(); ++i) {
        s.x_t1[i] = stored(rotation * s.x_t0[i] + Vec3(0, speed * 1e-3, 0), s.storage);
        s.velocity[i] = (s.x_t1[i] - s.x_t0[i]) / 1e-3;
      }
      EXPECT_EQ(shoot(sheets, p).crossings, 0u) << speed << " m/s, turned by " << turn;
    }
  }
}

TEST(Aimed, ten_layers_stop_a_fast_particle_at_the_first) {
  std::vector<SurfaceMotion> sheets;
  for (int k = 0; k < 10; ++k) {
    SurfaceMotion s = sheet(1e-5);
    s.id = static_cast<std::uint64_t>(k + 1);
    for (auto* xs : {&s.x_t0, &s.x_t1})
      for (Vec3& x : *xs) x = stored(x - Vec3(0, 0.002 * k, 0), s.storage);
    sheets.push_back(s);
  }
  ParticleArrays p;
  p.add({0.0031, 0.1, 0.0057}, {0, -500, 0}, 1e-4);
  p.move(1e-3);
  const Outcome o = shoot(sheets, p);
  EXPECT_EQ(o.crossings, 0u);
  EXPECT_GT(o.ends[0].y(), 0);
}

// Scaling by a power of two and moving by a representable offset change nothing but the units.
TEST(Aimed, results_scale_bit_for_bit) {
  const auto run = [](double scale) {
    SurfaceMotion s =
        test::make_grid(5, 5, Vec3(-0.02, 0, -0.02) * scale, Vec3(0.04, 0, 0) * scale,
                        Vec3(0, 0, 0.04) * scale, 1e-3, 0.001 * scale, 2 * scale, Storage::float64);
    ParticleArrays p;
    Random random(11);
    for (int k = 0; k < 50; ++k)
      p.add(Vec3(random.uniform(-0.02, 0.02), random.uniform(0.0005, 0.004), random.uniform(-0.02, 0.02)) *
                scale,
            (random.in_cube(1) - Vec3(0, 4, 0)) * scale, 1e-4);
    p.move(1e-3);
    ParticleMotion motion = p.motion(0.005 * scale);
    SurfaceMotion* surfaces[] = {&s};
    ContactReport report;
    StageSeconds seconds;
    EXPECT_TRUE(ContactSolver(ContactSettings{}, 1).resolve(1e-3, motion, surfaces, report, seconds).ok());
    std::vector<Vec3> result;
    for (const auto* list : {&p.x_t1, &p.velocity, &s.x_t1, &s.velocity})
      for (const Vec3& v : *list) result.push_back(v / scale);
    return result;
  };
  const std::vector<Vec3> one = run(1);
  EXPECT_EQ(run(0x1p20), one);
  EXPECT_EQ(run(0x1p-20), one);
}

}  // namespace
}  // namespace oilskin
