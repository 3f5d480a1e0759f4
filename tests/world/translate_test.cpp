// World::translate(): the world is elsewhere, and nothing has moved.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "oilskin/sink.h"
#include "oilskin/world.h"
#include "support/mock_cloth.h"

namespace oilskin {
namespace {

using test::MockCloth;

/// Water that falls on a pinned sheet, a nozzle above it, and a sink below.
template <class Scalar>
struct Scene {
  MockCloth<Scalar> cloth;
  World world;
  SurfaceId id;
  EmitterId nozzle;

  static WorldSettings settings() {
    WorldSettings s;
    s.threads = 1;
    s.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
    return s;
  }
  static FluidSettings fluid() {
    FluidSettings f;
    f.spacing = 0.02;
    return f;
  }
  static ContactSettings verified() {
    ContactSettings c;
    c.verify = true;
    return c;
  }
  static test::GridShape grid() {
    test::GridShape g;
    g.origin = Vec3(-0.15, 0, -0.15);
    g.u = Vec3(0.3, 0, 0);
    g.v = Vec3(0, 0, 0.3);
    return g;
  }

  Scene() : cloth(grid()), world(settings(), fluid(), verified()) {
    for (const std::size_t corner : {0, 8, 72, 80}) cloth.pin(corner);
    cloth.gravity = world.settings().gravity;
    SurfaceSettings sheet;
    sheet.thickness = 0.004;
    EXPECT_TRUE(world.attach(cloth, sheet, &id).ok());
    BoxEmitter block;
    block.box = {Vec3(-0.08, 0.02, -0.08), Vec3(0.08, 0.1, 0.08)};
    EXPECT_TRUE(world.add_emitter(block).ok());
    DiscEmitter disc;
    disc.center = Vec3(0, 0.25, 0);
    disc.radius = 0.03;
    EXPECT_TRUE(world.add_emitter(disc, &nozzle).ok());
    SinkId sink;
    EXPECT_TRUE(world.add_sink(box_region({Vec3(-1, -0.5, -1), Vec3(1, -0.2, 1)}), &sink).ok());
  }
  void move_host(const Vec3& offset) {
    for (auto& x : cloth.x) x += offset.cast<Scalar>();
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) {
      const StepReport r = world.step(1e-3);
      ASSERT_TRUE(r.status.ok()) << r.status.message;
      ASSERT_EQ(r.contact.crossings_found_by_verify, 0u);
      ASSERT_EQ(r.contact.relocated, 0u);
      ASSERT_EQ(r.flags & (flag_leaked | flag_no_promise | flag_surface_refused | flag_surface_out_of_range |
                           flag_scatter_mismatch),
                0u);
    }
  }
  std::map<std::uint64_t, Vec3> places() const {
    std::map<std::uint64_t, Vec3> all;
    for (std::size_t i = 0; i < world.particle_count(); ++i) all[world.ids()[i]] = world.positions()[i];
    return all;
  }
};

template <class Scalar>
class Translate : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Translate, Scalars);

TYPED_TEST(Translate, goes_on_as_it_would_have_here) {
  Scene<TypeParam> here, there;
  here.run(80);
  there.run(80);
  const Vec3 offset(32, 64, -128);
  there.move_host(offset);
  const Status status = there.world.translate(offset);
  ASSERT_TRUE(status.ok()) << status.message;
  EXPECT_EQ(there.world.settings().kill_box.max, Vec3(34, 66, -126));
  const Vec3 moved =
      there.world.emitter(there.nozzle)->pose.position - here.world.emitter(here.nozzle)->pose.position;
  EXPECT_EQ(moved, offset);
  here.run(20);
  there.run(20);
  const auto a = here.places(), b = there.places();
  ASSERT_EQ(a.size(), b.size());
  double most = 0;
  for (const auto& [id, x] : a) {
    ASSERT_TRUE(b.count(id)) << id;
    most = std::max(most, (b.at(id) - x - offset).norm());
  }
  EXPECT_LT(most, 0.25 * Scene<TypeParam>::fluid().spacing);
  EXPECT_GT(a.size(), 250u);
  const EnergyReport &e = here.world.report().energy, &f = there.world.report().energy;
  EXPECT_NEAR(f.made, e.made, 0.02 * e.scale);
  EXPECT_NEAR(f.water_kinetic, e.water_kinetic, 0.05 * e.water_kinetic);
  EXPECT_NEAR(f.work_outside, e.work_outside, 1e-9);
  EXPECT_NEAR(f.entered_potential - e.entered_potential,
              f.water_potential + f.node_potential - e.water_potential - e.node_potential, 0.02 * e.scale);
}

