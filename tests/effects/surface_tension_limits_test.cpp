// Surface tension outside the range that it is made for: long steps, a short support, settings that make no
// sense.
#include <gtest/gtest.h>

#include <algorithm>

#include "effects/drop.h"
#include "effects/tension/tension_model.h"

namespace oilskin {
namespace {

using namespace test;

std::int64_t messages_with(const World& w, const std::string& text) {
  const std::vector<std::string>& all = w.report().messages;
  return std::count_if(all.begin(), all.end(),
                       [&](const std::string& m) { return m.find(text) != std::string::npos; });
}

TEST(SurfaceTension, long_steps_are_cut_for_capillary_waves) {
  Drop drop(3, 0.001);
  drop.start_as_sphere();
  World& w = *drop.world;
  const double longest = drop.tension.longest_interval(w.fluid_settings());
  EXPECT_NEAR(longest, effects::longest_interval * drop.unit(), 1e-12);
  EXPECT_EQ(w.step(3.5 * longest).substeps, 4);
  EXPECT_TRUE(w.report().messages.empty());
  EXPECT_LE(w.suggested_dt(1), 8 * longest);
  const StepReport& r = w.step(20 * longest);
  EXPECT_EQ(r.substeps, 8);
  EXPECT_EQ(r.substeps_needed, 20);
  EXPECT_EQ(messages_with(w, "surface_tension at dt"), 1);
  EXPECT_EQ(r.flags & (flag_sound_too_fast | flag_viscosity_limited), 0u);
}

TEST(SurfaceTension, steps_that_are_too_long_act_with_what_is_stable) {
  Drop drop(4, 0.001);
  drop.start_as_sphere();
  for (int k = 0; k < 60; ++k) ASSERT_TRUE(drop.world->step(1 / 60.).status.ok());
  EXPECT_EQ(drop.world->report().substeps, 8);
  EXPECT_LE(drop.rms_speed(), 0.2 * drop.speed_unit());
  EXPECT_EQ(messages_with(*drop.world, "surface_tension: acts with"), 1);
}

TEST(SurfaceTension, a_support_that_is_too_short_is_named) {
  for (double ratio : {1.6, 2.0, 2.2}) {
    FluidSettings settings;
    settings.support_ratio = ratio;
    World w({}, settings);
    SurfaceTension tension;
    ASSERT_TRUE(w.add_effect(tension).ok());
    ASSERT_TRUE(w.add_particles(std::vector<Vec3>{Vec3::Zero()}, std::vector<Vec3>{Vec3::Zero()}).ok());
    ASSERT_TRUE(w.step(1e-3).status.ok());
    EXPECT_EQ(messages_with(w, "fluid.support_ratio 1.6"), ratio < 2 ? 1 : 0) << ratio;
    EXPECT_EQ(messages_with(w, "boil"), ratio < 2 ? 1 : 0) << ratio;
  }
}

TEST(SurfaceTension, settings_are_saved) {
  SurfaceTension one({0.03, 20}), other;
  ASSERT_TRUE(other.restore(one.save()).ok());
  EXPECT_EQ(other.settings().coefficient, 0.03);
  EXPECT_EQ(other.settings().contact_angle, 20);
  std::vector<std::uint8_t> bytes = one.save();
  bytes.pop_back();
  EXPECT_FALSE(other.restore(bytes).ok());
  EXPECT_FALSE(other.restore({}).ok());
  EXPECT_FALSE(other.restore(std::vector<std::uint8_t>(16, 0xff)).ok()) << "not finite";
  EXPECT_EQ(other.settings().coefficient, 0.03);
}

}  // namespace
}  // namespace oilskin
