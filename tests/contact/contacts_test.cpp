// Records by closest feature, and that inner edges of a sheet do not brake what slides over them.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "support/find_contacts.h"
#include "support/particle_arrays.h"
#include "support/random.h"

namespace oilskin {
namespace {

using test::ParticleArrays;

std::vector<Contact> contacts_of(ParticleArrays& p, std::vector<SurfaceMotion>& surfaces) {
  std::vector<SurfaceMotion*> pointers;
  for (SurfaceMotion& s : surfaces) pointers.push_back(&s);
  return test::find_contacts(p.motion(), pointers);
}

SurfaceMotion flat_grid(double thickness = 0.002) {
  return test::make_grid(6, 6, Vec3::Zero(), Vec3(0.05, 0, 0), Vec3(0, 0, 0.05), 1e-5, thickness, 1,
                         Storage::float64);
}

TEST(Contacts, a_particle_over_a_flat_sheet_has_one_contact_wherever_it_is) {
  test::Random random(1);
  for (int k = 0; k < 500; ++k) {
    std::vector<SurfaceMotion> s{flat_grid()};
    ParticleArrays p;
    // over faces, over edges and over nodes
    const double grid = k % 3 == 0 ? 0.01 : (k % 3 == 1 ? 0.005 : 0);
    Vec3 x(random.uniform(0.001, 0.049), 0.0015, random.uniform(0.001, 0.049));
    if (grid > 0) x.x() = grid * std::round(x.x() / grid), x.z() = grid * std::round(x.z() / grid);
    p.add(x, Vec3::Zero(), 1e-4);
    const auto contacts = contacts_of(p, s);
    ASSERT_GE(contacts.size(), 1u);
    if (grid == 0) {
      EXPECT_EQ(contacts.size(), 1u);
    }
    for (const Contact& r : contacts) {
      EXPECT_NEAR(r.distance, 0.0015, 1e-12);
      EXPECT_NEAR(r.normal.y(), 1, 1e-9);
      EXPECT_NEAR(r.weights[0] + r.weights[1] + r.weights[2], 1, 1e-15);
    }
    std::set<std::uint64_t> features;
    for (const Contact& r : contacts) features.insert(r.feature);
    EXPECT_EQ(features.size(), contacts.size()) << "one record a feature";
  }
}

/// Two triangles that share the edge (0, 0, 0) (0, 0, 1); their other corners lie at the height y.
SurfaceMotion folded_sheet(double y) {
  SurfaceMotion s;
  s.id = 1;
  s.x_t0 = {{0, 0, 0}, {0, 0, 1}, {1, y, 0}, {-1, y, 0}};
  s.triangles = {{0, 2, 1}, {0, 1, 3}};
  s.x_t1 = s.x_t0;
  s.velocity.assign(4, Vec3::Zero());
  s.inverse_mass.assign(4, 1);
  s.thickness = 0.01;
  s.delta = minimum_separation(0.01, 2, Storage::float64);
  return s;
}

TEST(Contacts, the_wedge_outside_every_face_prism_of_a_convex_fold_has_a_contact) {
  std::vector<SurfaceMotion> surfaces{folded_sheet(-1)};
  ParticleArrays p;
  p.add({0.0005, 0.004, 0.3}, Vec3::Zero(), 1);
  const auto contacts = contacts_of(p, surfaces);
  ASSERT_EQ(contacts.size(), 1u) << "two triangles, one edge";
  EXPECT_NEAR(contacts[0].distance, std::hypot(0.0005, 0.004), 1e-15);
}

TEST(Contacts, a_valley_has_a_contact_for_each_side) {
  std::vector<SurfaceMotion> surfaces{folded_sheet(1)};
  ParticleArrays p;
  p.add({0.0005, 0.006, 0.3}, Vec3::Zero(), 1);
  EXPECT_EQ(contacts_of(p, surfaces).size(), 2u);
}

TEST(Contacts, duplicate_triangles_of_either_winding_share_one_contact) {
  std::vector<SurfaceMotion> s{flat_grid()};
  const std::vector<Triangle> once = s[0].triangles;
  for (const Triangle& t : once) s[0].triangles.push_back({t[1], t[0], t[2]});
  for (const Triangle& t : once) s[0].triangles.push_back(t);
  ParticleArrays p;
  p.add({0.0231, 0.0015, 0.0173}, Vec3::Zero(), 1e-4);
  EXPECT_EQ(contacts_of(p, s).size(), 1u);
}

TEST(Contacts, far_particles_have_none_and_approaching_ones_within_a_spacing_do) {
  std::vector<SurfaceMotion> s{flat_grid()};
  ParticleArrays p;
  p.add({0.0231, 0.006, 0.0173}, Vec3::Zero(), 1e-4);  // within h + dx, at rest
  p.add({0.0231, 0.006, 0.0173}, {0, -5, 0}, 1e-4);    // within h + dx, will undercut h
  p.add({0.0231, 0.009, 0.0173}, {0, -9, 0}, 1e-4);    // beyond h + dx: left to the continuous test
  p.move(1e-3);
  const auto contacts = contacts_of(p, s);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0].particle, 1u);
}

