// What an effect asks of the seam that cannot be: calls that name nothing, give more than there is, or start
// particles where none may start.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "support/mock_cloth.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin {
namespace {

using test::MockCloth;
using test::sheet_settings;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();
constexpr std::array<std::uint32_t, 3> middle{39, 40, 41};

using Call = std::function<void(EffectExchange&)>;

/// Does in an interval what a test asks for.
class Script : public Effect {
 public:
  Call call;
  std::function<void(EffectForces&)> push;
  std::string name() const override { return "script"; }
  bool changes_masses() const override { return true; }
  void act(EffectForces& f) override {
    if (push) push(f);
  }
  void exchange(EffectExchange& e) override {
    if (call) call(e);
  }
};

/// Cloth that stays as light as it is dry.
class CarelessCloth : public MockCloth<double> {
 public:
  using MockCloth::MockCloth;
  void scatter(SurfaceMotion& motion) override {
    const std::vector<double> absorbed = std::move(motion.absorbed_mass);
    motion.absorbed_mass.clear();
    MockCloth::scatter(motion);
    motion.absorbed_mass = absorbed;
  }
};

/// 27 particles 50 mm above a free sheet of 81 nodes that has absorbed five of them.
template <class Cloth>
struct Scene {
  Cloth cloth;
  Script script;
  World world;
  SurfaceId id;

