// Hard case 47: a world is saved while everything is under way and goes on in another.
#include <gtest/gtest.h>

#include "hard_cases/hard_case.h"
#include "support/busy_scene.h"

namespace oilskin::test {
namespace {

constexpr int saved_after = 40, steps_more = 50;

TEST(HardSave, a_restored_world_has_the_same_bits_fifty_steps_later) {
  FluidSettings fluid;
  fluid.solver = PressureSolver::dfsph;
  fluid.boundary = BoundaryModel::mirrored;
  fluid.max_substeps = 2;
  BusyScene<float> scene(busy_world(1), fluid);
  scene.add_emitters();
  ASSERT_TRUE(scene.ok);
  for (int k = 0; k < saved_after; ++k) ASSERT_TRUE(scene.step(k).status.ok());
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(scene.world.save(&bytes).ok());
  const auto hosts = scene.host_state();
  const std::size_t particles = scene.world.particle_count();

  BusyScene<float> one(busy_world(1), FluidSettings{}), two(busy_world(2), FluidSettings{});
  for (BusyScene<float>* other : {&one, &two}) {
    ASSERT_TRUE(other->world.restore(bytes).ok());
    other->set_host_state(hosts);
  }
  std::uint64_t equal = 0;
  for (int k = saved_after; k < saved_after + steps_more; ++k) {
    for (BusyScene<float>* each : {&scene, &one, &two}) ASSERT_TRUE(each->step(k).status.ok());
    const std::uint64_t hash = scene.world.state_hash();
    EXPECT_EQ(one.world.state_hash(), hash) << "step " << k;
    EXPECT_EQ(two.world.state_hash(), hash) << "step " << k;
    equal += one.world.state_hash() == hash && two.world.state_hash() == hash;
  }
  EXPECT_NE(scene.world.particle_count(), particles);  // emitters went on

  // The worst that can be done with it: a host that is another.
  BusyScene<double> wrong(busy_world(1), FluidSettings{});
  const std::uint64_t before = wrong.world.state_hash();
  const bool refused = !wrong.world.restore(bytes).ok();
  EXPECT_EQ(wrong.world.state_hash(), before);
  HardCase c("47", "saved mid-run (" + std::to_string(particles) +
                       " particles; jets, rain, blocked and later emitters, cloth, held pins), restored into "
                       "new worlds with one and two threads");
  c.equal("steps with the same bits", equal, steps_more);
  c.note("saved bytes", std::uint64_t{bytes.size()});
  c.holds("a wrong host is refused", refused);
}

}  // namespace
}  // namespace oilskin::test
