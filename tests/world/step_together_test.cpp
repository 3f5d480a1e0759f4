// Several worlds whose fluids touch the same surfaces, stepped together.
#include <gtest/gtest.h>

#include "oilskin/wetting.h"
#include "support/mock_body.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"
#include "two_liquids.h"

namespace oilskin {
namespace {

using namespace test;

/// Water falls onto a free sheet, and oil hits it from below.
template <class Scalar>
struct BothSides {
  explicit BothSides(int threads = 1, int max_substeps = 1, std::optional<double> oil_thickness = {})
      : cloth(sheet_shape()),
        above(world_settings(Vec3::Zero(), threads), water(max_substeps), verified()),
        below(world_settings(Vec3::Zero(), threads), oil(max_substeps), verified()) {
    EXPECT_TRUE(above.attach(cloth, test::sheet_settings(), &id_above).ok());
    SurfaceSettings settings = test::sheet_settings();
    settings.thickness = oil_thickness ? oil_thickness : settings.thickness;
    EXPECT_TRUE(below.attach(cloth, settings, &id_below).ok());
    test::add_block(above, 6, Vec3(-0.03, 0.01, -0.03), Vec3(0.1, -1.5, 0));
    test::add_block(below, 5, Vec3(-0.02, -0.07, -0.02), Vec3(0, 2, 0.2));
  }

  StepReport step(double dt = 4e-3) {
    World* const worlds[] = {&above, &below};
    return World::step_together(worlds, dt);
  }
  Vec3 momentum() const {
    return test::fluid_momentum(above) + test::fluid_momentum(below) + cloth.momentum();
  }
  std::uint64_t hash() const { return above.state_hash() ^ (below.state_hash() << 1); }

