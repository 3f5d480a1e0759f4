// Hard cases 8, 21, 22, 25: thickness, coordinates far away, scale, nothing at all.
#include <gtest/gtest.h>

#include <cmath>

#include "hard_cases/hard_case.h"
#include "hard_cases/shooting.h"
#include "support/mock_cloth.h"
#include "support/random.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin::test {
namespace {

double smallest_that_would_do(const std::string& message) {
  const std::string words = "must be ≥ ";
  const auto at = message.find(words);
  return at == std::string::npos ? 0 : std::stod(message.substr(at + words.size()));
}

template <class Scalar>
double check_thin(double thickness, double r) {
  WorldSettings settings;
  settings.kill_box = {Vec3::Constant(-r), Vec3::Constant(r)};
  World w(settings);
  MockCloth<Scalar> cloth;
  const Status refused = w.attach(cloth, sheet_settings(thickness), nullptr);
  EXPECT_FALSE(refused.ok()) << thickness;
  const double minimum = smallest_that_would_do(refused.message);
  EXPECT_GT(minimum, 0) << refused.message;
  EXPECT_TRUE(w.attach(cloth, sheet_settings(1.0001 * minimum), nullptr).ok()) << minimum;
  EXPECT_FALSE(w.attach(cloth, sheet_settings(0.999 * minimum), nullptr).ok()) << minimum;
  return minimum;
}

TEST(HardGeometry, a_thickness_of_zero_or_1e_12_is_refused_with_the_smallest_that_would_do) {
  HardCase c("8", "thickness 0 and 1e-12 m");
  const double in_float = check_thin<float>(1e-12, 10);
  EXPECT_NEAR(check_thin<float>(0, 10), in_float, 1e-3 * in_float);
  const double in_double = check_thin<double>(0, 10);
  check_thin<double>(1e-12, 100);  // at ±10 m a double host may be 1e-12 m thick: 4 δ is less
  // … and then nothing passes.
  ContactScene scene;
  scene.surfaces = {make_grid(5, 5, Vec3(-0.02, 0, -0.02), Vec3(0.04, 0, 0), Vec3(0, 0, 0.04), node_mass,
                              1e-12, 10, Storage::float64)};
  Random random(3);
  aim(scene, scene.surfaces[0].x_t0, 50, random);
  scene.move();
  const Found f = resolve_checked(scene);
  c.note("smallest thickness at 10 m, floats [m]", in_float);
  c.below("smallest thickness at 10 m, doubles [m]", in_double, 1e-12);
  c.note("shots at 1e-12 m, doubles", f.audit.particles);
  c.no_crossings(f);
  c.note("impacts", f.total.impacts);
}

// A sheet with particles around it: within the thickness, approaching, and too fast for anything but the
// continuous test. Every number is a multiple of 2⁻¹² of `unit`, so that moving and scaling round nothing.
ContactScene busy_scene(const HostKind& host, double unit, const Vec3& offset, double thickness, double r) {
  const auto snapped = [&](const Vec3& x) { return Vec3((x * 4096).array().round() / 4096 * unit); };
  ContactScene scene;
  scene.spacing = unit * 0x1p-3;
  SurfaceMotion sheet = make_grid(9, 9, Vec3(-1, 0, -1) * unit, Vec3(2, 0, 0) * unit, Vec3(0, 0, 2) * unit,
                                  mass_of_nodes(host), thickness, r, host.storage);
  Random random(9);
  for (std::size_t i = 0; i < sheet.x_t0.size(); ++i) {
    sheet.x_t0[i] = snapped(sheet.x_t0[i] / unit + random.in_cube(0.02)) + offset;
    sheet.x_t1[i] = sheet.x_t0[i];
  }
  scene.surfaces = {sheet};
  for (int k = 0; k < 60; ++k) {
    const double side = k % 2 ? 1 : -1;
    const Vec3 x(random.uniform(-0.9, 0.9), side * random.uniform(0.12, 0.4), random.uniform(-0.9, 0.9));
    const double speed = k % 3 == 0 ? 1000 : 50;
    const Vec3 v = speed * (0.4 * random.in_cube(1) - Vec3(0, side, 0));
    scene.particles.add(snapped(x) + offset, snapped(v), particle_mass);
  }
  scene.move();
  return scene;
}

// Largest differences of positions, less the offset and in units of `unit`, and of velocities.
struct Difference {
  double position = 0, velocity = 0, speed = 0;
};
Difference compare(const ContactScene& a, const ContactScene& b, double scale, const Vec3& offset) {
  Difference d;
  const auto positions = [&](const std::vector<Vec3>& xs, const std::vector<Vec3>& ys) {
    for (std::size_t i = 0; i < xs.size(); ++i)
      d.position = std::max(d.position, (xs[i] - (ys[i] - offset) / scale).norm());
  };
  const auto velocities = [&](const std::vector<Vec3>& xs, const std::vector<Vec3>& ys) {
    for (std::size_t i = 0; i < xs.size(); ++i) {
      d.velocity = std::max(d.velocity, (xs[i] - ys[i] / scale).norm());
      d.speed = std::max(d.speed, xs[i].norm());
    }
  };
  positions(a.particles.x_t1, b.particles.x_t1);
  velocities(a.particles.velocity, b.particles.velocity);
  for (std::size_t s = 0; s < a.surfaces.size(); ++s) {
    positions(a.surfaces[s].x_t1, b.surfaces[s].x_t1);
    velocities(a.surfaces[s].velocity, b.surfaces[s].velocity);
  }
  return d;
}

TEST(HardGeometry, far_from_the_origin_contact_gives_the_same_result_or_is_refused) {
  HardCase c("21", "2^20 m from the origin in double, 2^10 m in float; float at 1e6 m");
  Difference worst[2];
  double tolerance[2] = {};
  for (const HostKind& host : host_kinds) {
    SCOPED_TRACE(host.name);
    const bool is_float = host.storage == Storage::float32;
    const double far = is_float ? 0x1p10 : 0x1p20;
    const Vec3 offset(far, -far, far);
    // δ is that of the far place in both: at the origin it would be smaller.
    const double thickness = 0x1p-4, r = far + 2;
    ContactScene here = busy_scene(host, 1, Vec3::Zero(), thickness, r);
    ContactScene there = busy_scene(host, 1, offset, thickness, r);
    const Found f = resolve_checked(here);
    EXPECT_GT(f.total.impacts, 0u);
    EXPECT_GT(f.total.contacts, 0u);
    resolve_checked(there);
    const Difference d = compare(here, there, 1, offset);
    // What contact moves is rounded to the host's numbers, which are coarser there: 0.1 mm in float.
    const double ulp = far * (is_float ? 0x1p-23 : 0x1p-52);
    EXPECT_LE(d.position, 1e-6 + 4 * ulp);
    EXPECT_LE(d.velocity, (1e-6 + 4 * ulp) * d.speed);
    tolerance[is_float ? 0 : 1] = 1e-6 + 4 * ulp;
    Difference& w = worst[is_float ? 0 : 1];
    w.position = std::max(w.position, d.position);
    w.velocity = std::max(w.velocity, d.velocity / d.speed);
  }
  WorldSettings settings;
  settings.kill_box = {Vec3::Constant(-1e6), Vec3::Constant(1e6)};
  World w(settings);
  MockCloth<float> cloth;
  const Status refused = w.attach(cloth, sheet_settings(), nullptr);
  EXPECT_FALSE(refused.ok());
  EXPECT_NEAR(smallest_that_would_do(refused.message), 4 * 64 * 0x1p-23 * 1e6, 0.01);
  c.at_most("positions differ, doubles [m]", worst[1].position, tolerance[1]);
  c.at_most("positions differ, floats [m]", worst[0].position, tolerance[0]);
  c.at_most("velocities differ, doubles, of the speed", worst[1].velocity, tolerance[1]);
  c.at_most("velocities differ, floats, of the speed", worst[0].velocity, tolerance[0]);
  c.note("smallest thickness at 1e6 m, floats [m]", smallest_that_would_do(refused.message));
}

TEST(HardGeometry, scaled_by_2_to_the_20_up_and_down_results_are_the_same_bit_for_bit) {
  HardCase c("22", "the same scene 2^20 times smaller and larger");
  std::uint64_t compared = 0, different = 0;
  for (const HostKind& host : host_kinds)
    for (double scale : {0x1p-20, 0x1p20}) {
      SCOPED_TRACE(std::string(host.name) + ", scale " + shown(scale));
      ContactScene one = busy_scene(host, 1, Vec3::Zero(), 0x1p-4, 4);
      ContactScene other = busy_scene(host, scale, Vec3::Zero(), 0x1p-4 * scale, 4 * scale);
      const Found f = resolve_checked(one);
      const Found g = resolve_checked(other);
      EXPECT_GT(f.total.impacts, 0u);
      EXPECT_GT(f.total.contacts, 0u);
      EXPECT_EQ(f.total.impacts, g.total.impacts);
      EXPECT_EQ(f.total.contacts, g.total.contacts);
      const Difference d = compare(one, other, scale, Vec3::Zero());
      EXPECT_EQ(d.position, 0);
      EXPECT_EQ(d.velocity, 0);
      different += d.position != 0 || d.velocity != 0;
      compared += one.particles.id.size() + one.surfaces[0].x_t0.size();
    }
  c.note("points", compared);
  c.equal("positions or velocities with other bits", different, 0);
}

TEST(HardGeometry, with_nothing_or_one_of_everything_a_step_runs) {
  HardCase c("25", "no particle, no surface, one particle, one triangle; a surface without triangles");
  ContactScene nothing;
  resolve_checked(nothing);
  for (const HostKind& host : host_kinds) {
    SCOPED_TRACE(host.name);
    ContactScene no_particles;
    no_particles.surfaces = {square_sheet(host)};
    resolve_checked(no_particles);
    EXPECT_EQ(no_particles.surfaces[0].x_t1, square_sheet(host).x_t0);
    ContactScene no_surface;
    no_surface.particles.add(Vec3::Zero(), Vec3(0, -5000, 0), particle_mass);
    no_surface.move();
    resolve_checked(no_surface);
    EXPECT_EQ(no_surface.particles.x_t1[0], Vec3(0, -5, 0));
    ContactScene one;
    one.surfaces = {mesh_surface({{0, 0, 0}, {0.01, 0, 0}, {0, 0, 0.01}}, {{0, 1, 2}}, host.storage,
                                 mass_of_nodes(host))};
    one.particles.add(Vec3(0.003, 0.01, 0.003), Vec3(0, -20, 0), particle_mass);
    one.move();
    EXPECT_GT(resolve_checked(one).total.impacts, 0u);
  }
  World empty;
  EXPECT_TRUE(empty.step(1e-3).status.ok());
  StaticMesh no_triangles;
  no_triangles.nodes = {Vec3::Zero()};
  const Status refused = empty.attach(no_triangles, sheet_settings(), nullptr);
  EXPECT_NE(refused.message.find("no triangles"), std::string::npos);
  c.holds("every combination runs", !HasFailure());
  c.holds("a surface without triangles is refused", !refused.ok());
}

}  // namespace
}  // namespace oilskin::test
