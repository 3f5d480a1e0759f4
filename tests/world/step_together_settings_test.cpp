// Several worlds in one step: whose settings hold, what is refused, and hosts that throw.
#include <gtest/gtest.h>

#include <stdexcept>

#include "support/world_helpers.h"
#include "two_liquids.h"

namespace oilskin {
namespace {

using namespace test;

/// Each falls, and the balance of energies has the potential of each.
TEST(StepTogether, worlds_may_have_gravities_of_their_own) {
  Cloth<double> cloth(sheet_shape());
  for (std::size_t i = 0; i < cloth.x.size(); ++i) cloth.pin(i);
  World a(world_settings(Vec3(0, -9.81, 0)), water(), verified());
  World b(world_settings(Vec3(0, 4, 0)), oil(), verified());
  ASSERT_TRUE(a.attach(cloth, test::sheet_settings(), nullptr).ok());
  ASSERT_TRUE(b.attach(cloth, test::sheet_settings(), nullptr).ok());
  test::add_block(a, 4, Vec3(-0.02, 0.3, -0.02), Vec3::Zero());
  test::add_block(b, 4, Vec3(-0.02, -0.4, -0.02), Vec3::Zero());
  World* const worlds[] = {&a, &b};
  StepReport r;
  for (int k = 0; k < 100; ++k) {
    r = World::step_together(worlds, 1e-3);
    ASSERT_TRUE(r.status.ok());
    EXPECT_LE(r.momentum_residual().norm(), 1e-12);
  }
  EXPECT_LT(a.velocities()[0].y(), -0.9);
  EXPECT_GT(b.velocities()[0].y(), 0.35);
  EXPECT_LE(std::abs(r.energy.made), 1e-3 * r.energy.scale);
  EXPECT_NEAR(r.energy.water_kinetic, test::kinetic_energy(a) + test::kinetic_energy(b),
              0.02 * r.energy.water_kinetic);
}

TEST(StepTogether, settings_of_contact_are_those_of_the_first_for_all) {
  Cloth<double> cloth(sheet_shape());
  ContactSettings off;
  off.ccd = off.zones = false;
  World a(world_settings(), water(), verified()), b(world_settings(), oil(), off);
  ASSERT_TRUE(a.attach(cloth, test::sheet_settings(), nullptr).ok());
  ASSERT_TRUE(b.attach(cloth, test::sheet_settings(), nullptr).ok());
  test::add_block(b, 4, Vec3(-0.02, 0.01, -0.02), Vec3(0, -2, 0));
  World* const worlds[] = {&a, &b};
  std::uint64_t pairs = 0;
  for (int k = 0; k < 10; ++k) {
    const StepReport r = World::step_together(worlds, 4e-3);
    EXPECT_EQ(r.flags & flag_no_promise, 0u);
    EXPECT_EQ(r.contact.crossings_found_by_verify, 0u);
    pairs += r.contact.verified_pairs;
  }
  EXPECT_GT(pairs, 100u) << "the first one asks for the check";
}

/// A host that throws in its n-th call.
class ThrowingCloth : public Cloth<double> {
 public:
  using Cloth<double>::MockCloth;
  int gathers_left = 0, scatters_left = 0;  // 0 = does not throw

  Gathered gather(double dt, SurfaceMotion& motion) override {
    if (gathers_left > 0 && --gathers_left == 0) throw std::runtime_error("gather");
    return Cloth<double>::gather(dt, motion);
  }
  void scatter(SurfaceMotion& motion) override {
    if (scatters_left > 0 && --scatters_left == 0) throw std::runtime_error("scatter");
    Cloth<double>::scatter(motion);
  }
};

TEST(StepTogether, a_host_that_throws_leaves_all_worlds_as_they_were) {
  ThrowingCloth cloth(sheet_shape());
  World a(world_settings(), water(), verified()), b(world_settings(), oil(), verified());
  SurfaceSettings thick = test::sheet_settings();
  thick.thickness = 0.003;
  ASSERT_TRUE(a.attach(cloth, test::sheet_settings(), nullptr).ok());
  ASSERT_TRUE(b.attach(cloth, thick, nullptr).ok());
  test::add_block(a, 5, Vec3(-0.03, 0.01, -0.03), Vec3(0, -2, 0));
  test::add_block(b, 4, Vec3(-0.02, -0.06, -0.02), Vec3(0, 2, 0));
  World* const worlds[] = {&a, &b};
  for (int k = 0; k < 6; ++k) {
    std::vector<std::uint8_t> before[2], after[2];
    for (int w = 0; w < 2; ++w) ASSERT_TRUE(worlds[w]->save(&before[w]).ok());
    const Cloth<double> saved = cloth;
    (k % 2 == 0 ? cloth.gathers_left : cloth.scatters_left) = 1;
    EXPECT_THROW(World::step_together(worlds, 4e-3), std::runtime_error);
    for (int w = 0; w < 2; ++w) {
      ASSERT_TRUE(worlds[w]->save(&after[w]).ok());
      EXPECT_TRUE(before[w] == after[w]) << "world " << w << ", step " << k;
    }
    static_cast<Cloth<double>&>(cloth) = saved;
    ASSERT_TRUE(World::step_together(worlds, 4e-3).status.ok());
  }
  EXPECT_GT(a.contacts().size() + b.contacts().size(), 0u);
}

TEST(StepTogether, refuses_in_words) {
  World a(world_settings(), water()), b(world_settings(), oil());
  FluidSettings other = water();
  other.boundary = BoundaryModel::contact_only;
  World bare(world_settings(), other);
  FluidSettings wrong = water();
  wrong.spacing = -1;
  World broken(world_settings(), wrong);
  const auto refusal = [](std::vector<World*> worlds, double dt = 4e-3) {
    return World::step_together(worlds, dt).status.message;
  };
  EXPECT_EQ(refusal({}), "there is no world to step");
  EXPECT_EQ(refusal({&a, nullptr}), "world 2 of the step is null");
  EXPECT_EQ(refusal({&a, &b, &a}), "world 3 of the step is there twice");
  EXPECT_EQ(refusal({&a, &bare}), "world 2 of the step has another fluid.boundary than the first");
  EXPECT_EQ(refusal({&broken, &a}).rfind("world 1 of the step has settings that were refused: ", 0), 0u);
  EXPECT_EQ(refusal({&a, &b}, -1), "dt is -1; it must be 1e-12 … 1e6 s");
  EXPECT_EQ(a.step_count() + b.step_count(), 0u);
  EXPECT_EQ(refusal({&a, &b}), "");
  EXPECT_EQ(a.step_count() + b.step_count(), 2u);
}

}  // namespace
}  // namespace oilskin