TEST(Contacts, degenerate_triangles_give_finite_contacts) {
  SurfaceMotion s;
  s.id = 1;
  s.x_t0 = {{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {2, 0, 0}, {2, 0, 0}};
  s.triangles = {{0, 1, 2}, {3, 4, 3}, {1, 1, 1}};
  s.x_t1 = s.x_t0;
  s.velocity.assign(5, Vec3::Zero());
  s.inverse_mass.assign(5, 1);
  s.thickness = 0.01;
  s.delta = minimum_separation(0.01, 4, Storage::float64);
  std::vector<SurfaceMotion> surfaces{s};
  ParticleArrays p;
  p.add({0.3, 0.004, 0}, Vec3::Zero(), 1);
  p.add({2, 0.004, 0}, Vec3::Zero(), 1);
  p.add({1, 0.004, 0.001}, Vec3::Zero(), 1);
  const auto contacts = contacts_of(p, surfaces);
  std::set<std::uint32_t> found;
  for (const Contact& r : contacts) {
    found.insert(r.particle);
    EXPECT_TRUE(r.normal.allFinite());
    EXPECT_NEAR(r.normal.norm(), 1, 1e-12);
    EXPECT_NEAR(r.weights[0] + r.weights[1] + r.weights[2], 1, 1e-12);
  }
  EXPECT_EQ(found.size(), 3u);
}

// Sliding 10,000 steps over inner edges, close to the certified distance: no ghost collisions, no sticking.
TEST(Contacts, sliding_over_inner_edges_keeps_tangential_velocity) {
  for (double start_at : {0.002, 3.0e-6}) {
    std::vector<SurfaceMotion> s{test::make_grid(41, 41, Vec3(-1, 0, -1), Vec3(2, 0, 0), Vec3(0, 0, 2), 0,
                                                 0.002, 2, Storage::float64)};
    SurfaceMotion* surfaces[] = {&s[0]};
    ParticleArrays p;
    const Vec3 v(0.17, 0, 0.0611);
    p.add({-0.9, start_at, -0.5}, v, 1e-4);
    ContactSettings settings;
    settings.repulsion = Repulsion::none;  // nothing lifts it off
    ContactSolver solver(settings, 1);
    for (int k = 0; k < 10000; ++k) {
      p.move(1e-3);
      ParticleMotion motion = p.motion();
      ContactReport report;
      StageSeconds seconds;
      ASSERT_TRUE(solver.resolve(1e-3, motion, surfaces, report, seconds).ok());
      ASSERT_LE((p.velocity[0] - v).norm(), 1e-6 * v.norm()) << "step " << k;
      p.x_t0 = p.x_t1;
    }
    EXPECT_NEAR(p.x_t0[0].x(), -0.9 + 1.7, 1e-6);
  }
}

TEST(ContactSolver, two_surfaces_with_one_id_are_refused) {
  std::vector<SurfaceMotion> s{flat_grid(), flat_grid()};
  ASSERT_EQ(s[0].id, s[1].id);
  std::vector<SurfaceMotion*> surfaces{&s[0], &s[1]};
  ParticleArrays p;
  p.add(Vec3(0.02, 0.01, 0.02), Vec3::Zero(), 1e-4);
  ParticleMotion motion = p.motion();
  ContactReport report;
  ContactSolver solver(ContactSettings{}, 1);
  const Status status = solver.resolve(1e-3, motion, surfaces, report);
  EXPECT_FALSE(status.ok());
  EXPECT_NE(status.message.find("two surfaces have the id"), std::string::npos) << status.message;
  s[1].id += 1;
  EXPECT_TRUE(solver.resolve(1e-3, motion, surfaces, report).ok());
  const double thickness = s[1].thickness;
  s[1].thickness = 1e300;
  EXPECT_NE(solver.resolve(1e-3, motion, surfaces, report).message.find("< 1e15 m"), std::string::npos);
  s[1].thickness = thickness;
  surfaces.push_back(nullptr);
  EXPECT_EQ(solver.resolve(1e-3, motion, surfaces, report).message, "surface 2 is a null pointer");
}

}  // namespace
}  // namespace oilskin