/// About the origin, which is elsewhere.
TYPED_TEST(Translate, moves_the_moment_of_the_load) {
  Scene<TypeParam> scene;
  const auto load = [&] { return load_of(*scene.world.surface(scene.id)); };
  for (int k = 0; k < 300 && load().impulse.isZero(0); ++k) scene.run(1);
  const SurfaceLoad before = load();
  ASSERT_GT(before.impulse.norm(), 0);
  const Vec3 offset(32, 64, -128);
  scene.move_host(offset);
  ASSERT_TRUE(scene.world.translate(offset).ok());
  EXPECT_EQ(load().impulse, before.impulse);
  EXPECT_TRUE(load().angular_impulse.isApprox(before.angular_impulse + offset.cross(before.impulse), 1e-12));
}

/// A sink that has moved takes what falls into it there, and nothing at its old place.
TYPED_TEST(Translate, sinks_and_the_kill_box_move_too) {
  Scene<TypeParam> scene;
  scene.world.detach(scene.id);
  scene.run(5);
  ASSERT_TRUE(scene.world.translate(Vec3(0, -16, 0)).ok());
  std::uint64_t taken = 0;
  for (int i = 0; i < 300; ++i) taken += scene.world.step(1e-3).removed_by_sinks;
  EXPECT_GT(taken, 200u);
}

TYPED_TEST(Translate, refuses_in_words_and_changes_nothing) {
  Scene<TypeParam> scene;
  scene.run(40);
  const std::uint64_t before = scene.world.state_hash();
  const auto refusal = [&](const Vec3& offset) {
    const Status status = scene.world.translate(offset);
    EXPECT_FALSE(status.ok());
    EXPECT_EQ(scene.world.state_hash(), before);
    EXPECT_EQ(scene.world.settings().kill_box.max, Vec3::Constant(2));
    return status.message;
  };
  EXPECT_NE(refusal(Vec3(1, 0, 0)).find("surface 1 was not moved: move what the hosts read first"),
            std::string::npos);
  EXPECT_NE(refusal(Vec3(std::nan(""), 0, 0)).find("must be finite"), std::string::npos);
  EXPECT_NE(refusal(Vec3(0, std::numeric_limits<double>::infinity(), 0)).find("must be finite"),
            std::string::npos);
  EXPECT_NE(refusal(Vec3(0, 0, 1e15)).find("beyond the range of numbers"), std::string::npos);
  const double far = sizeof(TypeParam) == 4 ? 1 << 12 : std::ldexp(1.0, 40);
  EXPECT_NE(refusal(Vec3(far, 0, 0)).find("below 4 δ"), std::string::npos);
  EXPECT_TRUE(scene.world.translate(Vec3::Zero()).ok());
  EXPECT_EQ(scene.world.state_hash(), before);
}

/// δ grows with the largest coordinate, and a particle at rest on the sheet is not thrown up.
TEST(FarAway, delta_is_larger) {
  Scene<float> scene;
  scene.run(80);
  const double before = scene.world.surface(scene.id)->delta;
  for (const double x : {100.0, -100.0}) {
    scene.move_host(Vec3(x, 0, 0));
    ASSERT_TRUE(scene.world.translate(Vec3(x, 0, 0)).ok());
    EXPECT_EQ(scene.world.surface(scene.id)->delta, minimum_separation(0.004, 102, Storage::float32));
    scene.run(5);
  }
  EXPECT_LT(before, minimum_separation(0.004, 102, Storage::float32));
}

}  // namespace
}  // namespace oilskin