  Cloth<Scalar> cloth;
  World above, below;
  SurfaceId id_above, id_below;
};

template <class Scalar>
void expect_kept_apart(int max_substeps) {
  BothSides<Scalar> s(1, max_substeps);
  const Vec3 start = s.momentum();
  const double size = start.norm(), rounding = sizeof(Scalar) == 4 ? 1e-5 : 1e-12;
  std::uint64_t hits_above = 0, hits_below = 0;
  for (int k = 0; k < 60; ++k) {
    const StepReport r = s.step(1e-3);
    ASSERT_TRUE(r.status.ok()) << r.status.message;
    ASSERT_EQ(r.step, static_cast<std::uint64_t>(k));
    ASSERT_EQ(r.dt, 1e-3);
    ASSERT_EQ(s.below.report().dt, 1e-3);
    ASSERT_EQ(r.contact.crossings_found_by_verify, 0u) << "step " << k;
    ASSERT_EQ(r.flags & (flag_leaked | flag_no_promise | flag_scatter_mismatch), 0u) << "step " << k;
    EXPECT_EQ(r.alive, 216u + 125u);
    EXPECT_LE(r.momentum_residual().norm(), 1e-12 * size) << "step " << k;
    EXPECT_LE((s.momentum() - start).norm(), rounding * size) << "step " << k;
    hits_above += s.above.contacts().size();
    hits_below += s.below.contacts().size();
    for (const Contact& c : s.above.contacts()) EXPECT_LT(c.particle, s.above.particle_count());
    for (const Contact& c : s.below.contacts()) EXPECT_LT(c.particle, s.below.particle_count());
    ASSERT_EQ(s.above.contact_surfaces().size(), 1u);
    EXPECT_EQ(s.above.surface(s.id_above)->x_t1, s.below.surface(s.id_below)->x_t1);
    EXPECT_EQ(s.above.surface(s.id_above)->impulse, s.below.surface(s.id_below)->impulse);
    EXPECT_LE(r.energy.made, 0.02 * r.energy.scale) << "step " << k;
  }
  EXPECT_GT(hits_above, 100u);
  EXPECT_GT(hits_below, 100u);
}

TEST(StepTogether, fluids_on_both_sides_of_a_sheet_stay_apart_and_keep_their_momentum) {
  for (int max_substeps : {1, 6}) {
    SCOPED_TRACE(max_substeps);
    expect_kept_apart<double>(max_substeps);
    expect_kept_apart<float>(max_substeps);
  }
}

TEST(StepTogether, does_not_depend_on_the_number_of_threads) {
  BothSides<float> one(1, 4), two(2, 4);
  for (int k = 0; k < 15; ++k) {
    one.step();
    two.step();
    ASSERT_EQ(one.hash(), two.hash()) << "step " << k;
  }
  EXPECT_GT(one.above.contacts().size() + one.below.contacts().size(), 0u);
}

TEST(StepTogether, a_shared_surface_has_the_smallest_thickness) {
  BothSides<float> s(1, 1, 0.004);
  for (int k = 0; k < 20; ++k) {
    const StepReport r = s.step();
    ASSERT_EQ(r.contact.crossings_found_by_verify, 0u);
    ASSERT_EQ(r.flags & flag_no_promise, 0u);
  }
  EXPECT_EQ(s.above.surface(s.id_above)->thickness, 0.001);
  EXPECT_EQ(s.below.surface(s.id_below)->thickness, 0.001);
  EXPECT_EQ(s.above.surface(s.id_above)->delta, s.below.surface(s.id_below)->delta);
}

/// One world, alone and with another one that shares nothing with it.
TEST(StepTogether, worlds_without_a_common_surface_do_not_disturb_each_other) {
  for (int max_substeps : {1, 4}) {
    BothSides<double> with(1, max_substeps), alone(1, max_substeps);
    World other(world_settings(), water(max_substeps), verified());
    test::StaticMesh floor;
    floor.add_rectangle(Vec3(-0.5, -0.5, -0.5), Vec3(0, 0, 1), Vec3(1, 0, 0), 8, 8);
    SurfaceId id;
    ASSERT_TRUE(other.attach(floor, test::sheet_settings(), &id).ok());
    test::add_block(other, 3, Vec3(0, -0.49, 0), Vec3(0, -1, 0));
    double load = 0;
    World* const both[] = {&with.above, &other};
    World* const one[] = {&alone.above};
    for (int k = 0; k < 15; ++k) {
      const StepReport joint = World::step_together(both, 4e-3), single = World::step_together(one, 4e-3);
      ASSERT_EQ(joint.substeps, single.substeps);
      ASSERT_EQ(with.above.state_hash(), alone.above.state_hash()) << "step " << k;
      EXPECT_EQ(joint.alive, single.alive + 27);
      load += load_of(*other.surface(id)).impulse.norm();
    }
    EXPECT_GT(load, 0);
  }
}

/// Two waters side by side press on one pinned sheet as much as one that has both.
TEST(StepTogether, loads_on_a_surface_add_up) {
  const auto hold = [](Cloth<double>& cloth) {
    for (std::size_t i = 0; i < cloth.x.size(); ++i) cloth.pin(i);
  };
  const Vec3 left(-0.08, 0.01, -0.02), right(0.03, 0.01, -0.02), down(0, -1, 0);
  Cloth<double> shared(sheet_shape()), own(sheet_shape());
  hold(shared), hold(own);
  World a(world_settings(), water(), verified()), b(world_settings(), water(), verified());
  World both(world_settings(), water(), verified());
  SurfaceId id_a, id_b, id;
  ASSERT_TRUE(a.attach(shared, test::sheet_settings(), &id_a).ok());
  ASSERT_TRUE(b.attach(shared, test::sheet_settings(), &id_b).ok());
  ASSERT_TRUE(both.attach(own, test::sheet_settings(), &id).ok());
  test::add_block(a, 5, left, down);
  test::add_block(b, 5, right, down);
  test::add_block(both, 5, left, down);
  test::add_block(both, 5, right, down);
  World* const worlds[] = {&a, &b};
  Vec3 of_two = Vec3::Zero(), of_one = Vec3::Zero();
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(World::step_together(worlds, 1e-3).status.ok());
    ASSERT_TRUE(both.step(1e-3).status.ok());
    of_two += load_of(*a.surface(id_a)).impulse;
    of_one += load_of(*both.surface(id)).impulse;
  }
  EXPECT_LT(of_one.y(), -0.09);
  EXPECT_LE((of_two - of_one).norm(), 1e-5 * of_one.norm())
      << of_two.transpose() << "; " << of_one.transpose();
}

TEST(StepTogether, a_fluid_passes_a_surface_that_it_does_not_collide_with) {
  Cloth<float> cloth(sheet_shape());
  FluidSettings ghost = oil();
  ghost.collision_mask = 0;
  World passes(world_settings(), ghost, verified()), stays(world_settings(), water(), verified());
  // The first world reads the cloth, and does not touch it.
  ASSERT_TRUE(passes.attach(cloth, test::sheet_settings(), nullptr).ok());
  ASSERT_TRUE(stays.attach(cloth, test::sheet_settings(), nullptr).ok());
  test::add_block(passes, 4, Vec3(-0.02, 0.02, -0.02), Vec3(0, -2, 0));
  test::add_block(stays, 4, Vec3(-0.02, -0.06, -0.02), Vec3(0, 2, 0));
  World* const worlds[] = {&passes, &stays};
  for (int k = 0; k < 20; ++k) {
    const StepReport r = World::step_together(worlds, 4e-3);
    ASSERT_TRUE(r.status.ok());
    ASSERT_EQ(r.contact.crossings_found_by_verify, 0u);
    EXPECT_TRUE(passes.contacts().empty());
  }
  for (const Vec3& x : passes.positions()) EXPECT_LT(x.y(), -0.05);
  EXPECT_GT(cloth.momentum().y(), 0.01) << "the water below lifts the cloth";
}

TEST(StepTogether, a_body_is_pushed_by_both) {
  for (BoundaryModel boundary : {BoundaryModel::mirrored, BoundaryModel::contact_only}) {
    test::MockBody body;
    body.mass = 0.2;
    FluidSettings first = water(), second = oil();
    first.boundary = second.boundary = boundary;
    World a(world_settings(), first, verified()), b(world_settings(), second, verified());
    ASSERT_TRUE(a.attach(body, test::sheet_settings(), nullptr).ok());
    ASSERT_TRUE(b.attach(body, test::sheet_settings(), nullptr).ok());
    test::add_block(a, 5, Vec3(-0.02, 0.06, -0.02), Vec3(0, -1, 0));
    test::add_block(b, 4, Vec3(0.07, -0.02, -0.02), Vec3(-1, 0, 0));
    const auto momentum = [&] {
      return Vec3(test::fluid_momentum(a) + test::fluid_momentum(b) + body.momentum());
    };
    const Vec3 start = momentum();
    World* const worlds[] = {&a, &b};
    for (int k = 0; k < 30; ++k) {
      const StepReport r = World::step_together(worlds, 4e-3);
      ASSERT_TRUE(r.status.ok());
      ASSERT_EQ(r.contact.crossings_found_by_verify, 0u);
      EXPECT_LE(r.momentum_residual().norm(), 1e-12 * start.norm());
      EXPECT_LE((momentum() - start).norm(), 1e-12 * start.norm());
    }
    EXPECT_LT(body.velocity.x(), -0.1);
    EXPECT_LT(body.velocity.y(), -0.1);
  }
}

TEST(StepTogether, liquids_of_both_weigh_on_cloth_that_absorbs_them) {
  Cloth<double> cloth(sheet_shape());
  Wetting of_water, of_oil;
  World a(world_settings(), water(), verified()), b(world_settings(), oil(), verified());
  SurfaceId id_a, id_b;
  ASSERT_TRUE(a.attach(cloth, test::sheet_settings(), &id_a).ok());
  ASSERT_TRUE(b.attach(cloth, test::sheet_settings(), &id_b).ok());
  ASSERT_TRUE(a.add_effect(of_water).ok());
  ASSERT_TRUE(b.add_effect(of_oil).ok());
  test::add_block(a, 5, Vec3(-0.08, 0.01, -0.02), Vec3(0, -0.5, 0));
  test::add_block(b, 4, Vec3(0.03, 0.01, -0.02), Vec3(0, -0.5, 0));
  const auto mass_of_cloth = [&] {
    double sum = 0;
    for (double u : cloth.inverse_mass) sum += 1 / u;
    return sum;
  };
  const double dry = mass_of_cloth(), liquid = a.fluid_mass() + b.fluid_mass();
  const Vec3 start = test::fluid_momentum(a) + test::fluid_momentum(b);
  World* const worlds[] = {&a, &b};
  for (int k = 0; k < 60; ++k) {
    const StepReport r = World::step_together(worlds, 4e-3);
    ASSERT_TRUE(r.status.ok());
    ASSERT_EQ(r.contact.crossings_found_by_verify, 0u);
    EXPECT_LE(r.momentum_residual().norm(), 1e-12 * start.norm());
  }
  EXPECT_GT(a.absorbed_mass(), 0.002 * liquid);
  EXPECT_GT(b.absorbed_mass(), 0.002 * liquid);
  EXPECT_NEAR(a.fluid_mass() + b.fluid_mass() + a.absorbed_mass() + b.absorbed_mass(), liquid, 1e-12);
  EXPECT_NEAR(mass_of_cloth(), dry + a.absorbed_mass() + b.absorbed_mass(), 1e-9);
}

TEST(StepTogether, goes_on_bit_for_bit_from_saved_states) {
  BothSides<double> plain, restored;
  for (int k = 0; k < 12; ++k) plain.step();
  std::vector<std::uint8_t> above, below;
  ASSERT_TRUE(plain.above.save(&above).ok());
  ASSERT_TRUE(plain.below.save(&below).ok());
  restored.cloth = plain.cloth;
  ASSERT_TRUE(restored.above.restore(above).ok());
  ASSERT_TRUE(restored.below.restore(below).ok());
  for (int k = 0; k < 12; ++k) {
    plain.step();
    restored.step();
    ASSERT_EQ(plain.hash(), restored.hash()) << "step " << k;
  }
}

/// A world that was stepped alone meanwhile, or joins later, finds the surface elsewhere: no motion.
TEST(StepTogether, worlds_may_also_step_alone) {
  BothSides<float> s;
  for (int k = 0; k < 36; ++k) {
    const int turn = k % 4;
    const StepReport r = turn == 1 ? s.above.step(4e-3) : turn == 3 ? s.below.step(4e-3) : s.step();
    ASSERT_TRUE(r.status.ok()) << r.status.message;
    ASSERT_EQ(r.contact.crossings_found_by_verify, 0u) << "step " << k;
    ASSERT_EQ(r.flags & flag_no_promise, 0u) << "step " << k;
  }
  EXPECT_GT(s.above.particle_count() + s.below.particle_count(), 300u);
}

TEST(StepTogether, walls_at_rest_are_shared) {
  for (auto changes : {test::StaticMesh::Changes::never, test::StaticMesh::Changes::unknown}) {
    test::StaticMesh floor;
    floor.changes = changes;
    floor.add_rectangle(Vec3(-0.5, 0, -0.5), Vec3(0, 0, 1), Vec3(1, 0, 0), 10, 10);
    const Vec3 gravity(0, -9.81, 0);
    World a(world_settings(gravity), water(4), verified()), b(world_settings(gravity), oil(4), verified());
    SurfaceId id_a, id_b;
    ASSERT_TRUE(a.attach(floor, test::sheet_settings(), &id_a).ok());
    ASSERT_TRUE(b.attach(floor, test::sheet_settings(), &id_b).ok());
    test::add_block(a, 5, Vec3(-0.2, 0.01, 0), Vec3(0, -1, 0));
    test::add_block(b, 5, Vec3(0.2, 0.01, 0), Vec3(0, -1, 0));
    World* const worlds[] = {&a, &b};
    for (int k = 0; k < 25; ++k) {
      const StepReport r = World::step_together(worlds, 8e-3);
      ASSERT_EQ(r.contact.crossings_found_by_verify, 0u);
      EXPECT_LE(r.momentum_residual().norm(), 1e-12);
    }
    EXPECT_EQ(a.surface(id_a)->still != 0, changes == test::StaticMesh::Changes::never);
    EXPECT_EQ(b.surface(id_b)->still != 0, changes == test::StaticMesh::Changes::never);
    for (const World* w : {&a, &b})
      for (const Vec3& x : w->positions())
        EXPECT_TRUE(x.y() > 0 || x.cwiseAbs().maxCoeff() > 0.5) << x.transpose();
  }
}

}  // namespace
}  // namespace oilskin
