// Sinks, and particles that end by age.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "support/random.h"
#include "support/world_helpers.h"
#include "world/saved_bytes.h"

namespace oilskin::test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

WorldSettings room(int threads = 1) {
  WorldSettings s;
  s.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
  s.threads = threads;
  return s;
}

Region lower_half() {
  return box_region({Vec3(-2, -2, -2), Vec3(2, -0.05, 2)});
}

DiscEmitter nozzle() {
  DiscEmitter e;
  e.radius = 0.0173;
  e.speed = 2;
  return e;
}

/// A jet that falls into a sink.
struct Drain {
  explicit Drain(int threads = 1) : world(room(threads)) {
    EXPECT_TRUE(world.add_emitter(nozzle(), &jet).ok());
    EXPECT_TRUE(world.add_sink(lower_half(), &sink).ok());
  }
  World world;
  EmitterId jet;
  SinkId sink;
};

TEST(Sinks, a_step_with_a_sink_is_a_step_and_a_removal) {
  FluidSettings fluid;
  fluid.max_substeps = 1;
  World with(room(), fluid), without(room(), fluid);
  for (World* w : {&with, &without}) ASSERT_TRUE(w->add_emitter(nozzle()).ok());
  SinkId id;
  ASSERT_TRUE(with.add_sink(lower_half(), &id).ok());
  std::uint64_t removed = 0;
  for (int k = 0; k < 60; ++k) {
    ASSERT_TRUE(with.step(2e-3).status.ok());
    ASSERT_TRUE(without.step(2e-3).status.ok());
    std::uint64_t count = 0;
    ASSERT_TRUE(without.remove_particles(*lower_half().box, &count).ok());
    EXPECT_EQ(with.report().removed_by_sinks, count);
    EXPECT_EQ(with.report().removed, count);
    removed += count;
    ASSERT_EQ(with.state_hash(), without.state_hash()) << "step " << k;
  }
  EXPECT_GT(removed, 100u);
  const std::optional<SinkState> state = with.sink(id);
  ASSERT_TRUE(state.has_value());
  EXPECT_EQ(state->particles, removed);
  EXPECT_NEAR(state->volume, static_cast<double>(removed) * with.particle_mass() / 1000, 1e-15);
}

TEST(Sinks, every_ledger_counts_what_they_take) {
  Drain d;
  StepReport all;
  for (int k = 0; k < 100; ++k) {
    const StepReport& r = d.world.step(4e-3);
    EXPECT_LT(r.momentum_residual().norm(), 1e-12);
    all.add(r);
  }
  EXPECT_GT(all.removed_by_sinks, 500u);
  EXPECT_EQ(all.removed, all.removed_by_sinks);
  EXPECT_EQ(all.emitted, all.alive + all.removed);
  EXPECT_NEAR(all.mass_emitted, d.world.fluid_mass() + all.mass_removed, 1e-12);
  const EnergyReport& e = d.world.report().energy;
  EXPECT_GT(e.left_kinetic, 0);
  // Of a jet in free fall nothing is made but what pressure dissipates.
  EXPECT_LT(std::abs(e.made), 0.02 * e.entered_kinetic);
}

TEST(Sinks, the_first_that_contains_a_particle_takes_it) {
  World w(room());
  SinkId first, second, off;
  const Region ball = ball_region(Vec3(0, 0, 0), 0.1), box = box_region({Vec3::Zero(), Vec3::Constant(0.5)});
  ASSERT_TRUE(w.add_sink(ball, &off).ok());
  ASSERT_TRUE(w.add_sink(box, &first).ok());
  ASSERT_TRUE(w.add_sink(ball, &second).ok());
  ASSERT_TRUE(w.set_sink_enabled(off, false).ok());
  const std::vector<Vec3> x = {Vec3(0.05, 0.05, 0.05), Vec3(-0.05, 0, 0), Vec3(0.3, 0.3, 0.3),
                               Vec3(-0.3, 0, 0)};
  ASSERT_TRUE(w.add_particles(x, std::vector<Vec3>(4, Vec3::Zero())).ok());
  ASSERT_TRUE(w.step(1e-4).status.ok());
  EXPECT_EQ(w.sink(off)->particles, 0u);
  EXPECT_EQ(w.sink(first)->particles, 2u);
  EXPECT_EQ(w.sink(second)->particles, 1u);
  EXPECT_EQ(w.particle_count(), 1u);
}

