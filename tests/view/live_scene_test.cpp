// A scene whose settings change while it runs.
#include "view/live_scene.h"

#include <gtest/gtest.h>

#include "view/small_scene.h"

namespace oilskin::demo {
namespace {

using test::small_scene;
using test::take_steps;

std::uint64_t hash_of(const LiveScene& live) {
  return live.world().state_hash();
}

TEST(LiveScene, steps_are_those_of_a_run) {
  const Scene scene = small_scene();
  LiveScene live = test::live_scene(scene);
  const auto plain = make_simulation(scene, test::one_thread());
  for (int k = 0; k < 5; ++k) {
    live.step();
    plain->step(scene.dt);
  }
  EXPECT_EQ(hash_of(live), plain->world().state_hash());
  EXPECT_EQ(live.counts().steps, 5u);
  EXPECT_GT(live.counts().emitted, 50u);
}

TEST(LiveScene, a_restart_begins_again) {
  LiveScene live = test::live_scene(small_scene());
  take_steps(live, 3);
  const std::uint64_t after_three = hash_of(live);
  live.restart();
  EXPECT_EQ(live.time(), 0);
  EXPECT_EQ(live.counts().steps, 0u);
  take_steps(live, 3);
  EXPECT_EQ(hash_of(live), after_three);
}

TEST(LiveScene, every_choice_of_every_switch_is_accepted_and_read_back) {
  LiveScene live = test::live_scene(small_scene());
  for (const Switch& row : switches()) {
    for (int choice = 0; choice < static_cast<int>(row.choices.size()); ++choice) {
      const Status status = live.change(assignment_of(row, choice, live.original()));
      EXPECT_TRUE(status.ok()) << row.key << ": " << status.message;
      EXPECT_EQ(choice_in(row, live.settings()), choice) << row.key;
    }
    const std::string back = std::string(row.key) + "=" + value_at(live.original(), row.key).dump();
    EXPECT_TRUE(live.change(back).ok()) << back;
  }
  EXPECT_EQ(live.settings().dump(), live.original().dump());
}

TEST(LiveScene, stages_of_contact_and_effects_change_without_a_restart) {
  LiveScene live = test::live_scene(small_scene());
  take_steps(live, 2);
  const double before = live.time();
  for (const Switch& row : switches()) {
    if (row.group == SwitchGroup::fluid) continue;
    Change made = Change::restart;
    ASSERT_TRUE(live.change(assignment_of(row, 1, live.original()), &made).ok()) << row.key;
    EXPECT_EQ(made, Change::live) << row.key;
  }
  EXPECT_EQ(live.time(), before);
  const ContactSettings& contact = live.world().contact_settings();
  EXPECT_EQ(contact.repulsion, Repulsion::bridson);
  EXPECT_EQ(contact.infeasible, Infeasible::remove);
  ASSERT_TRUE(live.change("contact.ccd=false").ok());
  EXPECT_FALSE(live.world().contact_settings().ccd);
  live.step();
  EXPECT_GT(live.simulation().world().report().seconds.effects, 0);
  EXPECT_NE(live.counts().flags & flag_no_promise, 0u) << "without the continuous test nothing is promised";
}

TEST(LiveScene, settings_of_the_fluid_begin_the_scene_again) {
  LiveScene live = test::live_scene(small_scene());
  take_steps(live, 2);
  Change made = Change::live;
  ASSERT_TRUE(live.change("fluid.boundary=contact_only", &made).ok());
  EXPECT_EQ(made, Change::restart);
  EXPECT_EQ(live.time(), 0);
  EXPECT_EQ(live.world().fluid_settings().boundary, BoundaryModel::contact_only);
}

TEST(LiveScene, a_refused_change_changes_nothing) {
  LiveScene live = test::live_scene(small_scene());
  take_steps(live, 2);
  const std::uint64_t hash = hash_of(live);
  const Json settings = live.settings();
  for (const char* wrong :
       {"contact.solver_iterations=0", "contact.repulsion=glue", "fluid.spacing=-1", "colour=red",
        "effects.viscosity={\"coefficient\": -1}", "cloth.0.thickness=1e-16", "gravity=[0,1]", "contact",
        "=3", "fluid.spacing=1e-5"}) {
    const Status status = live.change(wrong);
    EXPECT_FALSE(status.ok()) << wrong;
    EXPECT_EQ(hash_of(live), hash) << wrong;
    EXPECT_TRUE(live.settings() == settings) << wrong;
    EXPECT_EQ(live.time(), 0.004) << wrong;
  }
}

TEST(LiveScene, looks_that_change_nothing_leave_the_state_alone) {
  LiveScene changed = test::live_scene(small_scene()), plain = test::live_scene(small_scene());
  take_steps(plain, 6);
  for (const char* assignment :
       {"contact.verify=false", "contact.verify=true", "effects.surface_tension=null", "pictures.max_speed=2",
        "max_particles=100000", "gravity=[0,-9.81,0]"}) {
    ASSERT_TRUE(changed.change(assignment).ok()) << assignment;
    changed.step();
  }
  EXPECT_EQ(hash_of(changed), hash_of(plain));
}

TEST(LiveScene, gravity_and_its_limit_of_particles_act_at_once) {
  for (const char* host : {"mock", "bullet"}) {
    LiveScene live = test::live_scene(small_scene(host));
    take_steps(live, 2);
    ASSERT_TRUE(live.change("gravity=[0,0,0]").ok());
    ASSERT_TRUE(live.change("max_particles=7").ok());
    EXPECT_EQ(live.world().settings().gravity, Vec3(0, 0, 0)) << host;
    EXPECT_EQ(live.world().settings().max_particles, 7u);
    live.step();
    EXPECT_EQ(live.world().settings().gravity, Vec3(0, 0, 0)) << host;
    EXPECT_EQ(live.time(), 0.006);
  }
}

TEST(LiveScene, an_effect_that_is_switched_leaves_the_others_their_numbers) {
  const char* wetting = "effects.wetting={\"textile\": \"cotton\"}";
  LiveScene live = test::live_scene(small_scene("mock", {wetting}));
  take_steps(live, 60);
  const double absorbed = live.world().absorbed_mass();
  ASSERT_GT(absorbed, 0);
  ASSERT_TRUE(live.change("effects.viscosity={\"coefficient\": 0.01}").ok());
  EXPECT_EQ(live.world().absorbed_mass(), absorbed);
  ASSERT_TRUE(live.change("effects.wetting=null").ok());
  live.step();
  EXPECT_NEAR(live.world().absorbed_mass(), absorbed, 1e-12 * absorbed) << "liquid stays in the cloth";
  EXPECT_EQ(assignment_of(switches()[0], 1, live.original()),
            "effects.wetting=" + value_at(live.original(), "effects.wetting").dump())
      << "back on with the settings of the scene";
}

}  // namespace
}  // namespace oilskin::demo
