// The effect "wetting" on a mock cloth: ledgers, momentum, drops, what is saved.
#include "oilskin/wetting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "effects/wetting_scene.h"
#include "support/static_mesh.h"

namespace oilskin::test {
namespace {

TEST(Wetting, a_dry_sheet_takes_up_the_water_that_it_touches_and_its_momentum) {
  WetScene s(thirsty());
  s.add_block(4, Vec3(-0.0075, 0.004, -0.0075), Vec3(0.1, -0.5, 0.05));
  const double water = s.world.fluid_mass();
  const Vec3 before = s.momentum();
  for (int k = 0; k < 600; ++k) {
    s.step(1e-3);
    ASSERT_LE(std::abs(s.missing()), 1e-12 * water) << "step " << k;
    ASSERT_LE((s.momentum() - before).norm(), 1e-12 * before.norm()) << "step " << k;
  }
  EXPECT_GE(s.absorbed, 60u) << "one or the other may leap off";
  EXPECT_EQ(s.absorbed + s.world.particle_count(), 64u);
  const double taken = water - s.world.fluid_mass();
  EXPECT_NEAR(s.world.absorbed_mass(), taken, 1e-12 * water);
  double mass = 0;
  for (double u : s.cloth.inverse_mass) mass += 1 / u;
  EXPECT_NEAR(mass, 0.2 * 0.2 * 0.2 + taken, 1e-12) << "the sheet weighs what it was given and its own";
}

TEST(Wetting, no_node_takes_up_more_than_its_limit_and_no_particle_has_less_than_a_twentieth) {
  WettingSettings settings;
  settings.fabric.capacity = 0.05;
  settings.fabric.diffusivity = 1e-9;
  settings.absorption = 100;
  settings.dripping = 0;
  WetScene s(settings, Vec3(0, -9.81, 0));
  s.pin_border();
  s.add_block(8, Vec3(-0.0175, 0.004, -0.0175), Vec3::Zero());
  for (int k = 0; k < 400; ++k) {
    s.step(1e-3);
    ASSERT_LE(std::abs(s.missing()), 1e-12 * s.emitted);
    for (float ratio : s.world.mass_ratios()) ASSERT_GE(ratio, 0.0499f);
  }
  const Span<const double> absorbed = s.world.absorbed(s.id), capacity = s.wetting.capacity(s.id);
  ASSERT_EQ(absorbed.size(), capacity.size());
  double largest = 0;
  for (std::size_t i = 0; i < absorbed.size(); ++i) largest = std::max(largest, absorbed[i] / capacity[i]);
  EXPECT_GT(largest, 1.4) << "the sheet was soaked";
  // A remainder that is taken up as a whole may exceed it.
  EXPECT_LE(largest,
            1.5 + 0.05 * s.world.particle_mass() / *std::max_element(capacity.begin(), capacity.end()) * 8);
  EXPECT_GT(s.world.particle_count(), 0u);
}

/// As in Huber, Eberhardt, Weiskopf 2013, Fig. 9: the wet cloth sags lower.
TEST(Wetting, wet_cloth_sags_below_dry) {
  double low[2] = {};
  for (const bool wet : {false, true}) {
    WetScene s(thirsty(), Vec3(0, -9.81, 0));
    s.cloth.damping = 0.02;
    for (std::size_t corner : {0u, 16u, 272u, 288u}) s.cloth.pin(corner);
    if (wet) s.add_block(6, Vec3(-0.0125, 0.004, -0.0125), Vec3::Zero());
    for (int k = 0; k < 1500; ++k) s.step(1e-3);
    EXPECT_LE(s.world.particle_count(), 5u) << "almost nothing but the liquid weighs on it";
    low[wet] = s.cloth.x[8 + 17 * 8].y();
  }
  EXPECT_LT(low[1], 1.05 * low[0]);
  EXPECT_LT(low[0], -0.001);
}

/// A sheet that is fed at one rate drips at that rate (B.11 h of validation: 1 %).
TEST(Wetting, a_soaked_sheet_drips_as_much_as_it_is_fed) {
  WettingSettings settings;
  settings.fabric.capacity = 0.2;
  settings.fabric.diffusivity = 1e-6;
  settings.absorption = 20;
  settings.dripping = 500;
  WetScene s(settings, Vec3(0, -9.81, 0));
  s.pin_border();
  RainEmitter rain;
  rain.corner = Vec3(-0.05, 0.03, -0.05);
  rain.edge_u = Vec3(0.1, 0, 0);
  rain.edge_v = Vec3(0, 0, 0.1);
  rain.drops_per_second = 60;
  rain.velocity = Vec3(0, -0.2, 0);
  ASSERT_TRUE(s.world.add_emitter(rain).ok());
  for (int k = 0; k < 1000; ++k) s.step(2e-3);
  const double before = s.world.absorbed_mass(), emitted = s.emitted;
  const std::uint64_t released = s.released;
  for (int k = 0; k < 1000; ++k) s.step(2e-3);
  const double fed = s.emitted - emitted,
               dripped = static_cast<double>(s.released - released) * s.world.particle_mass();
  EXPECT_GT(s.released - released, 100u);
  EXPECT_NEAR(dripped / fed, 1, 0.02) << "absorbed " << before << " then " << s.world.absorbed_mass();
  EXPECT_LE(std::abs(s.missing()), 1e-12 * s.emitted);
}

/// A strip that hangs into water: the liquid in it rises until its suction carries its weight.
TEST(Wetting, a_sheet_hung_in_a_reservoir_is_saturated_as_its_height_allows) {
  constexpr double rise = 0.08, depth = 0.03;
  WettingSettings settings;
  settings.fabric.diffusivity = 0.02;
  settings.fabric.mobility_exponent = 1;
  settings.fabric.capillary_rise = rise;
  settings.fabric.saturation_limit = 1;
  settings.absorption = 20;
  GridShape strip;
  strip.nu = 6;
  strip.nv = 31;
  strip.origin = Vec3(-0.025, 0.004, 0);
  strip.u = Vec3(0.05, 0, 0);
  strip.v = Vec3(0, 0.15, 0);
  WetScene s(settings, Vec3(0, -9.81, 0), 1, strip);
  for (double& u : s.cloth.inverse_mass) u = 0;
  ASSERT_TRUE(s.wetting.set_fabric(s.id, settings.fabric).ok());
  StaticMesh tank;
  tank.add_box({Vec3(-0.03, 0, -0.03), Vec3(0.03, 0.2, 0.03)}, 0.06);
  ASSERT_TRUE(s.world.attach(tank, sheet_settings(), nullptr).ok());
  BoxEmitter water;
  water.box = {Vec3(-0.03, 0, -0.03), Vec3(0.03, depth, 0.03)};
  ASSERT_TRUE(s.world.add_emitter(water).ok());
  for (int k = 0; k < 900; ++k) s.step(4e-3);
  EXPECT_LE(std::abs(s.missing()), 1e-12 * s.emitted);
  const Span<const double> absorbed = s.world.absorbed(s.id), capacity = s.wetting.capacity(s.id);
  ASSERT_EQ(absorbed.size(), s.cloth.x.size());
  double worst = 0;
  for (std::size_t i = 0; i < absorbed.size(); ++i) {
    const double z = s.cloth.x[i].y() - depth;
    if (std::abs(z) < 0.01) continue;  // the surface of the water, two particles wide
    const double expected = std::min(1.0, std::max(0.0, 1 - z / rise));
    worst = std::max(worst, std::abs(absorbed[i] / capacity[i] - expected));
  }
  EXPECT_LT(worst, 0.08);
}

/// Variances of the liquid along both sides of a sheet [m²].
std::array<double, 2> variances(const WetScene& s) {
  const Span<const double> m = s.world.absorbed(s.id);
  double total = 0;
  Vec3 mean = Vec3::Zero(), square = Vec3::Zero();
  for (std::size_t i = 0; i < m.size(); ++i) {
    total += m[i];
    mean += m[i] * s.cloth.x[i];
    square += m[i] * s.cloth.x[i].cwiseProduct(s.cloth.x[i]);
  }
  mean /= total;
  const Vec3 variance = square / total - mean.cwiseProduct(mean);
  return {variance.x(), variance.z()};
}

TEST(Wetting, a_spot_spreads_as_an_ellipse_along_the_warp) {
  WettingSettings settings = thirsty();
  settings.fabric.capacity = 20;
  settings.fabric.diffusivity = 1e-4;
  settings.fabric.mobility_exponent = 0;
  settings.fabric.capillary_rise = 1e12;
  settings.fabric.anisotropy = 4;
  WetScene s(settings, Vec3(0, -9.81, 0));
  for (double& u : s.cloth.inverse_mass) u = 0;
  ASSERT_TRUE(s.wetting.set_fabric(s.id, settings.fabric).ok());
  s.add_block(3, Vec3(-0.005, 0.003, -0.005), Vec3::Zero());
  for (int k = 0; k < 200; ++k) s.step(1e-3);
  ASSERT_EQ(s.world.particle_count(), 0u);
  const std::array<double, 2> before = variances(s);
  for (int k = 0; k < 100; ++k) s.step(1e-2);
  const std::array<double, 2> after = variances(s);
  EXPECT_NEAR((after[0] - before[0]) / (after[1] - before[1]), 4, 0.1);
  // The mean of both is 2 D₀ t.
  EXPECT_NEAR(0.5 * (after[0] - before[0] + after[1] - before[1]), 2e-4, 1e-5);
}

TEST(Wetting, drops_wait_for_a_free_place) {
  WettingSettings settings;
  settings.dripping = 50;
  settings.fabric.saturation_limit = 10;
  WetScene s(settings, Vec3(0, -9.81, 0));
  s.pin_border();
  s.add_block(2, Vec3(0, 0.004, 0), Vec3::Zero());
  // A plate below the sheet, nearer than a particle is wide.
  GridShape plate = sheet();
  plate.origin.y() = -0.003;
  MockCloth<double> below(plate);
  for (double& u : below.inverse_mass) u = 0;
  ASSERT_TRUE(s.world.attach(below, sheet_settings(), nullptr).ok());
  s.step(1e-3);
  for (int k = 0; k < 500; ++k) s.step(1e-3);
  EXPECT_EQ(s.released, 0u);
  EXPECT_EQ(s.lost, 0);
}

TEST(Wetting, liquid_dries_at_its_rate) {
  WettingSettings settings = thirsty();
  settings.drying = 2;
  WetScene s(settings);
  s.add_block(3, Vec3(-0.005, 0.004, -0.005), Vec3(0, -0.5, 0));
  for (int k = 0; k < 300; ++k) s.step(1e-3);
  ASSERT_EQ(s.world.particle_count(), 0u);
  const double wet = s.world.absorbed_mass();
  for (int k = 0; k < 500; ++k) s.step(1e-3);
  EXPECT_NEAR(s.world.absorbed_mass() / wet, std::exp(-1.0), 0.005);
  EXPECT_LE(std::abs(s.missing()), 1e-12 * s.emitted);
}

/// Of the liquid that would dry in air, what dries under water on so many sides.
double dried_part(int sides) {
  WettingSettings settings;
  settings.fabric.capacity = 0.05;
  settings.fabric.diffusivity = 1e-12;
  settings.fabric.saturation_limit = 1;
  settings.absorption = 20;
  settings.dripping = 0;
  settings.drying = 1;
  GridShape as_wide_as_the_water;
  as_wide_as_the_water.nu = as_wide_as_the_water.nv = 9;
  as_wide_as_the_water.origin = Vec3(-0.02, 0, -0.02);
  as_wide_as_the_water.u = Vec3(0.04, 0, 0);
  as_wide_as_the_water.v = Vec3(0, 0, 0.04);
  WetScene s(settings, Vec3::Zero(), 1, as_wide_as_the_water);
  for (double& u : s.cloth.inverse_mass) u = 0;
  EXPECT_TRUE(s.wetting.set_fabric(s.id, settings.fabric).ok());
  s.add_block(8, Vec3(-0.0175, 0.5 * dx, -0.0175), Vec3::Zero());
  if (sides == 2) s.add_block(8, Vec3(-0.0175, -7.5 * dx, -0.0175), Vec3::Zero());
  for (int k = 0; k < 100; ++k) s.step(1e-3);
  EXPECT_GT(s.world.absorbed_mass(), 0.5 * 0.05 * 0.04 * 0.04) << "soaked";
  const double before = s.dried;
  for (int k = 0; k < 100; ++k) s.step(1e-3);
  EXPECT_LE(std::abs(s.missing()), 1e-12 * s.emitted);
  return (s.dried - before) / (settings.drying * 0.1 * s.world.absorbed_mass());
}

TEST(Wetting, liquid_dries_on_the_sides_that_no_water_covers) {
  EXPECT_NEAR(dried_part(1), 0.5, 0.1);
  EXPECT_LT(dried_part(2), 0.1);
}

TEST(Wetting, waterproof_cloth_and_fixed_surfaces_stay_dry_unless_they_have_a_fabric) {
  for (const bool fixed : {false, true})
    for (const bool own : {false, true}) {
      WetScene s(thirsty());
      if (fixed)
        for (double& u : s.cloth.inverse_mass) u = 0;
      if (own) {
        ASSERT_TRUE(s.wetting.set_fabric(s.id, thirsty().fabric).ok());
      }
      if (!fixed && !own) s.wetting.set_waterproof(s.id);
      s.add_block(3, Vec3(-0.005, 0.004, -0.005), Vec3(0, -0.5, 0));
      for (int k = 0; k < 50; ++k) s.step(1e-3);
      EXPECT_EQ(s.world.absorbed_mass() > 0, own);
    }
}

TEST(Wetting, effect_may_be_taken_away_and_put_back) {
  WetScene s(thirsty(), Vec3(0, -9.81, 0));
  s.pin_border();
  s.add_block(5, Vec3(-0.01, 0.004, -0.01), Vec3(0, -0.5, 0));
  for (int k = 0; k < 30; ++k) s.step(1e-3);
  const double held = s.world.absorbed_mass();
  EXPECT_GT(held, 0);
  s.world.remove_effect(s.wetting);
  for (int k = 0; k < 30; ++k) s.step(1e-3);
  EXPECT_EQ(s.world.absorbed_mass(), held);
  ASSERT_TRUE(s.world.add_effect(s.wetting).ok());
  for (int k = 0; k < 30; ++k) s.step(1e-3);
  EXPECT_GT(s.world.absorbed_mass(), held);
  EXPECT_LE(std::abs(s.missing()), 1e-12 * s.emitted);
}

TEST(Wetting, a_mesh_that_changes_loses_its_liquid_into_the_ledger) {
  WetScene s(thirsty());
  s.add_block(3, Vec3(-0.005, 0.004, -0.005), Vec3(0, -0.5, 0));
  for (int k = 0; k < 50; ++k) s.step(1e-3);
  const double held = s.world.absorbed_mass();
  ASSERT_GT(held, 0);
  s.cloth.announce_new = true;
  s.step(1e-3);
  EXPECT_NEAR(s.lost, held, 1e-15);
  EXPECT_LE(std::abs(s.missing()), 1e-12 * s.emitted);
}

std::uint64_t hash_of(const WetScene& s) {
  return s.world.state_hash();
}

TEST(Wetting, results_do_not_depend_on_threads) {
  std::uint64_t hash[2] = {};
  double held[2] = {};
  for (int threads : {1, 2}) {
    WetScene s(thirsty(), Vec3(0, -9.81, 0), threads);
    s.add_block(8, Vec3(-0.0175, 0.004, -0.0175), Vec3(0, -1, 0));
    for (int k = 0; k < 60; ++k) s.step(1e-3);
    hash[threads - 1] = hash_of(s);
    held[threads - 1] = s.world.absorbed_mass();
  }
  EXPECT_EQ(hash[0], hash[1]);
  EXPECT_EQ(held[0], held[1]);
  EXPECT_GT(held[0], 0);
}

TEST(Wetting, a_restored_world_continues_bit_for_bit) {
  const auto fresh = [] {
    auto s = std::make_unique<WetScene>(thirsty(), Vec3(0, -9.81, 0));
    s->pin_border();
    return s;
  };
  const auto first = fresh(), second = fresh();
  first->add_block(8, Vec3(-0.0175, 0.004, -0.0175), Vec3(0, -1, 0));
  for (int k = 0; k < 31; ++k) first->step(1e-3);
  std::vector<std::uint8_t> saved;
  ASSERT_TRUE(first->world.save(&saved).ok());
  second->cloth = first->cloth;
  const Status status = second->world.restore(saved);
  ASSERT_TRUE(status.ok()) << status.message;
  second->emitted = first->emitted;
  for (int k = 0; k < 30; ++k) {
    first->step(1e-3);
    second->step(1e-3);
    ASSERT_EQ(hash_of(*first), hash_of(*second)) << "step " << k;
  }
  EXPECT_EQ(sum(first->world.absorbed(first->id)), sum(second->world.absorbed(second->id)));
}

TEST(Wetting, a_new_fabric_counts_from_the_next_step_on) {
  WetScene s(thirsty());
  s.step(1e-3);
  const double before = sum(s.wetting.capacity(s.id));
  ASSERT_GT(before, 0);
  Fabric fabric = thirsty().fabric;
  fabric.capacity *= 0.5;
  ASSERT_TRUE(s.wetting.set_fabric(s.id, fabric).ok());
  EXPECT_EQ(sum(s.wetting.capacity(s.id)), before);
  s.step(1e-3);
  EXPECT_NEAR(sum(s.wetting.capacity(s.id)), 0.5 * before, 1e-12);
  s.wetting.set_waterproof(s.id);
  EXPECT_FALSE(s.wetting.capacity(s.id).empty());
  s.step(1e-3);
  EXPECT_TRUE(s.wetting.capacity(s.id).empty());
}

TEST(Wetting, settings_out_of_range_are_refused) {
  for (double WettingSettings::*field : {&WettingSettings::absorption, &WettingSettings::dripping,
                                         &WettingSettings::drying, &WettingSettings::transport_interval})
    for (double wrong : {-1.0, 1e7, std::nan("")}) {
      WettingSettings s;
      s.*field = wrong;
      EXPECT_FALSE(s.validate().ok());
      EXPECT_FALSE(Wetting(s).status().ok());
    }
  Wetting wetting;
  Fabric fabric;
  fabric.capacity = -1;
  EXPECT_FALSE(wetting.set_fabric(SurfaceId{1}, fabric).ok());
}

}  // namespace
}  // namespace oilskin::test