TEST(Sinks, can_be_moved_changed_and_removed) {
  World w(room());
  SinkId id;
  ASSERT_TRUE(w.add_sink(box_region({Vec3(-0.1, -0.01, -0.01), Vec3(0.1, 0.01, 0.01)}), &id).ok());
  const auto add = [&](const Vec3& x) {
    ASSERT_TRUE(w.add_particles(std::vector<Vec3>{x}, std::vector<Vec3>{Vec3::Zero()}).ok());
    ASSERT_TRUE(w.step(1e-5).status.ok());
  };
  add(Vec3(1, 0.09, 0));
  EXPECT_EQ(w.particle_count(), 1u);
  EmitterPose upright;  // along y, at x = 1
  upright.position = Vec3(1, 0, 0);
  upright.rotation = Rotation(Eigen::AngleAxisd(0.5 * 3.14159265358979, Vec3::UnitZ()));
  ASSERT_TRUE(w.move_sink(id, upright).ok());
  add(Vec3(1.09, 0, 0));
  EXPECT_EQ(w.particle_count(), 1u);  // the first has gone, this one is beside
  ASSERT_TRUE(w.set_sink_region(id, ball_region(Vec3(1, 0, 0), 0.1)).ok());
  add(Vec3(-1, 0, 0));
  EXPECT_EQ(w.particle_count(), 1u);
  EXPECT_EQ(w.sink(id)->particles, 2u);
  EXPECT_TRUE(w.remove_sink(id));
  EXPECT_FALSE(w.remove_sink(id));
  EXPECT_FALSE(w.sink(id).has_value());
  add(Vec3(1, 0, 0));
  EXPECT_EQ(w.particle_count(), 2u);
}

TEST(Sinks, regions_are_convex_with_their_border) {
  Region r;
  EXPECT_TRUE(r.contains(Vec3(1e9, -1e9, 0)));
  r.half_spaces = {{Vec3::Zero(), Vec3(0, 2, 0)}, {Vec3(0, -1, 0), Vec3(0, -1e-3, 0)}};
  EXPECT_TRUE(r.contains(Vec3(5, 0, 5)));
  EXPECT_TRUE(r.contains(Vec3(5, -1, 5)));
  EXPECT_FALSE(r.contains(Vec3(0, 1e-9, 0)));
  r.capsule = Capsule{Vec3(0, 0, 0), Vec3(1, 0, 0), 0.25};
  EXPECT_TRUE(r.contains(Vec3(1.25, 0, 0)));
  EXPECT_TRUE(r.contains(Vec3(0.5, -0.25, 0)));
  EXPECT_FALSE(r.contains(Vec3(1.2, -0.2, 0)));
  EXPECT_FALSE(r.contains(Vec3(0.5, 0.1, 0)));
}

TEST(Sinks, what_makes_no_sense_is_refused_in_words) {
  World w(room());
  SinkId id;
  ASSERT_TRUE(w.add_sink(lower_half(), &id).ok());
  const std::vector<std::uint8_t> before = save(w);
  const auto refuse = [&](const Region& r, const char* word) {
    for (const Status& s : {w.add_sink(r), w.set_sink_region(id, r)}) {
      EXPECT_FALSE(s.ok());
      EXPECT_NE(s.message.find(word), std::string::npos) << s.message;
    }
  };
  refuse(box_region(Box()), "box");
  refuse(box_region({Vec3(1, 0, 0), Vec3(0, 1, 1)}), "box.min");
  refuse(ball_region(Vec3::Zero(), 0), "radius");
  refuse(ball_region(Vec3(NAN, 0, 0), 1), "capsule.from");
  Region flat;
  flat.half_spaces.push_back({Vec3::Zero(), Vec3::Zero()});
  refuse(flat, "normal");
  EmitterPose scaled;
  scaled.rotation.coeffs() *= 2;
  EXPECT_NE(w.move_sink(id, scaled).message.find("rotation"), std::string::npos);
  EXPECT_NE(w.move_sink({7}, EmitterPose()).message.find("no sink 7"), std::string::npos);
  EXPECT_NE(w.set_sink_enabled({7}, true).message.find("no sink 7"), std::string::npos);
  for (double age : {0.0, -1.0, static_cast<double>(NAN)}) {
    EXPECT_NE(w.set_max_age(age).message.find("max_age"), std::string::npos);
    EXPECT_NE(w.set_emitter_max_age({1}, age).message.find("max_age"), std::string::npos);
  }
  EXPECT_NE(w.set_emitter_max_age({3}, 1).message.find("no emitter 3"), std::string::npos);
  EXPECT_EQ(save(w), before);
}

