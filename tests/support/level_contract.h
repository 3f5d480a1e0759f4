/// What every host that numbers what it fills in (SurfaceMotion::revision) must do, as tests: run on the mock
/// mesh and on Bullet's collision objects, in float and in double.
///
/// A fixture provides:
///   Level()                    a ground of some hundred triangles, 0.3 m wide around the origin, at y = 0,
///                              that stands still
///   SurfaceHost& host();
///   void move(const Vec3& by)  as a user would, between steps
#pragma once

#include <gtest/gtest.h>

#include "support/world_helpers.h"

namespace oilskin::test {

/// Passes a host on, and counts what it says. `rereads`: no number reaches the host or the world, so that
/// everything is filled in and read in every step.
class LevelHost : public SurfaceHost {
 public:
  int unchanged = 0;

  LevelHost(SurfaceHost& host, bool rereads) : host_(host), rereads_(rereads) {}
  Gathered gather(double dt, SurfaceMotion& m) override {
    if (rereads_) m.revision = 0;
    const Gathered gathered = host_.gather(dt, m);
    if (rereads_) m.revision = 0;
    unchanged += gathered.unchanged ? 1 : 0;
    return gathered;
  }
  void scatter(SurfaceMotion& m) override { host_.scatter(m); }

 private:
  SurfaceHost& host_;
  const bool rereads_;
};

/// Water that falls on a level.
template <class Level>
struct LevelScene {
  Level level;
  LevelHost host;
  World world;
  SurfaceId id;

