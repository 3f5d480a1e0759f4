// The world: bad input, invalid particles, kill box, emission by contact's rules, threads.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "support/mock_cloth.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin {
namespace {

using test::GridShape;
using test::MockCloth;

WorldSettings box(double half, const Vec3& gravity = Vec3(0, -9.81, 0), int threads = 1) {
  WorldSettings s;
  s.kill_box = {Vec3::Constant(-half), Vec3::Constant(half)};
  s.gravity = gravity;
  s.threads = threads;
  return s;
}

GridShape sheet(double size, std::uint32_t nodes) {
  GridShape g;
  g.nu = g.nv = nodes;
  g.origin = Vec3(-size / 2, 0, -size / 2);
  g.u = Vec3(size, 0, 0);
  g.v = Vec3(0, 0, size);
  return g;
}

TEST(World, refuses_steps_and_settings_that_make_no_sense_and_keeps_its_state) {
  World w(box(2));
  ASSERT_TRUE(w.status().ok());
  for (double dt : {0.0, -1e-3, std::nan(""), std::numeric_limits<double>::infinity()}) {
    const StepReport& r = w.step(dt);
    EXPECT_FALSE(r.status.ok());
    EXPECT_NE(r.status.message.find("it must be 1e-12"), std::string::npos);
    EXPECT_EQ(w.step_count(), 0u);
  }
  FluidSettings bad;
  bad.spacing = -1;
  World refused(box(2), bad);
  EXPECT_NE(refused.status().message.find("fluid.spacing is -1"), std::string::npos);
  EXPECT_FALSE(refused.step(1e-3).status.ok());
  ContactSettings contact;
  contact.solver_iterations = 0;
  EXPECT_FALSE(w.set_contact_settings(contact).ok());
  EXPECT_EQ(w.contact_settings().solver_iterations, 5);
  EXPECT_FALSE(w.set_gravity(Vec3(0, std::nan(""), 0)).ok());
}

class Broken : public MockCloth<double> {
 public:
  std::function<void(SurfaceMotion&)> spoil;
  Gathered gather(double dt, SurfaceMotion& m) override {
    Gathered g = MockCloth<double>::gather(dt, m);
    if (spoil) spoil(m);
    return g;
  }
};

TEST(World, refuses_broken_meshes_with_a_message) {
  const struct {
    std::function<void(SurfaceMotion&)> spoil;
    const char* message;
  } cases[] = {
      {[](SurfaceMotion& m) { m.triangles.clear(); }, "no triangles"},
      {[](SurfaceMotion& m) { m.triangles[3][2] = 1000; },
       "triangle 3 has the node index 1000; the surface has 81 nodes"},
      {[](SurfaceMotion& m) { m.x_t1[5].z() = std::nan(""); }, "the position of node 5 is not finite"},
      {[](SurfaceMotion& m) { m.velocity[6].x() = INFINITY; }, "the velocity of node 6 is not finite"},
      {[](SurfaceMotion& m) { m.inverse_mass[7] = -1; }, "the inverse mass of node 7 is -1"},
      {[](SurfaceMotion& m) { m.velocity.pop_back(); }, "80 velocities"},
      {[](SurfaceMotion& m) {
         m.storage = Storage::float32;
         m.x_t1[0].x() = 0.1;
       },
       "node 0 is not a single-precision number"},
  };
  for (const auto& c : cases) {
    World w(box(2));
    Broken cloth;
    cloth.spoil = c.spoil;
    const Status s = w.attach(cloth, test::sheet_settings(), nullptr);
    EXPECT_FALSE(s.ok());
    EXPECT_NE(s.message.find(c.message), std::string::npos) << s.message;
    EXPECT_EQ(w.surface_count(), 0u);
  }
}

TEST(World, a_surface_that_breaks_while_attached_is_left_out_and_the_rest_goes_on) {
  World w(box(2));
  Broken cloth;
  SurfaceId id;
  ASSERT_TRUE(w.attach(cloth, test::sheet_settings(), &id).ok());
  ASSERT_TRUE(w.step(1e-3).status.ok());
  cloth.spoil = [](SurfaceMotion& m) { m.x_t1[5].z() = std::nan(""); };
  const StepReport& r = w.step(1e-3);
  EXPECT_TRUE(r.status.ok());
  EXPECT_TRUE(r.flags & flag_surface_refused);
  ASSERT_EQ(r.messages.size(), 1u);
  EXPECT_NE(r.messages[0].find("position of node 5"), std::string::npos);
  cloth.spoil = nullptr;
  w.reset_motion(id);
  EXPECT_FALSE(w.step(1e-3).flags & flag_surface_refused);
}

TEST(World, a_surface_that_changes_its_mesh_is_a_new_surface) {
  World w(box(2));
  Broken cloth;
  SurfaceId id;
  ASSERT_TRUE(w.attach(cloth, test::sheet_settings(), &id).ok());
  test::add_block(w, 3, Vec3(0.03, 0.01, 0.03), Vec3(0, -2, 0));
  w.step(1e-3);
  const std::uint64_t before = w.surface(id)->id;
  cloth.triangles.pop_back();  // torn
  w.step(1e-3);
  EXPECT_NE(w.surface(id)->id, before);
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(w.step(1e-3).status.ok());
}

TEST(World, non_finite_particles_are_removed_and_counted_and_the_others_continue) {
  World w(box(2, Vec3::Zero()));
  test::add_block(w, 3, Vec3(0, 0, 0), Vec3(1, 0, 0));
  std::vector<Vec3> dv(w.particle_count(), Vec3::Zero());
  dv[4].y() = std::nan("");
  dv[7].x() = 1e300;
  ASSERT_TRUE(w.add_velocities(dv).ok());
  const StepReport& r = w.step(1e-3);
  EXPECT_EQ(r.removed_invalid, 2u);
  EXPECT_TRUE(r.flags & flag_removed_invalid);
  EXPECT_EQ(w.particle_count(), 25u);
  for (const Vec3& x : w.positions()) EXPECT_TRUE(x.allFinite());
  EXPECT_FALSE(w.add_velocities(dv).ok());
  const Vec3 bad(0, std::nan(""), 0), zero = Vec3::Zero();
  EXPECT_FALSE(w.add_particles(Span<const Vec3>(&bad, 1), Span<const Vec3>(&zero, 1)).ok());
}

TEST(World, what_leaves_the_kill_box_is_removed_and_is_in_the_ledger) {
  World w(box(0.1, Vec3::Zero()));
  test::add_block(w, 2, Vec3(0.05, 0, 0), Vec3(10, 0, 0));
  Vec3 removed = Vec3::Zero();
  double mass = 0;
  for (int k = 0; k < 20; ++k) {
    const StepReport& r = w.step(1e-3);
    removed += r.momentum_removed;
    mass += r.mass_removed;
    EXPECT_LE(r.momentum_residual().norm(), 1e-12);
  }
  EXPECT_EQ(w.particle_count(), 0u);
  EXPECT_NEAR(mass, 8 * w.particle_mass(), 1e-15);
  EXPECT_NEAR(removed.x(), 80 * w.particle_mass(), 1e-6);
}

TEST(World, starts_too_close_to_a_surface_are_blocked_counted_and_wait) {
  World w(box(1));
  GridShape g = sheet(0.2, 9);
  MockCloth<double> cloth(g);
  for (std::size_t i = 0; i < cloth.x.size(); ++i) cloth.pin(i);
  ASSERT_TRUE(w.attach(cloth, test::sheet_settings(), nullptr).ok());
  DiscEmitter jet;
  jet.center = Vec3(0.001, 1e-9, 0.002);  // in the sheet
  jet.radius = 0.01;
  jet.speed = 1;
  ASSERT_TRUE(w.add_emitter(jet).ok());
  std::uint64_t blocked = 0, emitted = 0;
  for (int k = 0; k < 20; ++k) {
    const StepReport& r = w.step(1e-3);
    blocked += r.blocked_starts;
    emitted += r.emitted;
  }
  EXPECT_GT(blocked, 0u);
  EXPECT_EQ(emitted, 0u);
}

TEST(World, collision_masks_let_fluids_through_surfaces_of_other_groups) {
  World w(box(1, Vec3::Zero()));
  MockCloth<double> cloth(sheet(0.2, 9));
  SurfaceSettings s = test::sheet_settings();
  s.collision_group = 2;
  s.collision_mask = 4;
  ASSERT_TRUE(w.attach(cloth, s, nullptr).ok());
  test::add_block(w, 2, Vec3(0, 0.002, 0), Vec3(0, -5, 0));
  for (int k = 0; k < 5; ++k) w.step(1e-3);
  for (const Vec3& x : w.positions()) EXPECT_LT(x.y(), 0);
}

TEST(World, a_surface_left_out_is_not_asked_about_again) {
  World w(box(2));
  Broken cloth;
  ASSERT_TRUE(w.attach(cloth, test::sheet_settings(), nullptr).ok());
  cloth.spoil = [](SurfaceMotion& m) { m.x_t1.resize(3), m.velocity.resize(3), m.inverse_mass.resize(3); };
  EXPECT_TRUE(w.step(1e-3).flags & flag_surface_refused);
  test::add_block(w, 2, Vec3(0, 0.01, 0), Vec3::Zero());  // looked at its nodes once
  const std::uint64_t hash = w.state_hash();
  EXPECT_EQ(w.state_hash(), hash);
  EXPECT_TRUE(w.step(1e-3).status.ok());
}

TEST(World, momentum_of_invalid_particles_is_in_the_ledger) {
  FluidSettings whole;
  whole.max_substeps = 1;
  World w(box(2, Vec3::Zero()), whole);
  test::add_block(w, 2, Vec3::Zero(), Vec3(0, 1, 0));
  std::vector<Vec3> dv(8, Vec3::Zero());
  dv[3] = Vec3(1e13, 0, 0);  // sound now, beyond 1e15 m after the step
  ASSERT_TRUE(w.add_velocities(dv).ok());
  const StepReport& r = w.step(1e3);
  EXPECT_GE(r.removed_invalid, 1u) << "XSPH hands some of the speed to its neighbours";
  EXPECT_NEAR(r.momentum_residual().norm(), 0, 1e-9 * w.particle_mass() * 1e13);
}

TEST(World, particles_that_start_closer_than_delta_void_the_promise_and_raise_a_flag) {
  ContactSettings off;
  off.ccd = off.zones = false;
  WorldSettings settings = box(1, Vec3::Zero());
  FluidSettings paper;  // with boundary terms the wall would push the particle off
  paper.boundary = BoundaryModel::contact_only;
  World w(settings, paper, off);
  GridShape g = sheet(0.2, 9);
  MockCloth<double> cloth(g);
  for (std::size_t i = 0; i < cloth.x.size(); ++i) cloth.pin(i);
  const Vec3 x(0.003, 0.002, 0.004), v(0, 0, 0);
  ASSERT_TRUE(w.attach(cloth, test::sheet_settings(), nullptr).ok());
  ASSERT_TRUE(w.add_particles(Span<const Vec3>(&x, 1), Span<const Vec3>(&v, 1)).ok());
  w.step(1e-3);
  for (auto& node : cloth.x) node.y() += 0.002 - 1e-9;  // the pins come up to the particle, nothing looks
  w.step(1e-3);
  ASSERT_TRUE(w.set_contact_settings(ContactSettings{}).ok());
  EXPECT_TRUE(w.step(1e-3).flags & flag_no_promise);
  EXPECT_GT(w.report().contact.started_too_close, 0u);
}

TEST(World, emitters_and_cloths_where_nothing_lives_are_refused) {
  World w(box(1));
  DiscEmitter far;
  far.center = Vec3(0, 5, 0);
  EXPECT_NE(w.add_emitter(far).message.find("outside the kill box"), std::string::npos);
  DiscEmitter early;
  early.start = -1e300;
  EXPECT_NE(w.add_emitter(early).message.find("disc emitter: start"), std::string::npos);
  GridShape g = sheet(0.2, 9);
  g.origin.y() = 50;
  MockCloth<double> cloth(g);
  EXPECT_NE(w.attach(cloth, test::sheet_settings(), nullptr).message.find("kill box"), std::string::npos);
}

TEST(World, each_side_of_a_surface_has_its_own_slip_settings) {
  FluidSettings fluid;
  fluid.viscosity = 0, fluid.xsph_rate = 0;
  fluid.boundary = BoundaryModel::contact_only;
  World w(box(1, Vec3::Zero()), fluid);
  test::StaticMesh sheet;
  sheet.add_rectangle(Vec3(-0.1, 0, -0.1), Vec3(0, 0, 0.2), Vec3(0.2, 0, 0));  // the front looks up
  SurfaceSettings s = test::sheet_settings();
  s.slip_back.emplace().model = SlipModel::sticking;
  SurfaceId id;
  ASSERT_TRUE(w.attach(sheet, s, &id).ok());
  const std::vector<Vec3> x{{0, 0.001, 0}, {0.05, -0.001, 0}}, v(2, Vec3(0.1, 0, 0));
  ASSERT_TRUE(w.add_particles(x, v).ok());
  const auto speed = [&](std::uint64_t particle) {
    for (std::size_t i = 0; i < w.particle_count(); ++i)
      if (w.ids()[i] == particle) return w.velocities()[i].x();
    return -1.0;
  };
  const auto restart = [&] {
    std::vector<Vec3> dv;
    for (const Vec3& u : w.velocities()) dv.push_back(Vec3(0.1, 0, 0) - u);
    ASSERT_TRUE(w.add_velocities(dv).ok());
  };
  w.step(1e-4);
  EXPECT_NEAR(speed(1), 0.1, 1e-12);
  EXPECT_NEAR(speed(2), 0, 1e-12);
  SlipSettings sticking, free;
  sticking.model = SlipModel::sticking;
  restart();
  ASSERT_TRUE(w.set_slip(id, sticking, free).ok());
  w.step(1e-4);
  EXPECT_NEAR(speed(1), 0, 1e-12);
  EXPECT_NEAR(speed(2), 0.1, 1e-12);
  restart();
  ASSERT_TRUE(w.set_slip(id, sticking).ok()) << "both sides";
  w.step(1e-4);
  EXPECT_NEAR(speed(1), 0, 1e-12);
  EXPECT_NEAR(speed(2), 0, 1e-12);
  sticking.slip_length = -1;
  EXPECT_NE(w.set_slip(id, free, sticking).message.find("slip_back.slip_length"), std::string::npos);
}

struct Splash {
  std::uint64_t hash;
  std::uint64_t crossings;
};

Splash splash(int threads, double dt, Storage storage) {
  ContactSettings contact;
  contact.verify = true;
  World w(box(1, Vec3(0, -9.81, 0), threads), FluidSettings{}, contact);
  GridShape g = sheet(0.2, 21);
  MockCloth<double> in_double(g);
  MockCloth<float> in_float(g);
  for (std::size_t corner : {0u, 20u, 420u, 440u}) in_double.pin(corner), in_float.pin(corner);
  SurfaceHost& host = storage == Storage::float64 ? static_cast<SurfaceHost&>(in_double) : in_float;
  SurfaceSettings s = test::sheet_settings();
  s.slip.model = SlipModel::coulomb;
  s.slip.friction = 0.3;
  EXPECT_TRUE(w.attach(host, s, nullptr).ok());
  DiscEmitter jet;
  jet.center = Vec3(0.003, 0.04, -0.002);
  jet.radius = 0.015;
  jet.speed = 3;
  EXPECT_TRUE(w.add_emitter(jet).ok());
  Splash result{0, 0};
  for (int k = 0; k < static_cast<int>(0.08 / dt); ++k) {
    const StepReport& r = w.step(dt);
    EXPECT_TRUE(r.status.ok());
    result.crossings += r.contact.crossings_found_by_verify;
  }
  EXPECT_GT(w.particle_count(), 500u);
  result.hash = w.state_hash();
  return result;
}

TEST(World, same_input_same_bits_on_any_number_of_threads) {
  for (Storage storage : {Storage::float32, Storage::float64}) {
    const Splash one = splash(1, 1e-3, storage);
    for (int threads : {2, 3})
      EXPECT_EQ(splash(threads, 1e-3, storage).hash, one.hash) << threads << " threads";
    EXPECT_EQ(one.crossings, 0u);
  }
}

TEST(World, nothing_crosses_at_any_time_step) {
  for (double dt : {2e-4, 4e-3, 0.016})
    EXPECT_EQ(splash(2, dt, Storage::float32).crossings, 0u) << "dt " << dt;
}

/// Says that nothing changed, whether it was asked to number its nodes or not.
class Idler : public test::StaticMesh {
 public:
  bool idles = false;
  Gathered gather(double dt, SurfaceMotion& m) override {
    if (idles) return {Status{}, false, true};
    return StaticMesh::gather(dt, m);
  }
};

TEST(World, a_host_that_was_not_known_to_stand_still_cannot_say_that_nothing_changed) {
  World w;
  Idler host;
  host.add_rectangle(Vec3(-0.1, 0, -0.1), Vec3(0, 0, 0.2), Vec3(0.2, 0, 0));
  host.idles = true;
  const Status status = w.attach(host, test::sheet_settings(), nullptr);
  EXPECT_NE(status.message.find("motion.revision was 0"), std::string::npos) << status.message;
  EXPECT_EQ(w.surface_count(), 0u);
  host.idles = false;
  host.changes = test::StaticMesh::Changes::unknown;
  ASSERT_TRUE(w.attach(host, test::sheet_settings(), nullptr).ok());
  EXPECT_EQ(w.step(1e-3).flags & flag_surface_refused, 0u);
  host.idles = true;
  const StepReport& r = w.step(1e-3);
  EXPECT_NE(r.flags & flag_surface_refused, 0u);
  ASSERT_EQ(r.messages.size(), 1u);
  EXPECT_NE(r.messages[0].find("nothing changed"), std::string::npos);
}

/// The world finds out by itself whether what is numbered stands still.
TEST(World, a_numbered_surface_that_moves_is_read_in_every_step) {
  World w;
  test::StaticMesh host;
  host.add_rectangle(Vec3(-0.1, 0, -0.1), Vec3(0, 0, 0.2), Vec3(0.2, 0, 0), 4, 4);
  SurfaceId id;
  ASSERT_TRUE(w.attach(host, test::sheet_settings(), &id).ok());
  std::vector<std::uint64_t> numbers;
  for (int k = 0; k < 8; ++k) {
    if (k >= 2 && k < 4)
      for (Vec3& x : host.nodes) x.y() += 0.001;
    w.step(1e-3);
    numbers.push_back(w.surface(id)->still);
    EXPECT_EQ(w.surface(id)->x_t1, host.nodes) << "step " << k;
  }
  EXPECT_GT(numbers[0], 0u);
  EXPECT_EQ(numbers[1], numbers[0]);
  EXPECT_EQ(numbers[2], 0u);
  EXPECT_EQ(numbers[3], 0u);
  EXPECT_GT(numbers[4], numbers[0]) << "another place, another number";
  EXPECT_EQ(numbers[7], numbers[4]);
}

}  // namespace
}  // namespace oilskin