TEST(Sinks, particles_of_an_emitter_end_at_their_age) {
  World w(room());
  EmitterId jet;
  ASSERT_TRUE(w.add_emitter(nozzle(), &jet).ok());
  ASSERT_TRUE(w.set_emitter_max_age(jet, 0.05).ok());
  EXPECT_EQ(w.emitter(jet)->max_age, 0.05);
  ASSERT_TRUE(w.add_particles(std::vector<Vec3>{Vec3(1, 0, 0)}, std::vector<Vec3>{Vec3::Zero()}).ok());
  std::vector<std::uint64_t> emitted;
  std::uint64_t by_age = 0;
  for (int k = 0; k < 100; ++k) {
    const StepReport& r = w.step(1e-3);
    emitted.push_back(r.emitted);
    by_age += r.removed_by_age;
    // A particle that starts within step j ends at the end of step j + 49 or j + 50.
    std::uint64_t old = 0, very_old = 0;
    for (int j = 0; j + 49 <= k; ++j) old += emitted[static_cast<std::size_t>(j)];
    for (int j = 0; j + 50 <= k; ++j) very_old += emitted[static_cast<std::size_t>(j)];
    EXPECT_LE(by_age, old);
    EXPECT_GE(by_age, very_old);
    EXPECT_LT(r.momentum_residual().norm(), 1e-12);
  }
  EXPECT_GT(by_age, 100u);
  const Span<const Vec3> x = w.positions();
  EXPECT_EQ(std::count_if(x.begin(), x.end(), [](const Vec3& p) { return p.x() == 1; }),
            1);  // from no emitter
}

/// Ages follow their particles when the storage order changes.
TEST(Sinks, particles_of_another_emitter_live_on) {
  World w(room());
  EmitterId mortal, other;
  DiscEmitter beside = nozzle();
  beside.center.x() = 0.1;
  beside.direction = Vec3(0.2, 1, 0);
  ASSERT_TRUE(w.add_emitter(nozzle(), &mortal).ok());
  ASSERT_TRUE(w.add_emitter(beside, &other).ok());
  ASSERT_TRUE(w.set_emitter_max_age(mortal, 0.05).ok());
  std::map<std::uint64_t, int> birth;
  for (int k = 0; k < 100; ++k) {
    ASSERT_TRUE(w.step(1e-3).status.ok());
    std::uint64_t immortal = 0;
    for (std::size_t i = 0; i < w.particle_count(); ++i) {
      const int born = birth.emplace(w.ids()[i], k).first->second;
      const bool is_mortal = w.positions()[i].x() < 0.05;
      immortal += !is_mortal;
      if (is_mortal) EXPECT_LE(k - born, 50);
    }
    EXPECT_EQ(immortal, w.emitter(other)->particles);
  }
  EXPECT_LT(w.particle_count(), birth.size()) << "none has ended";
}

TEST(Sinks, all_particles_end_at_the_age_of_the_world) {
  World w(room());
  const auto add = [&](double x) {
    ASSERT_TRUE(w.add_particles(std::vector<Vec3>{Vec3(x, 0, 0)}, std::vector<Vec3>{Vec3::Zero()}).ok());
  };
  add(0);
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(w.step(0.01).status.ok());
  ASSERT_TRUE(w.set_max_age(0.05).ok());
  EXPECT_EQ(w.max_age(), 0.05);
  for (int k = 0; k < 2; ++k) ASSERT_TRUE(w.step(0.01).status.ok());
  add(1);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(w.particle_count(), 2u);
    ASSERT_TRUE(w.step(0.01).status.ok());
  }
  EXPECT_EQ(w.particle_count(), 1u);  // 0.05 s after the limit was set
  EXPECT_EQ(w.report().removed_by_age, 1u);
  ASSERT_TRUE(w.step(0.01).status.ok());
  EXPECT_EQ(w.particle_count(), 1u);
  ASSERT_TRUE(w.step(0.01).status.ok());
  EXPECT_EQ(w.particle_count(), 0u);
  ASSERT_TRUE(w.set_max_age(infinity).ok());
  add(0);
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(w.step(0.01).status.ok());
  EXPECT_EQ(w.particle_count(), 1u);
}