  LevelScene(bool rereads, BoundaryModel boundary, int max_substeps, int threads)
      : host(level.host(), rereads), world(settings(threads), fluid(boundary, max_substeps)) {
    ContactSettings contact;
    contact.verify = true;
    EXPECT_TRUE(world.set_contact_settings(contact).ok());
    SurfaceSettings surface = sheet_settings(0.002);
    surface.slip.model = SlipModel::coulomb;
    surface.slip.friction = 0.3;
    surface.smooth = true;
    EXPECT_TRUE(world.attach(host, surface, &id).ok());
  }
  static WorldSettings settings(int threads) {
    WorldSettings s;
    s.threads = threads;
    s.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
    return s;
  }
  static FluidSettings fluid(BoundaryModel boundary, int max_substeps) {
    FluidSettings s;
    s.spacing = 0.01;
    s.boundary = boundary;
    s.max_substeps = max_substeps;
    s.occlusion = true;
    return s;
  }
  void add_water() {
    add_block(world, 4, Vec3(-0.013, 0.006, -0.01), Vec3(0.3, -1, 0.1));
    add_block(world, 3, Vec3(0.07, -0.04, 0.05), Vec3(0, 2, 0));  // from below
  }
  /// Step k: still up to 15, lifted from 15 to 20, still again, teleported at 30.
  const StepReport& step(int k) {
    if (k >= 15 && k < 20) level.move(Vec3(0, 0.001, 0));
    if (k == 30) {
      level.move(Vec3(0, -0.0301, 0));
      world.reset_motion(id);
    }
    return world.step(4e-3);
  }
  const SurfaceMotion& surface() { return *world.surface(id); }
};

template <class Level>
class LevelContract : public ::testing::Test {
 protected:
  static void expect_same(LevelScene<Level>& a, LevelScene<Level>& b) {
    const StepReport &r = a.world.report(), &s = b.world.report();
    EXPECT_EQ(a.world.state_hash(), b.world.state_hash());
    EXPECT_EQ(r.contact.impulse_on_prescribed, s.contact.impulse_on_prescribed);
    EXPECT_EQ(r.contact.contacts, s.contact.contacts);
    EXPECT_EQ(r.contact.candidates, s.contact.candidates);
    EXPECT_EQ(r.contact.relocated, s.contact.relocated);
    EXPECT_EQ(r.contact.min_distance, s.contact.min_distance);
    EXPECT_EQ(r.contact.crossings_found_by_verify, 0u);
    EXPECT_EQ(r.fluid.hidden_pairs, s.fluid.hidden_pairs);
    EXPECT_EQ(r.energy.made, s.energy.made);
    EXPECT_EQ(r.substeps, s.substeps);
    EXPECT_EQ(r.flags, s.flags);
    EXPECT_EQ(a.surface().impulse, b.surface().impulse);
    EXPECT_EQ(a.surface().id, b.surface().id);
  }
};
TYPED_TEST_SUITE_P(LevelContract);

/// With contact alone and with boundary terms, in steps and in sub-steps.
TYPED_TEST_P(LevelContract, what_stands_still_gives_the_bits_of_what_is_read_in_every_step) {
  for (const auto& [boundary, substeps] :
       {std::pair<BoundaryModel, int>{BoundaryModel::contact_only, 1}, {BoundaryModel::mirrored, 5}}) {
    LevelScene<TypeParam> numbered(false, boundary, substeps, 2), read(true, boundary, substeps, 1);
    numbered.add_water();
    read.add_water();
    std::uint64_t hidden = 0, contacts = 0;
    int most = 0;
    for (int k = 0; k < 40; ++k) {
      SCOPED_TRACE("step " + std::to_string(k));
      numbered.step(k);
      read.step(k);
      TestFixture::expect_same(numbered, read);
      if (::testing::Test::HasFailure()) return;
      hidden += numbered.world.report().fluid.hidden_pairs;
      contacts += numbered.world.report().contact.contacts;
      most = std::max(most, numbered.world.report().substeps);
    }
    EXPECT_GT(hidden, 0u);
    EXPECT_GT(contacts, 0u);
    EXPECT_EQ(most > 1, substeps > 1);
    // Five steps move it, in one it stops. The teleport, at which Bullet's host sees a motion that stops.
    EXPECT_GE(numbered.host.unchanged, 40 - 6 - 2);
    EXPECT_EQ(read.host.unchanged, 0);
  }
}

TYPED_TEST_P(LevelContract, touched_names_every_node_with_an_impulse) {
  LevelScene<TypeParam> scene(false, BoundaryModel::mirrored, 3, 1);
  scene.add_water();
  std::size_t most = 0;
  for (int k = 0; k < 35; ++k) {
    scene.step(k);
    const SurfaceMotion& m = scene.surface();
    EXPECT_TRUE(std::is_sorted(m.touched.begin(), m.touched.end()));
    EXPECT_EQ(std::adjacent_find(m.touched.begin(), m.touched.end()), m.touched.end());
    std::vector<std::uint8_t> is_touched(m.x_t1.size(), 0);
    for (std::uint32_t node : m.touched) is_touched[node] = 1;
    for (std::size_t i = 0; i < m.impulse.size(); ++i)
      ASSERT_TRUE(is_touched[i] || (m.impulse[i].isZero(0) && m.moved[i] == 0)) << "step " << k;
    EXPECT_LT(m.touched.size(), m.x_t1.size());
    most = std::max(most, m.touched.size());
  }
  EXPECT_GT(most, 3u);
}

TYPED_TEST_P(LevelContract, a_saved_world_goes_on_with_the_same_bits) {
  LevelScene<TypeParam> first(false, BoundaryModel::mirrored, 3, 1),
      second(false, BoundaryModel::mirrored, 3, 1);
  first.add_water();
  for (int k = 0; k < 12; ++k) first.step(k);
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(first.world.save(&bytes).ok());
  ASSERT_TRUE(second.world.restore(bytes).ok());
  EXPECT_EQ(second.surface().touched, first.surface().touched);
  for (int k = 12; k < 25; ++k) {
    first.step(k);
    second.step(k);
    ASSERT_EQ(first.world.state_hash(), second.world.state_hash()) << "step " << k;
  }
  EXPECT_LT(second.host.unchanged, first.host.unchanged) << "it is read once after restore()";
  EXPECT_GT(second.host.unchanged, 3);
}

REGISTER_TYPED_TEST_SUITE_P(LevelContract, what_stands_still_gives_the_bits_of_what_is_read_in_every_step,
                            touched_names_every_node_with_an_impulse,
                            a_saved_world_goes_on_with_the_same_bits);

}  // namespace oilskin::test
