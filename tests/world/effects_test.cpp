// Effects: their forces, their numbers, and what is saved of them.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <stdexcept>

#include "support/busy_scene.h"
#include "world/saved_bytes.h"

namespace oilskin {
namespace {

using test::busy_world;
using test::BusyScene;
using test::Bytes;
using test::MockCloth;
using test::sheet_settings;

WorldSettings world_of(const Vec3& gravity, int threads = 1) {
  WorldSettings s;
  s.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
  s.gravity = gravity;
  s.threads = threads;
  return s;
}

/// A part of the dye of each particle goes to the nodes that it touches, which
/// slow dyed water down.
class Dye : public Effect {
 public:
  double rate = 20;       // [1/s]
  int throws_after = -1;  // calls of exchange()
  int calls = 0;

  std::string name() const override { return "dye"; }
  std::vector<double> particle_values() const override { return {1, 0}; }
  std::vector<double> node_values() const override { return {0}; }

  void act(EffectForces& f) override {
    const Span<double> dye = f.of_particles(0), seen = f.of_particles(1);
    f.for_each(f.id.size(), [&](std::size_t i) {
      f.acceleration[i] -= dye[i] * f.velocity[i];
      seen[i] = static_cast<double>(f.id[i]);
    });
  }
  void exchange(EffectExchange& e) override {
    const double share = -std::expm1(-rate * e.dt);
    for (const Contact& c : e.contacts) {
      double& dye = e.of_particles(0)[c.particle];
      const double given = share * dye;
      dye -= given;
      for (int k = 0; k < 3; ++k) e.of_nodes(c.surface, 0)[c.nodes[k]] += c.weights[k] * given;
    }
    if (throws_after >= 0 && calls++ == throws_after) throw std::runtime_error("thrown by a test");
  }
  std::vector<std::uint8_t> save() const override { return {static_cast<std::uint8_t>(rate)}; }
  Status restore(Span<const std::uint8_t> saved) override {
    if (saved.size() != 1 || saved[0] > 100) return Status::refused("the rate makes no sense");
    rate = saved[0];
    return {};
  }
};

/// The acceleration of a field.
class Field : public Effect {
 public:
  explicit Field(std::string name, const Vec3& value) : name_(std::move(name)), value_(value) {}
  std::string name() const override { return name_; }
  void act(EffectForces& f) override {
    for (Vec3& a : f.acceleration) a += value_;
  }