TEST(Sinks, do_not_depend_on_the_number_of_threads) {
  Drain one(1), four(4);
  for (Drain* d : {&one, &four}) {
    ASSERT_TRUE(d->world.set_emitter_max_age(d->jet, 0.03).ok());
    for (int k = 0; k < 40; ++k) ASSERT_TRUE(d->world.step(3e-3).status.ok());
  }
  EXPECT_EQ(one.world.state_hash(), four.world.state_hash());
  EXPECT_EQ(save(one.world), save(four.world));
}

TEST(Sinks, where_nothing_ends_no_state_changes) {
  World plain(room()), with(room());
  for (World* w : {&plain, &with}) ASSERT_TRUE(w->add_emitter(nozzle()).ok());
  SinkId off;
  ASSERT_TRUE(with.add_sink(ball_region(Vec3(1, 1, 1), 0.1)).ok());
  ASSERT_TRUE(with.add_sink(lower_half(), &off).ok());
  ASSERT_TRUE(with.set_sink_enabled(off, false).ok());
  ASSERT_TRUE(with.set_max_age(100).ok());
  for (int k = 0; k < 30; ++k) ASSERT_EQ(plain.step(3e-3).alive, with.step(3e-3).alive);
  EXPECT_EQ(plain.state_hash(), with.state_hash());
}

TEST(Sinks, are_saved_and_restored) {
  Drain a, b;
  ASSERT_TRUE(a.world.set_emitter_max_age(a.jet, 0.06).ok());
  ASSERT_TRUE(a.world.set_max_age(0.08).ok());
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(a.world.step(3e-3).status.ok());
  const Bytes bytes = save(a.world);
  ASSERT_TRUE(b.world.restore(bytes).ok());
  EXPECT_EQ(save(b.world), bytes);
  EXPECT_EQ(b.world.max_age(), 0.08);
  ASSERT_TRUE(b.world.sink(a.sink).has_value());
  EXPECT_EQ(b.world.sink(a.sink)->particles, a.world.sink(a.sink)->particles);
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(a.world.step(3e-3).status.ok());
    ASSERT_TRUE(b.world.step(3e-3).status.ok());
    ASSERT_EQ(a.world.state_hash(), b.world.state_hash());
  }
  EXPECT_GT(a.world.sink(a.sink)->particles, 0u);
  EXPECT_EQ(b.world.sink(a.sink)->particles, a.world.sink(a.sink)->particles);
}

/// Throws in the second interval of a step.
class Thrower : public IntervalObserver {
 public:
  void on_interval(const Interval&) override {
    if (++intervals == 2) throw std::runtime_error("thrown by a test");
  }
  int intervals = 0;
};

TEST(Sinks, a_failed_step_leaves_no_trace_in_them) {
  FluidSettings fluid;
  World w(room(), fluid);
  EmitterId jet;
  SinkId sink;
  ASSERT_TRUE(w.add_emitter(nozzle(), &jet).ok());
  ASSERT_TRUE(w.add_sink(lower_half(), &sink).ok());
  ASSERT_TRUE(w.set_emitter_max_age(jet, 0.04).ok());
  for (int k = 0; k < 12; ++k) ASSERT_TRUE(w.step(5e-3).status.ok());
  ASSERT_GT(w.report().substeps, 1);
  const Bytes before = save(w);
  Thrower thrower;
  w.set_observer(&thrower);
  EXPECT_THROW(w.step(5e-3), std::runtime_error);
  w.set_observer(nullptr);
  EXPECT_EQ(save(w), before);
}

}  // namespace
}  // namespace oilskin::test
