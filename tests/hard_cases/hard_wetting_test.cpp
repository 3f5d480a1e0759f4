// Hard cases 27, 38, 39, 44 and 55: cloth that takes up all that it can and more, and lets it go.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hard_cases/hard_case.h"
#include "hard_cases/wet_scene.h"

namespace oilskin::test {
namespace {

using namespace water;

WettingSettings greedy() {
  WettingSettings s;
  s.fabric.capacity = 0.3;
  s.absorption = 1e4;
  s.dripping = 0;
  return s;
}

TEST(HardWetting, pins_that_are_freed_and_nodes_that_grow_heavy_keep_momentum) {
  HardCase c(
      "27",
      "a free sheet without gravity takes up a block at 2 m/s, 5 of its nodes are pins that hold water "
      "and are freed: speeds of nodes, momentum of water and cloth");
  double error = 0, jump = 0, grown = 0;
  Found all;
  WetFound found;
  Vec3 momentum = Vec3::Zero();
  for (PressureSolver solver : incompressible_solvers) {
    ClothSetup setup = wet_setup(solver);
    setup.world.gravity = setup.cloth_gravity = Vec3::Zero();
    const double dry = setup.shape.areal_density * 0.2 * 0.2 / (17 * 17);
    const std::size_t pins[] = {142, 143, 144, 145, 146};
    const int freed = 40;
    const auto fill_scene = [&](WetScene& s) {
      for (std::size_t i : pins) s.cloths[0]->pin(i);
      add_water(s.world(), 6, 3, 0, Vec3(0.2, -2, 0));
    };
    all.add(run_wet(setup, {greedy(), {}, {}}, 80, 1e-3, found, fill_scene, [&](WetScene& s, int k) {
      if (k > freed) {
        error = std::max(error, (s.momentum() - momentum).norm() / momentum.norm());
      }
      if (k != freed) return;
      for (std::size_t i : pins) {
        const Vec3 before = s.cloths[0]->v[i];
        s.cloths[0]->free_pin(i, dry);
        grown = std::max(grown, 1 / s.cloths[0]->inverse_mass[i] / dry);
        jump = std::max(jump, (s.cloths[0]->v[i] - before).norm());
      }
      momentum = s.momentum();
    }));
  }
  c.no_crossings(all);
  c.at_most("change of momentum after it", error, 1e-12);
  c.above("mass of a freed node, of its own when dry", grown, 2);
  c.equal("change of speed of a freed node", jump == 0 ? 0 : 1, 0);
  c.below("largest speed [m/s]", all.speed, 6);
}

/// Of a run of case 38.
struct Extreme {
  const char* name;
  WettingSettings settings;
  double soaked, dt;  ///< S of all nodes at the start; length of a step [s]
};

std::vector<Extreme> extremes() {
  std::vector<Extreme> list;
  WettingSettings s = greedy();
  list.push_back({"S = 0", s, 0, 1e-3});
  list.push_back({"S = 1", s, 1, 1e-3});
  list.push_back({"S at the limit", s, 1.5, 1e-3});
  s.absorption = 1e6;
  list.push_back({"absorption 1e6", s, 0, 1e-3});
  list.push_back({"dt × 1000", s, 0, 1});
  s.dripping = 1e6;
  s.drying = 1e6;
  list.push_back({"all rates 1e6, dt × 1000", s, 1, 1});
  s = greedy();
  s.fabric.capacity = 1e-6;
  s.absorption = 1e6;
  list.push_back({"least capacity", s, 0, 1e-3});
  s.fabric.saturation_limit = 1;
  list.push_back({"least capacity, no film, dt × 1000", s, 1, 1});
  s = greedy();
  s.fabric.capacity = 1e3;
  s.fabric.saturation_limit = 10;
  s.absorption = 1e6;
  list.push_back({"largest capacity", s, 0, 1e-3});
  return list;
}

TEST(HardWetting, any_rate_capacity_and_step_are_bounded_with_an_exact_ledger) {
  HardCase c(
      "38",
      "a pool on a sheet: absorption to 1e6, capacity 1e-6 and 1e3 kg/m², S to its limit, 1 ms and 1 s");
  Found all;
  double over = 0, least = 1, liquid = 0;
  for (const Extreme& e : extremes()) {
    SCOPED_TRACE(e.name);
    WetFound found;
    ClothSetup setup = wet_setup();
    const bool is_long = e.dt > 0.1;
    setup.fluid.max_substeps = is_long ? 4 : 1;
    setup.stiffness = is_long ? 2 : 200;  // the mock cloth takes fewer steps of its own
    const auto fill_scene = [&](WetScene& s) {
      pin_border(*s.cloths[0], 17);
      if (e.soaked > 0) s.soak(e.soaked);
      add_water(s.world(), 6, 3, 0, Vec3(0, -0.5, 0));
    };
    all.add(run_wet(setup, {e.settings, {}, {}}, is_long ? 5 : 30, e.dt, found, fill_scene));
    const double remainder = 0.05 * 1.25e-4 / (e.settings.fabric.capacity * 0.2 * 0.2 / 16 / 16 / 3);
    over = std::max(over, found.saturation - e.settings.fabric.saturation_limit - remainder);
    least = std::min(least, found.least_ratio);
    liquid = std::max(liquid, found.most_liquid);
  }
  c.no_crossings(all);
  c.at_most("S above the limit and the last remainder of a particle", over, 0);
  c.at_least("smallest mass of a particle, of a new one's", least, 0.0499);
  c.above("most liquid in a sheet [kg]", liquid, 0.01);
  c.at_most("momentum error", all.momentum_error, max_momentum_error);
}

/// Where drops start.
struct Starts {
  double nearest = 1, lowest = 0;  ///< to another particle [dx]; below the sheet [m]
  std::uint64_t behind = 0;        ///< not between the first sheet and the second