 private:
  std::string name_;
  Vec3 value_;
};

double sum(Span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Dye of all particles and nodes of a scene.
template <class Scalar>
double total_dye(const BusyScene<Scalar>& s, const Dye& dye) {
  double total = sum(s.world.particle_values(dye, 0));
  for (SurfaceId id : {s.cloth_id, s.floor_id, s.lid_id, s.press_id})
    total += sum(s.world.node_values(dye, id, 0));
  return total;
}

TEST(Effects, a_constant_field_is_gravity) {
  const Vec3 g(1, -9.81, 2);
  World falls(world_of(g)), driven(world_of(Vec3::Zero()));
  Field field("field", g);
  ASSERT_TRUE(driven.add_effect(field).ok());
  for (World* w : {&falls, &driven}) {
    test::add_block(*w, 4, Vec3::Zero(), Vec3(0, 1, 0));
    for (int k = 0; k < 100; ++k) {
      ASSERT_TRUE(w->step(k % 3 ? 1e-3 : 1.5e-3).status.ok());
      ASSERT_LE(w->report().momentum_residual().norm(), 1e-14);
    }
  }
  ASSERT_EQ(driven.particle_count(), 64u);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_LE((driven.positions()[i] - falls.positions()[i]).norm(), 1e-6);
  EXPECT_GT(driven.report().momentum_effects.norm(), 0);
  const EnergyReport& e = driven.report().energy;
  EXPECT_GT(std::abs(e.work_outside), 0.1 * std::abs(e.water_kinetic - e.entered_kinetic));
  EXPECT_LE(std::abs(e.made), 1e-12 * std::abs(e.work_outside));
}

TEST(Effects, numbers_follow_their_particle_and_what_is_exchanged_is_kept) {
  std::uint64_t hash[2];
  std::vector<double> nodes[2];
  for (int threads : {1, 2}) {
    BusyScene<float> s(busy_world(threads), {});
    Dye dye;
    ASSERT_TRUE(s.world.add_effect(dye).ok());
    s.add_emitters();
    double entered = 0, removed = 0;
    for (int k = 0; k < 40; ++k) {
      const double before = total_dye(s, dye);
      const StepReport& r = s.step(k);
      ASSERT_TRUE(r.status.ok());
      ASSERT_LE(r.momentum_residual().norm(), 1e-12);
      entered += static_cast<double>(r.emitted);
      removed += static_cast<double>(r.removed + r.removed_invalid);
      if (r.removed == 0) {
        EXPECT_NEAR(total_dye(s, dye), before + static_cast<double>(r.emitted), 1e-10 * (1 + before));
      }
      const Span<const double> seen = s.world.particle_values(dye, 1);
      for (std::size_t i = 0; i < seen.size(); ++i)
        EXPECT_TRUE(seen[i] == 0 || seen[i] == static_cast<double>(s.world.ids()[i])) << "step " << k;
    }
    EXPECT_GT(entered, 300);
    const Span<const double> dyed = s.world.node_values(dye, s.cloth_id, 0);
    nodes[threads - 1].assign(dyed.begin(), dyed.end());
    hash[threads - 1] = s.world.state_hash();
  }
  EXPECT_GT(sum(nodes[0]), 1);
  EXPECT_EQ(hash[0], hash[1]);
  EXPECT_EQ(nodes[0], nodes[1]);
}

TEST(Effects, a_saved_world_goes_on_with_its_effects_bit_for_bit) {
  BusyScene<double> s(busy_world(1), {}), other(busy_world(2), {});
  Dye dye, restored;
  dye.rate = 30;
  ASSERT_TRUE(s.world.add_effect(dye).ok());
  s.add_emitters();
  for (int k = 0; k < 25; ++k) ASSERT_TRUE(s.step(k).status.ok());
  const Bytes bytes = test::save(s.world);
  EXPECT_FALSE(other.world.restore(bytes).ok()) << "the effect is missing";
  ASSERT_TRUE(other.world.add_effect(restored).ok());
  const Status status = other.world.restore(bytes);
  ASSERT_TRUE(status.ok()) << status.message;
  other.set_host_state(s.host_state());
  EXPECT_EQ(restored.rate, 30);
  EXPECT_EQ(test::save(other.world), bytes);
  for (int k = 25; k < 40; ++k) {
    s.step(k), other.step(k);
    ASSERT_EQ(s.world.state_hash(), other.world.state_hash());
  }
  EXPECT_EQ(test::save(other.world), test::save(s.world));
}

TEST(Effects, a_restore_that_is_refused_changes_nothing) {
  BusyScene<double> s(busy_world(1), {});
  Dye dye, there;
  dye.rate = 200;  // which restore() refuses
  Field first("first", Vec3(0, 1, 0)), second("second", Vec3::Zero());
  ASSERT_TRUE(s.world.add_effect(first).ok());
  ASSERT_TRUE(s.world.add_effect(dye).ok());
  const Bytes bytes = test::save(s.world);
  BusyScene<double> other(busy_world(1), {});
  ASSERT_TRUE(other.world.add_effect(second).ok());
  ASSERT_TRUE(other.world.add_effect(there).ok());
  const Bytes before = test::save(other.world);
  EXPECT_NE(other.world.restore(bytes).message.find("second"), std::string::npos) << "another effect";
  other.world.remove_effect(second);
  other.world.remove_effect(there);
  ASSERT_TRUE(other.world.add_effect(first).ok());
  ASSERT_TRUE(other.world.add_effect(there).ok());
  EXPECT_NE(other.world.restore(bytes).message.find("dye: the rate makes no sense"), std::string::npos);
  EXPECT_EQ(there.rate, 20);
  EXPECT_EQ(other.world.particle_count(), 0u);
  EXPECT_NE(test::save(other.world), bytes);
}

TEST(Effects, one_that_throws_leaves_no_trace_in_the_world) {
  BusyScene<float> s(busy_world(1), {});
  Dye dye;
  ASSERT_TRUE(s.world.add_effect(dye).ok());
  s.add_emitters();
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(s.step(k).status.ok());
  const Bytes before = test::save(s.world);
  dye.throws_after = 0;
  EXPECT_THROW(s.step(20), std::runtime_error);
  dye.throws_after = -1;
  EXPECT_EQ(test::save(s.world), before);
}

TEST(Effects, nodes_keep_their_numbers_in_a_teleport_and_lose_them_with_the_mesh) {
  World w(world_of(Vec3::Zero()));
  MockCloth<double> cloth;
  SurfaceId id;
  Dye dye;
  ASSERT_TRUE(w.attach(cloth, sheet_settings(), &id).ok());
  ASSERT_TRUE(w.add_effect(dye).ok());
  const std::vector<double> wet(cloth.x.size(), 0.5);
  ASSERT_TRUE(w.set_node_values(dye, id, 0, wet).ok());
  w.reset_motion(id);
  for (auto& x : cloth.x) x.y() += 0.3;
  ASSERT_TRUE(w.step(1e-3).status.ok());
  EXPECT_EQ(sum(w.node_values(dye, id, 0)), 0.5 * static_cast<double>(wet.size()));
  cloth.announce_new = true;
  ASSERT_TRUE(w.step(1e-3).status.ok());
  EXPECT_EQ(sum(w.node_values(dye, id, 0)), 0);
}

/// Each particle and the middle of the sheet's first triangle attract each other.
class Attraction : public Effect {
 public:
  std::string name() const override { return "attraction"; }
  void act(EffectForces& f) override {
    const Triangle& t = f.surfaces[0]->triangles[0];
    for (std::size_t i = 0; i < f.id.size(); ++i) {
      const Vec3 pull(0, -0.02, 0.01);  // [N]
      f.acceleration[i] += pull / f.particle_mass;
      f.push(0, t, {0.2, 0.3, 0.5}, -pull);
    }
  }
};

TEST(Effects, forces_between_particles_and_cloth_keep_momentum) {
  for (BoundaryModel boundary : {BoundaryModel::contact_only, BoundaryModel::mirrored}) {
    FluidSettings fluid;
    fluid.boundary = boundary;
    World w(world_of(Vec3::Zero()), fluid);
    MockCloth<double> cloth;
    SurfaceId id;
    Attraction attraction;
    ASSERT_TRUE(w.attach(cloth, sheet_settings(), &id).ok());
    ASSERT_TRUE(w.add_effect(attraction).ok());
    test::add_block(w, 3, Vec3(0.04, 0.01, 0.04), Vec3::Zero());
    for (int k = 0; k < 60; ++k) {
      const StepReport& r = w.step(1e-3);
      ASSERT_TRUE(r.status.ok());
      ASSERT_LE(r.momentum_residual().norm(), 1e-14);
      ASSERT_LE(r.momentum_effects.norm(), 1e-14);
      ASSERT_LE((test::fluid_momentum(w) + cloth.momentum()).norm(), 1e-13);
    }
    EXPECT_GT(test::fluid_momentum(w).norm() + cloth.momentum().norm(), 1e-3);
    EXPECT_GT(w.report().energy.work_outside, 0);
  }
}

TEST(Effects, neighbours_are_those_within_h_that_no_surface_hides) {
  class Counts : public Effect {
   public:
    std::string name() const override { return "counts"; }
    void act(EffectForces& f) override {
      pairs = 0;
      for (std::size_t i = 0; i < f.id.size(); ++i)
        for (std::uint32_t j : f.neighbours(i)) {
          ++pairs;
          crossing += f.position[i].y() * f.position[j].y() < 0;
          beyond += (f.position[i] - f.position[j]).norm() > f.support_radius * (1 + 1e-6) || i == j;
        }
    }
    std::size_t pairs = 0, crossing = 0, beyond = 0;
  };
  World w(world_of(Vec3::Zero()));
  test::StaticMesh sheet;
  sheet.add_rectangle(Vec3(-0.5, 0, -0.5), Vec3(1, 0, 0), Vec3(0, 0, 1));
  SurfaceId id;
  Counts counts;
  ASSERT_TRUE(w.attach(sheet, sheet_settings(), &id).ok());
  ASSERT_TRUE(w.add_effect(counts).ok());
  const double dx = w.fluid_settings().spacing;
  test::add_block(w, 4, Vec3(0, 0.5 * dx, 0), Vec3::Zero());
  test::add_block(w, 4, Vec3(0, -3.5 * dx, 0), Vec3::Zero());
  ASSERT_TRUE(w.step(1e-4).status.ok());
  EXPECT_GT(counts.pairs, 128u * 6);
  EXPECT_EQ(counts.pairs % 2, 0u);
  EXPECT_EQ(counts.crossing, 0u);
  EXPECT_EQ(counts.beyond, 0u);
}

TEST(Effects, wrong_use_is_refused_and_wrong_forces_are_reported) {
  World w(world_of(Vec3::Zero()));
  test::add_block(w, 3, Vec3::Zero(), Vec3::Zero());
  Dye dye, twin;
  Field broken("broken", Vec3::Constant(std::nan("")));
  ASSERT_TRUE(w.add_effect(dye).ok());
  EXPECT_FALSE(w.add_effect(dye).ok());
  EXPECT_FALSE(w.add_effect(twin).ok()) << "of the same name";
  EXPECT_TRUE(w.particle_values(twin, 0).empty());
  EXPECT_TRUE(w.particle_values(dye, 2).empty());
  const std::vector<double> few(5, 1.0), nan(27, std::nan("")), fine(27, 0.25);
  EXPECT_FALSE(w.set_particle_values(dye, 0, few).ok());
  EXPECT_FALSE(w.set_particle_values(dye, 0, nan).ok());
  ASSERT_TRUE(w.set_particle_values(dye, 0, fine).ok());
  EXPECT_EQ(sum(w.particle_values(dye, 0)), 27 * 0.25);
  ASSERT_TRUE(w.add_effect(broken).ok());
  const StepReport& r = w.step(1e-3);
  EXPECT_EQ(r.alive, 27u);
  ASSERT_EQ(r.messages.size(), 1u);
  EXPECT_NE(r.messages[0].find("broken gave 27 particles"), std::string::npos) << r.messages[0];
  w.remove_effect(broken);
  Field huge("huge", Vec3(0, 1e300, 0));
  ASSERT_TRUE(w.add_effect(huge).ok());
  EXPECT_EQ(w.step(1e-3).alive, 27u);
  ASSERT_EQ(r.messages.size(), 1u);
  EXPECT_NE(r.messages[0].find("above 1e15"), std::string::npos) << r.messages[0];
  w.remove_effect(dye);
  EXPECT_TRUE(w.particle_values(dye, 0).empty());
  ASSERT_TRUE(w.add_effect(twin).ok());
  EXPECT_EQ(sum(w.particle_values(twin, 0)), 27) << "starts anew";
}

}  // namespace
}  // namespace oilskin