  Scene() : world(settings()) {
    EXPECT_TRUE(world.attach(cloth, sheet_settings(), &id).ok());
    EXPECT_TRUE(world.add_effect(script).ok());
    test::add_block(world, 3, Vec3(0.04, 0.05, 0.04), Vec3(0.1, 0, 0));
    step([](EffectExchange& e) {
      for (std::size_t i = 0; i < 5; ++i) {
        const double m = e.particle_mass;
        EXPECT_EQ(e.absorb(i, 0, middle, {0.25 * m, 0.5 * m, 0.25 * m}), m);
      }
    });
  }
  static WorldSettings settings() {
    WorldSettings s;
    s.gravity = Vec3::Zero();
    s.kill_box = {Vec3::Constant(-1), Vec3::Constant(1)};
    return s;
  }
  const StepReport& step(Call call) {
    script.call = std::move(call);
    const StepReport& r = world.step(1e-3);
    script.call = nullptr;
    EXPECT_TRUE(r.status.ok());
    EXPECT_LE(r.momentum_residual().norm(), 1e-14);
    return r;
  }
  double total() const { return world.fluid_mass() + world.absorbed_mass(); }
};
using WetSheet = Scene<MockCloth<double>>;

/// A drop below the middle of the sheet that may start.
Release good_release(const EffectExchange& e) {
  Release r;
  const Vec3 x = e.surfaces[0]->x_t1[40];
  r.from = x - Vec3(0, 1e-5, 0);
  r.position = x - Vec3(0, 0.004, 0);
  r.nodes = {{39, 0.25 * e.particle_mass}, {40, 0.5 * e.particle_mass}, {41, 0.25 * e.particle_mass}};
  return r;
}

/// Whether a world in which the calls are made goes on as one in which they are not.
void expect_no_harm(const std::vector<std::pair<const char*, Call>>& calls) {
  for (const auto& [what, call] : calls) {
    SCOPED_TRACE(what);
    WetSheet asked, twin;
    const StepReport& r = asked.step(call);
    twin.step({});
    EXPECT_EQ(r.absorbed + r.released + r.removed, 0u);
    EXPECT_EQ(r.mass_absorbed + r.mass_released + r.mass_dried + r.mass_lost, 0);
    EXPECT_EQ(asked.total(), twin.total());
    for (int k = 0; k < 3; ++k) asked.step({}), twin.step({});
    EXPECT_EQ(asked.world.state_hash(), twin.world.state_hash());
  }
}

TEST(Exchange, absorption_by_nothing_or_from_nothing_is_ignored) {
  const auto absorb = [](std::size_t i, std::size_t surface, std::array<std::uint32_t, 3> nodes,
                         std::array<double, 3> mass) {
    return [=](EffectExchange& e) { EXPECT_EQ(e.absorb(i, surface, nodes, mass), 0); };
  };
  const std::array<double, 3> some{1e-6, 1e-6, 1e-6};
  expect_no_harm({{"particle", absorb(22, 0, middle, some)},
                  {"any particle", absorb(SIZE_MAX, 0, middle, some)},
                  {"surface", absorb(0, 1, middle, some)},
                  {"any surface", absorb(0, SIZE_MAX, middle, some)},
                  {"node", absorb(0, 0, {0, 1, 81}, some)},
                  {"node without a mass", absorb(0, 0, {UINT32_MAX, 1, 2}, {0, 1e-6, 1e-6})},
                  {"no mass", absorb(0, 0, middle, {0, -1, nan})},
                  {"infinite mass", absorb(0, 0, middle, {inf, -inf, nan})},
                  {"mass that rounding removes", absorb(0, 0, middle, {1e-300, 0, 0})}});
}

TEST(Exchange, passage_and_vapour_of_nothing_is_ignored) {
  const auto transport = [](std::size_t surface, std::uint32_t from, std::uint32_t to, double mass) {
    return [=](EffectExchange& e) { e.transport(surface, from, to, mass); };
  };
  const auto dry = [](std::size_t surface, std::uint32_t node, double mass) {
    return [=](EffectExchange& e) { e.dry(surface, node, mass); };
  };
  expect_no_harm({{"surface", transport(1, 40, 41, 1e-6)},
                  {"from", transport(0, 81, 41, 1e-6)},
                  {"to", transport(0, 40, UINT32_MAX, 1e-6)},
                  {"to itself", transport(0, 40, 40, 1e-5 / 3)},
                  {"from a dry node", transport(0, 0, 40, 1e-6)},
                  {"negative", transport(0, 40, 41, -1e-6)},
                  {"not a number", transport(0, 40, 41, nan)},
                  {"infinite", transport(0, 40, 41, inf)},
                  {"vapour of no surface", dry(SIZE_MAX, 40, 1e-6)},
                  {"vapour of no node", dry(0, 81, 1e-6)},
                  {"vapour of a dry node", dry(0, 0, 1e-6)},
                  {"negative vapour", dry(0, 40, -1e-6)},
                  {"infinite vapour", dry(0, 40, inf)}});
}

TEST(Exchange, a_release_that_is_none_is_ignored) {
  const auto but = [](const std::function<void(Release&)>& change) {
    return [change](EffectExchange& e) {
      Release r = good_release(e);
      change(r);
      e.release(r);
    };
  };
  expect_no_harm({{"surface", but([](Release& r) { r.surface = 1; })},
                  {"no node", but([](Release& r) { r.nodes.clear(); })},
                  {"a node that is not there", but([](Release& r) { r.nodes[1].first = 81; })},
                  {"a dry node", but([](Release& r) { r.nodes[1].first = 0; })},
                  {"half a particle", but([](Release& r) {
                     for (auto& node : r.nodes) node.second *= 0.5;
                   })},
                  {"a millionth more", but([](Release& r) { r.nodes[0].second *= 1 + 4e-6; })},
                  {"two particles", but([](Release& r) {
                     for (auto& node : r.nodes) node.second *= 2;
                   })},
                  {"a negative part", but([](Release& r) {
                     r.nodes[0].second += 1e-6;
                     r.nodes.emplace_back(42, -1e-6);
                   })},
                  {"more than a node has, in two parts", but([](Release& r) {
                     const double m = 4 * r.nodes[0].second;
                     r.nodes = {{39, 0.625 * m}, {39, 0.625 * m}, {40, -0.25 * m}};
                   })},
                  {"not a number of mass", but([](Release& r) { r.nodes[0].second = nan; })},
                  {"infinite mass", but([](Release& r) { r.nodes[0].second = inf; })},
                  {"no place", but([](Release& r) { r.position.x() = nan; })},
                  {"a place at infinity", but([](Release& r) { r.position.y() = -inf; })},
                  {"a way from nowhere", but([](Release& r) { r.from.z() = nan; })},
                  {"a way from far", but([](Release& r) { r.from.z() = 1e200; })}});
}

TEST(Exchange, a_release_where_no_particle_may_start_waits) {
  const auto at = [](const Vec3& move) {
    return [=](EffectExchange& e) {
      Release r = good_release(e);
      r.position += move;
      e.release(r);
    };
  };
  expect_no_harm({{"in the sheet", at(Vec3(0, 0.004, 0))},
                  {"nearer than 2 δ", at(Vec3(0, 0.004 - 1.9e-6, 0))},
                  {"through the sheet", at(Vec3(0, 0.008, 0))},
                  {"outside the kill box", at(Vec3(0, -1, 0))},
                  {"at a particle", [](EffectExchange& e) {
                     Release r = good_release(e);
                     const Vec3 up(0, 1e-5, 0);
                     r.from = e.surfaces[0]->x_t1[40] + up;
                     r.position = e.position[20] + 0.69 * e.spacing * Vec3::UnitX();
                     e.release(r);
                   }}});
}

TEST(Exchange, a_release_beyond_the_limit_of_particles_stays_in_the_sheet) {
  WetSheet s;
  const double m = s.world.particle_mass();
  const auto drop = [](EffectExchange& e) { e.release(good_release(e)); };
  s.world.set_max_particles(22);
  EXPECT_EQ(s.step(drop).released, 0u);
  EXPECT_NEAR(s.world.absorbed_mass(), 5 * m, 1e-14 * m);
  s.world.set_max_particles(23);
  EXPECT_EQ(s.step(drop).released, 1u);
  EXPECT_NEAR(s.world.absorbed_mass(), 4 * m, 1e-14 * m);
}

TEST(Exchange, a_particle_that_is_removed_takes_the_mass_that_it_has_left) {
  WetSheet s;
  const double m = s.world.particle_mass();
  s.step([m](EffectExchange& e) { e.absorb(7, 0, middle, {0.1 * m, 0.2 * m, 0}); });
  EXPECT_NEAR(s.world.fluid_mass(), 21.7 * m, 1e-6 * m);
  const double absorbed = s.world.absorbed_mass(), fluid = s.world.fluid_mass();
  const Vec3 momentum = test::fluid_momentum(s.world);
  s.world.clear();
  const StepReport& r = s.step({});
  EXPECT_EQ(r.removed, 22u);
  EXPECT_NEAR(r.mass_removed, fluid, 1e-14 * fluid);
  EXPECT_LT((r.momentum_removed - momentum).norm(), 1e-14 * momentum.norm());
  EXPECT_EQ(s.world.absorbed_mass(), absorbed);
}

TEST(Exchange, what_is_there_leaves_once) {
  WetSheet s;
  const double before = s.total(), m = s.world.particle_mass();
  EXPECT_EQ(s.step([](EffectExchange& e) {
               Release far = good_release(e);
               far.position.y() -= 0.1;
               for (int k = 0; k < 3; ++k) e.release(good_release(e));  // at the same place
               e.release(far);
             }).released,
            2u);
  EXPECT_EQ(s.step([](EffectExchange& e) {  // three particles' worth is left; two of them in node 40
               for (int k = 0; k < 5; ++k) {
                 Release r = good_release(e);
                 r.position.y() -= 0.01 * (k + 1);
                 r.nodes = {{40, e.particle_mass}};
                 e.release(r);
               }
             })
                .released,
            1u);
  EXPECT_NEAR(s.total(), before, 1e-15 * before);
  EXPECT_NEAR(s.world.absorbed_mass(), 2 * m, 1e-14 * m);
  s.step([](EffectExchange& e) {
    e.transport(0, 39, 0, 1e300);
    e.dry(0, 40, 1e300);
  });
  EXPECT_EQ(s.world.absorbed(s.id)[39] + s.world.absorbed(s.id)[40], 0);
  EXPECT_NEAR(s.world.absorbed(s.id)[0], 0.75 * m, 1e-14 * m);
  EXPECT_NEAR(s.world.report().mass_dried + s.total(), before, 1e-15 * before);
}

TEST(Exchange, a_particle_gives_at_most_what_it_has_and_ends) {
  WetSheet s;
  const double before = s.total(), m = s.world.particle_mass();
  const StepReport& r = s.step([](EffectExchange& e) {
    EXPECT_EQ(e.absorb(3, 0, middle, {1e300, 1e300, nan}), e.particle_mass);
    EXPECT_EQ(e.absorb(3, 0, middle, {1, 1, 1}), 0) << "a second time";
    EXPECT_EQ(e.mass(3), 0);
    const double gave = e.absorb(4, 0, {7, 7, 7}, {1e-6, 1e-6, 1e-6});
    EXPECT_NEAR(gave + e.mass(4), e.particle_mass, 1e-15 * e.particle_mass);
  });
  EXPECT_EQ(r.absorbed, 1u);
  EXPECT_EQ(s.world.particle_count(), 21u);
  EXPECT_NEAR(s.total(), before, 1e-15 * before);
  EXPECT_NEAR(s.world.absorbed(s.id)[7], 3e-6, 1e-7 * m);
}

TEST(Exchange, particles_with_almost_no_mass_stay_finite_or_end) {
  for (const float left : {1e-6f, 6e-8f, 5e-8f, 1e-20f, 1e-45f}) {
    WetSheet s;
    Script& script = s.script;
    script.call = [&](EffectExchange& e) {
      for (std::size_t i = 0; i < e.id.size(); i += 2) {
        const double now = e.mass(i) / e.particle_mass;
        if (now > 2 * static_cast<double>(left))
          e.absorb(i, 0, middle, {(now - static_cast<double>(left)) * e.particle_mass, 0, 0});
      }
    };
    std::vector<Vec3> down(s.world.particle_count(), Vec3(0, -10, 0));
    ASSERT_TRUE(s.world.add_velocities(down).ok());
    const double before = s.total();
    for (int k = 0; k < 30; ++k) {
      const StepReport& r = s.world.step(1e-3);
      ASSERT_TRUE(r.status.ok());
      ASSERT_EQ(r.removed + r.removed_invalid, 0u) << left << " in step " << k;
      for (const Vec3& v : s.world.velocities()) ASSERT_LT(v.norm(), 100) << left << " in step " << k;
      ASSERT_LE(r.momentum_residual().norm(), 1e-13);
    }
    EXPECT_NEAR(s.total(), before, 1e-14 * before);
    EXPECT_EQ(s.world.particle_count(), left > 0x1p-24f ? 22u : 0u);
  }
}

TEST(Exchange, an_exception_after_an_exchange_leaves_no_trace) {
  WetSheet s;
  const double before = s.total();
  std::vector<std::uint8_t> saved, after;
  ASSERT_TRUE(s.world.save(&saved).ok());
  s.script.call = [](EffectExchange& e) {
    e.absorb(0, 0, middle, {1, 1, 1});
    e.transport(0, 40, 0, 1e-4);
    e.dry(0, 41, 1e-5);
    e.release(good_release(e));
    throw std::runtime_error("thrown by a test");
  };
  EXPECT_THROW(s.world.step(1e-3), std::runtime_error);
  ASSERT_TRUE(s.world.save(&after).ok());
  EXPECT_EQ(saved, after);
  EXPECT_EQ(s.step({}).released, 0u);
  EXPECT_EQ(s.total(), before);
}

// A node of 25 mg that holds 310 mg. What leaves is 25 mg more than what arrives.
TEST(Exchange, a_host_that_does_not_weigh_its_liquid_keeps_its_speed) {
  Scene<CarelessCloth> s;
  double speed = 0;
  for (int k = 0; k < 5; ++k) {
    s.step([](EffectExchange& e) {
      const double own = 1 / e.surfaces[0]->inverse_mass[40];
      e.transport(0, 40, 0, own + 1e-5 - 1e-9);
      EXPECT_NEAR(e.absorb(0, 0, {40, 40, 40}, {1e-5, 0, 0}), 1e-5, 1e-10);
    });
    for (const auto& v : s.cloth.v) speed = std::max(speed, v.norm());
  }
  EXPECT_LE(speed, 0.1) << "that of the water";
}

TEST(Exchange, forces_on_nothing_are_left_out) {
  WetSheet pushed, twin;
  pushed.script.push = [](EffectForces& f) {
    const Vec3 force(0, 1, 0);
    f.push(1, middle, {0.3, 0.3, 0.4}, force);
    f.push(SIZE_MAX, middle, {0.3, 0.3, 0.4}, force);
    f.push(0, {39, 40, 81}, {0.3, 0.3, 0.4}, force);
    f.push(0, middle, {0.3, 0.3, 0.4}, Vec3(0, nan, 0));
    f.push(0, middle, {inf, inf, inf}, force);
  };
  for (int k = 0; k < 3; ++k) pushed.step({}), twin.step({});
  EXPECT_EQ(pushed.world.state_hash(), twin.world.state_hash());
}

// The host offers another mesh with a mass that cannot be, and corrects it.
TEST(Exchange, liquid_of_a_mesh_that_was_refused_is_booked) {
  WetSheet s;
  const double held = s.world.absorbed_mass();
  test::GridShape finer;
  finer.nu = finer.nv = 12;
  s.cloth = MockCloth<double>(finer);
  s.cloth.inverse_mass[0] = -1;
  EXPECT_EQ(s.step({}).messages.size(), 1u) << "left out";
  s.cloth.pin(0);
  s.world.reset_motion(s.id);
  double lost = 0;
  for (int k = 0; k < 3; ++k) {
    const StepReport& r = s.step([](EffectExchange& e) {
      if (!e.surfaces.empty()) e.absorb(0, 0, middle, {1e-6, 1e-6, 1e-6});
    });
    EXPECT_TRUE(r.messages.empty()) << r.messages[0];
    EXPECT_LE(std::abs(r.energy.work_host), 1e-9) << "of what the host gave when it was refused";
    EXPECT_LE(r.energy.entered_kinetic, 1e-3);
    lost += r.mass_lost;
  }
  EXPECT_EQ(lost, held);
}

}  // namespace
}  // namespace oilskin