  void look(const World& w, std::uint64_t known, double gap) {
    const Span<const Vec3> x = w.positions();
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (w.ids()[i] <= known) continue;
      behind += x[i].y() > 0 || x[i].y() < -gap;
      for (std::size_t j = 0; j < x.size(); ++j)
        if (j != i) nearest = std::min(nearest, (x[i] - x[j]).norm() / dx);
    }
  }
};

/// A soaked sheet over a second one, pinned both, with `crowd` layers of water between them.
Found drip_between(double gap, int crowd, WetFound& found, Starts& starts) {
  ClothSetup setup = wet_setup();
  setup.layers = 2;
  setup.layer_gap = gap;
  setup.pinned = true;
  setup.shape.nu = setup.shape.nv = 9;
  setup.shape.origin = Vec3(-0.05, 0, -0.05);
  setup.shape.u.x() = setup.shape.v.z() = 0.1;
  WettingSettings wetting = greedy();
  wetting.absorption = 0;
  wetting.dripping = 500;
  std::uint64_t known = 0;
  const auto fill_scene = [&](WetScene& s) {
    EXPECT_TRUE(s.wetting->set_fabric(s.ids[0], wetting.fabric).ok());
    s.soak(1.4);
    if (crowd > 0) add_water(s.world(), 23, crowd, -0.5 * (gap + crowd * dx), Vec3::Zero());
    known = std::numeric_limits<std::uint64_t>::max();
  };
  return run_wet(setup, {wetting, {}, {}}, 25, 1e-3, found, fill_scene, [&](WetScene& s, int) {
    starts.look(s.world(), known, gap);
    const Span<const std::uint64_t> ids = s.world().ids();
    known = ids.empty() ? 0 : *std::max_element(ids.begin(), ids.end());
  });
}

TEST(HardWetting, drops_wait_where_there_is_no_room) {
  HardCase c("39", "a soaked sheet over another: 2 mm of air, 10 mm of air, 6 mm with a layer of water");
  WetFound narrow, wide, crowded;
  Starts starts;
  Found all = drip_between(0.002, 0, narrow, starts);
  all.add(drip_between(0.01, 0, wide, starts));
  all.add(drip_between(0.006, 1, crowded, starts));
  c.no_crossings(all);
  c.equal("drops into 2 mm of air", narrow.released, 0);
  c.above("drops into 10 mm of air", static_cast<double>(wide.released), 10);
  c.below("drops into water, of those into air",
          static_cast<double>(crowded.released) / static_cast<double>(wide.released), 0.5);
  c.at_least("least distance of a start from a particle [dx]", starts.nearest, 0.7);
  c.equal("drops that start behind another sheet", starts.behind, 0);
  c.below("largest speed [m/s]", all.speed, 3);
}

/// A soaked sheet of pins; a jet of 10 m/s beside it cuts each step of 16 ms into sub-steps.
Found drip_in_substeps(int substeps, WetFound& found, double& driest) {
  ClothSetup setup = wet_setup(PressureSolver::dfsph);
  setup.fluid.max_substeps = substeps;
  setup.pinned = true;
  WettingSettings wetting = greedy();
  wetting.absorption = 0;
  wetting.dripping = 500;
  const auto fill_scene = [&](WetScene& s) {
    EXPECT_TRUE(s.wetting->set_fabric(s.ids[0], wetting.fabric).ok());
    s.soak(1.4);
    DiscEmitter jet;
    jet.center = Vec3(-0.3, 0.2, -0.3);
    jet.radius = 0.003;
    jet.speed = 10;
    EXPECT_TRUE(s.world().add_emitter(jet).ok());
  };
  return run_wet(setup, {wetting, {}, {}}, 8, 16e-3, found, fill_scene, [&](WetScene& s, int k) {
    const Span<const double> held = s.world().absorbed(s.ids[0]), room = s.wetting->capacity(s.ids[0]);
    for (std::size_t i = 0; i < held.size() && k > 1; ++i) driest = std::min(driest, held[i] / room[i]);
  });
}

TEST(HardWetting, drops_take_no_more_than_the_excess_in_any_number_of_substeps) {
  HardCase c("63", "a sheet with S = 1.4 drips at 500/s, steps of 16 ms in 1 and in up to 8 sub-steps");
  WetFound one, many;
  double driest = 2;
  Found all = drip_in_substeps(1, one, driest);
  all.add(drip_in_substeps(8, many, driest));
  c.no_crossings(all);
  c.above("sub-steps", many.substeps, 3);
  c.above("drops in one sub-step, in two runs", static_cast<double>(one.released), 50);
  c.at_most("more drops in several", static_cast<double>(many.released) - static_cast<double>(one.released),
            2);
  c.at_least("smallest S of a node", driest, 1 - 1e-6);
}

/// Takes all water that is in a contact, and asks for it twice.
class TakeAll : public Effect {
 public:
  std::uint64_t taken = 0;
  std::string name() const override { return "take_all"; }
  bool changes_masses() const override { return true; }
  void exchange(EffectExchange& e) override {
    for (const Contact& contact : e.contacts) {
      const auto s = static_cast<std::size_t>(contact.surface);
      taken += e.absorb(contact.particle, s, contact.nodes, {1, 1, 1}) > 0;
      EXPECT_EQ(e.absorb(contact.particle, s, contact.nodes, {1, 1, 1}), 0);
    }
  }
};

TEST(HardWetting, particles_that_are_used_up_in_a_contact_leave_no_trace) {
  HardCase c("44",
             "a block at 20 m/s on two free sheets 3 mm apart: all that touches is absorbed in the interval "
             "of its impact, by wetting and by an effect that takes what is in the list of contacts");
  Found all;
  WetFound found;
  std::uint64_t in_lists = 0;
  for (PressureSolver solver : all_solvers)
    for (const bool by_list : {false, true}) {
      ClothSetup setup = wet_setup(solver, solver != PressureSolver::mcg03);
      setup.layers = 2;
      setup.layer_gap = 0.003;
      WettingSettings wetting = greedy();
      wetting.fabric.capacity = 50;
      wetting.absorption = by_list ? 0 : 1e6;
      std::vector<TakeAll> takes(2);
      std::size_t scene = 0;
      all.add(run_wet(setup, {wetting, {}, {}}, 25, 1e-3, found, [&](WetScene& s) {
        pin_border(*s.cloths[0], 17);
        add_water(s.world(), 8, 6, 0.002, Vec3(1, -20, 0));
        TakeAll& take = takes[scene++];
        EXPECT_TRUE(!by_list || s.world().add_effect(take).ok());
      }));
      in_lists += takes[0].taken;
    }
  c.no_crossings(all);
  c.above("particles that were absorbed, of 2304 in two runs each", static_cast<double>(found.absorbed),
          2000);
  c.above("particles taken from lists", static_cast<double>(in_lists), 300);
  c.at_most("momentum error", all.momentum_error, max_momentum_error);
  c.below("largest speed [m/s]", all.speed, 25);
}

TEST(HardWetting, a_soaked_sheet_in_the_rain_stays_at_its_limit_and_drips) {
  HardCase c(
      "55",
      "a sheet of 0.1 kg/m² that holds three times its capacity, its limit, stands for 1.2 s under rain");
  ClothSetup setup = wet_setup(PressureSolver::dfsph);
  WettingSettings wetting = greedy();
  wetting.fabric.capacity = 0.1;
  wetting.fabric.saturation_limit = 3;
  wetting.absorption = 100;
  wetting.dripping = 50;
  WetFound found;
  const auto fill_scene = [&](WetScene& s) {
    pin_border(*s.cloths[0], 17);
    s.soak(3);
    RainEmitter rain;
    rain.corner = Vec3(-0.08, 0.05, -0.08);
    rain.edge_u = Vec3(0.16, 0, 0);
    rain.edge_v = Vec3(0, 0, 0.16);
    rain.drops_per_second = 40;
    rain.velocity = Vec3(0, -0.5, 0);
    EXPECT_TRUE(s.world().add_emitter(rain).ok());
  };
  const Found all = run_wet(setup, {wetting, {}, {}}, 300, 4e-3, found, fill_scene);
  c.no_crossings(all);
  c.at_most("largest S", found.saturation, 3.001);
  c.above("drops, in two runs", static_cast<double>(found.released), 40);
  c.at_most("momentum error", all.momentum_error, max_momentum_error);
  c.below("largest speed [m/s]", all.speed, 5);
}

}  // namespace
}  // namespace oilskin::test
