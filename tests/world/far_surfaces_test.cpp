// Surfaces far from the water: they change nothing, and are found as soon as water comes near.
#include <gtest/gtest.h>

#include <cmath>

#include "support/cloth_over_floor.h"

namespace oilskin::test {
namespace {

/// Boxes of 2 cm around the block of water and its way, none nearer to it than 0.5 m.
void add_far_boxes(StaticMesh& mesh, int k) {
  const double angle = 0.7 * k, height = -1 + 0.07 * k;
  const Vec3 at(std::cos(angle), height, std::sin(angle));
  mesh.add_box({at, at + Vec3::Constant(0.02)}, 0.01);
}

TEST(FarSurfaces, change_no_bit) {
  for (const int threads : {1, 2}) {
    ClothOverFloor<double> near[2];
    std::vector<StaticMesh> boxes(30);
    WorldSettings settings;
    settings.threads = threads;
    settings.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
    FluidSettings fluid;
    fluid.spacing = 0.01;
    World alone(settings, fluid), among(settings, fluid);
    near[0].pin_two_borders();
    near[1].pin_two_borders();
    near[0].attach_to(alone);
    near[1].attach_to(among);
    for (std::size_t k = 0; k < boxes.size(); ++k) {
      add_far_boxes(boxes[k], static_cast<int>(k));
      ASSERT_TRUE(among.attach(boxes[k], sheet_settings(0.002), nullptr).ok());
    }
    for (World* world : {&alone, &among}) add_block(*world, 10, Vec3(-0.05, 0.03, -0.05), Vec3(0, -1, 0));
    std::uint64_t candidates = 0;
    for (int step = 0; step < 12; ++step) {
      const StepReport a = alone.step(0.002), b = among.step(0.002);
      ASSERT_TRUE(a.status.ok() && b.status.ok());
      ASSERT_TRUE(std::equal(alone.positions().begin(), alone.positions().end(), among.positions().begin()))
          << "step " << step;
      EXPECT_EQ(a.contact.candidates, b.contact.candidates);
      candidates += a.contact.candidates;
    }
    EXPECT_GT(candidates, 1000);
  }
}

/// Water flies 10 cm a step from box to box; each is far from it in the steps before.
TEST(FarSurfaces, are_found_when_water_comes_near) {
  WorldSettings settings;
  settings.gravity = Vec3::Zero();
  settings.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
  FluidSettings fluid;
  fluid.spacing = 0.01;
  fluid.max_substeps = 1;
  ContactSettings contact;
  contact.verify = true;
  World world(settings, fluid, contact);
  std::vector<StaticMesh> boxes(8);
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    const Vec3 at(0.25 + 0.2 * double(k), 0.01 * double(k) - 0.04, 0);
    boxes[k].add_box({at, at + Vec3(0.02, 0.02, 0.1)}, 0.02);
    ASSERT_TRUE(world.attach(boxes[k], sheet_settings(0.002), nullptr).ok());
  }
  add_block(world, 10, Vec3(-0.1, -0.05, 0), Vec3(20, 0, 0));
  std::uint64_t first = 0, all = 0;
  for (int step = 0; step < 16; ++step) {
    const StepReport r = world.step(0.005);
    ASSERT_TRUE(r.status.ok());
    EXPECT_EQ(r.contact.crossings_found_by_verify, 0u);
    if (step == 0) first = r.contact.candidates;
    all += r.contact.candidates;
  }
  EXPECT_EQ(first, 0u) << "all boxes are far";
  EXPECT_GT(all, 1000u);
}

}  // namespace
}  // namespace oilskin::test
