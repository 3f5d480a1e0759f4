// Emitters that their owner moves, turns, stops and changes while they run.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/emission/emission.h"
#include "fluid/kernels.h"
#include "support/random.h"

namespace oilskin::fluid {
namespace {

using test::Random;

constexpr double dx = 0.005, rho = 1000, mass = rho * dx * dx * dx;

DiscEmitter jet(double radius = 3.3 * dx, double speed = 2) {
  DiscEmitter e;
  e.center = Vec3(0.1, 0.2, 0.3);
  e.direction = Vec3(0, -1, 0);
  e.radius = radius;
  e.speed = speed;
  return e;
}

/// An emission with one emitter, and the steps of a world around it.
struct Steps {
  template <class Emitter>
  explicit Steps(const Emitter& emitter) {
    const Status s = emission.add(emitter, nullptr, &id);
    EXPECT_TRUE(s.ok()) << s.message;
  }

  /// One step of `intervals` fluid sub-steps. `times` are those of the starts.
  std::vector<Start> step(double dt, int intervals = 1) {
    std::vector<Start> found;
    times.clear();
    emission.checkpoint();
    emission.begin_step(time, dt);
    for (int k = 0; k < intervals; ++k) {
      const double part = dt / intervals, begin = time + k * part;
      for (const Start& s : emission.due(begin, part)) {
        found.push_back(s);
        times.push_back(begin + part - s.remaining);
      }
      emission.settle(std::vector<Outcome>(emission.due_count(), Outcome::emitted));
    }
    time += dt;
    emission.commit(time);
    return found;
  }
  Status move(const Vec3& center, const Vec3& direction, bool jumps = false, double duration = 0) {
    return emission.aim(id, center, direction, {time, duration, jumps});
  }
  double speed() const { return emission.state(id)->speed; }

  Emission emission{dx, rho, mass};
  std::uint64_t id = 0;
  double time = 0;
  std::vector<double> times;
};

TEST(MovingEmitter, the_flow_is_what_is_asked_while_a_nozzle_moves_turns_stops_and_changes_its_speed) {
  for (const double radius : {0.6 * dx, 1.4 * dx, 3.3 * dx, 5 * dx}) {
    Steps run(jet(radius));
    Random random(7);
    double asked = 0;  // ∫ v dt while it runs [m]
    std::uint64_t starts = 0;
    bool enabled = true;
    for (int frame = 0; frame < 3000; ++frame) {
      ASSERT_TRUE(run.move(random.in_cube(0.3), random.direction()).ok());
      if (random.below(4) == 0) enabled = !enabled;
      ASSERT_TRUE(run.emission.set_enabled(run.id, enabled, run.time).ok());
      ASSERT_TRUE(
          run.emission.set_speed(run.id, random.below(9) == 0 ? 0 : random.uniform(0, 4), run.time).ok());
      const double dt = random.uniform(1e-4, 2e-2);
      asked += enabled ? run.speed() * dt : 0;
      starts += run.step(dt, 1 + static_cast<int>(random.below(3))).size();
    }
    EXPECT_NEAR(static_cast<double>(starts) * mass / (rho * pi * radius * radius * asked), 1, 0.005);
    EXPECT_EQ(run.emission.state(run.id)->particles, starts);
    EXPECT_NEAR(run.emission.state(run.id)->volume, static_cast<double>(starts) * mass / rho, 1e-12);
  }
}

TEST(MovingEmitter, a_layer_starts_where_the_nozzle_is_at_its_time) {
  const DiscEmitter e = jet(dx, 2);  // 4 sites
  Steps run(e), at_rest(e);
  const Vec3 motion(3, 0.4, -1);
  for (int step = 0; step < 12; ++step) {
    const double dt = step % 2 == 0 ? 0.02 : 0.007;
    ASSERT_TRUE(run.move(e.center + (run.time + dt) * motion, e.direction).ok());
    const std::vector<Start> starts = run.step(dt, 1 + step % 3), resting = at_rest.step(dt, 1 + step % 3);
    ASSERT_EQ(starts.size(), resting.size());
    for (std::size_t k = 0; k < starts.size(); ++k) {
      EXPECT_EQ(starts[k].remaining, resting[k].remaining) << "the phase does not change";
      EXPECT_LT((starts[k].position - resting[k].position - run.times[k] * motion).norm(), 1e-12);
    }
  }
}

TEST(MovingEmitter, a_turn_goes_through_all_directions_between_and_keeps_the_centre) {
  const DiscEmitter e = jet(dx, 2);
  Steps run(e);
  ASSERT_TRUE(run.move(e.center, Vec3(1, 0, 0)).ok());
  const double dt = 0.1;
  const std::vector<Start> starts = run.step(dt);
  ASSERT_GT(starts.size(), 100u);
  for (std::size_t k = 0; k < starts.size(); k += 4) {
    const double angle = 0.5 * pi * run.times[k] / dt;
    const Vec3 axis(std::sin(angle), -std::cos(angle), 0);
    EXPECT_LT((starts[k].velocity - 2 * axis).norm(), 1e-12);
    Vec3 middle = Vec3::Zero();
    for (std::size_t j = k; j < k + 4; ++j) middle += 0.25 * (starts[j].position - e.center);
    EXPECT_LT(middle.norm(), 1e-12);
    EXPECT_NEAR((starts[k].position - e.center).dot(axis), 0, 1e-12);
  }
}

/// Also where the nozzle overtakes water that it has let out.
TEST(MovingEmitter, layers_are_a_spacing_apart_however_fast_the_nozzle_moves) {
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const DiscEmitter e = jet(random.uniform(0.6, 5) * dx, 2);
    Steps run(e);
    const Vec3 motion = random.uniform(0, 6) * random.direction();
    const Vec3 inherited = k % 2 == 0 ? Vec3(Vec3::Zero()) : Vec3(random.in_cube(2));
    ASSERT_TRUE(run.emission.set_inherited_velocity(run.id, inherited).ok());
    const Vec3 axis = e.direction.normalized();
    double last_time = -1;
    Vec3 last_place = Vec3::Zero(), last_velocity = Vec3::Zero();
    for (int step = 0; step < 5; ++step) {
      ASSERT_TRUE(run.move(e.center + (run.time + 0.01) * motion, axis).ok());
      const std::vector<Start> starts = run.step(0.01, 2);
      for (std::size_t i = 0; i < starts.size(); ++i) {
        if (run.times[i] <= last_time) continue;
        const Vec3 before = last_place + (run.times[i] - last_time) * last_velocity;
        const double apart = (before - starts[i].position).dot(axis);
        EXPECT_TRUE(last_time < 0 || apart >= dx * (1 - 1e-9)) << apart / dx;
        last_time = run.times[i] + 1e-12;
        last_place = starts[i].position;
        last_velocity = starts[i].velocity;
      }
    }
    EXPECT_GT(last_time, 0.03);
  }
}

TEST(MovingEmitter, a_motion_may_take_several_steps) {
  const DiscEmitter e = jet(dx, 2);
  Steps run(e);
  const Vec3 motion(0.5, 0, 0);
  ASSERT_TRUE(run.move(e.center + 0.03 * motion, e.direction, false, 0.03).ok());
  for (int step = 0; step < 6; ++step)
    for (const Start& s : run.step(0.01)) {
      const double t = run.time - s.remaining;
      EXPECT_NEAR(s.position.x(), 0.1 + 0.5 * std::min(t, 0.03), dx) << t;
    }
  EXPECT_EQ(run.emission.state(run.id)->pose.position.x(), e.center.x() + 0.03 * 0.5);
  // Another target on the way: the nozzle goes there from where it is.
  ASSERT_TRUE(run.move(e.center, e.direction, false, 0.04).ok());
  run.step(0.02);
  ASSERT_TRUE(run.move(Vec3(0.1, 0.2, 0.8), e.direction, false, 0.02).ok());
  for (const Start& s : run.step(0.01)) {
    EXPECT_NEAR(s.position.x(), 0.1 + 0.0075 * (1 - (0.01 - s.remaining) / 0.02), dx);
    EXPECT_NEAR(s.position.z(), 0.3 + 0.5 * (0.01 - s.remaining) / 0.02, dx);
  }
}

TEST(MovingEmitter, a_jump_lets_nothing_out_on_the_way_and_keeps_the_phase) {
  const DiscEmitter e = jet(dx, 2);
  Steps run(e), at_rest(e);
  run.step(0.0123);
  at_rest.step(0.0123);
  const Vec3 far = e.center + Vec3(5, 1, -3);
  ASSERT_TRUE(run.move(far, e.direction, true).ok());
  const std::vector<Start> starts = run.step(0.05), resting = at_rest.step(0.05);
  ASSERT_EQ(starts.size(), resting.size());
  for (std::size_t k = 0; k < starts.size(); ++k) {
    EXPECT_EQ(starts[k].remaining, resting[k].remaining);
    EXPECT_LT((starts[k].position - far).norm(), 1.1 * dx);
    EXPECT_EQ(starts[k].velocity, resting[k].velocity) << "a jump is no motion";
  }
}

TEST(MovingEmitter, a_pause_keeps_the_phase) {
  const DiscEmitter e = jet(dx, 1);
  Steps run(e);
  const double period = 4 * mass / (rho * pi * dx * dx);
  ASSERT_EQ(run.step(0.4 * period).size(), 4u);
  ASSERT_TRUE(run.emission.set_enabled(run.id, false, run.time).ok());
  EXPECT_EQ(run.emission.fastest_due(run.time, 1), 0);
  EXPECT_TRUE(run.step(10.7 * period).empty());
  ASSERT_TRUE(run.emission.set_enabled(run.id, true, run.time).ok());
  const double again = run.time;
  ASSERT_EQ(run.step(0.61 * period).size(), 4u);
  EXPECT_NEAR(run.times[0], again + 0.6 * period, 1e-12);
  ASSERT_TRUE(run.emission.set_speed(run.id, 2, run.time).ok());  // 0.99 periods are left, of half the length
  const double faster = run.time;
  ASSERT_EQ(run.step(0.5 * period).size(), 4u);
  EXPECT_NEAR(run.times[0], faster + 0.5 * 0.99 * period, 1e-12);
}

TEST(MovingEmitter, rain_follows_its_rate_and_its_place) {
  RainEmitter rain;
  rain.corner = Vec3(-1, 0, -1);
  rain.edge_u = Vec3(2, 0, 0);
  rain.edge_v = Vec3(0, 0, 2);
  rain.drops_per_second = 500;
  Steps run(rain);
  Random random(5);
  double asked = 0;
  std::size_t drops = 0;
  for (int frame = 0; frame < 500; ++frame) {
    const double rate = random.uniform(1, 2000), dt = 0.01;
    ASSERT_TRUE(run.emission.set_drops_per_second(run.id, rate, run.time).ok());
    const bool enabled = frame % 5 != 2;
    ASSERT_TRUE(run.emission.set_enabled(run.id, enabled, run.time).ok());
    const Vec3 middle(10 * run.time, 3, 0);
    ASSERT_TRUE(run.emission.move(run.id, {middle + Vec3(0.1, 0, 0), Rotation::Identity()}, {run.time}).ok());
    const std::vector<Start> starts = run.step(dt);
    asked += enabled ? rate * dt : 0;
    drops += starts.size();
    if (frame == 0) continue;  // it came from elsewhere
    for (std::size_t k = 0; k < starts.size(); ++k) {
      EXPECT_NEAR(starts[k].position.y(), 3, 1e-12);
      EXPECT_LE(std::abs(starts[k].position.x() - 10 * run.times[k]), 1 + 1e-9);
    }
  }
  EXPECT_NEAR(static_cast<double>(drops), asked, 2);
}

std::vector<std::uint8_t> bytes_of(Emission& emission, double time) {
  std::vector<std::uint8_t> bytes;
  Archive archive(bytes);
  emission.visit(archive, time);
  return bytes;
}

TEST(MovingEmitter, a_volume_is_filled_where_it_is_when_it_is_enabled) {
  BoxEmitter box;
  box.box = {Vec3::Zero(), Vec3(8, 4, 2) * dx};
  box.velocity = Vec3(1, 0, 0);
  Steps run(box);
  ASSERT_TRUE(run.emission.set_enabled(run.id, false, 0).ok());
  EXPECT_TRUE(run.step(0.1).empty());
  EmitterPose pose;
  pose.position = Vec3(1, 2, 3);
  pose.rotation = Rotation(Eigen::AngleAxisd(0.5 * pi, Vec3::UnitZ()));
  ASSERT_TRUE(run.emission.move(run.id, pose, {run.time, 0, true}).ok());
  ASSERT_TRUE(run.emission.set_speed(run.id, 3, run.time).ok());
  ASSERT_TRUE(run.emission.set_inherited_velocity(run.id, Vec3(0, 0, 0.5)).ok());
  ASSERT_TRUE(run.emission.set_enabled(run.id, true, run.time).ok());
  const std::vector<std::uint8_t> bytes = bytes_of(run.emission, run.time);
  Steps other(box);
  Archive archive(Span<const std::uint8_t>{bytes});
  other.emission.visit(archive, run.time);
  EXPECT_TRUE(archive.ok()) << archive.status().message;
  const std::vector<Start> starts = run.step(0.1);
  ASSERT_EQ(starts.size(), 64u);
  const Box turned = {pose.position - Vec3(2, 4, 1) * dx, pose.position + Vec3(2, 4, 1) * dx};
  for (const Start& s : starts) {
    EXPECT_TRUE(turned.inflated(-0.49 * dx).contains(s.position));
    EXPECT_LT((s.velocity - Vec3(0, 3, 0.5)).norm(), 1e-12);
    EXPECT_EQ(s.remaining, 0.1);
  }
  const EmitterState state = *run.emission.state(run.id);
  EXPECT_TRUE(state.ended);
  EXPECT_EQ(state.particles, 64u);
  EXPECT_TRUE(run.emission.remove(run.id));
  EXPECT_FALSE(run.emission.remove(run.id));
  EXPECT_FALSE(run.emission.state(run.id));
}

TEST(MovingEmitter, ended_emitters_are_forgotten) {
  Steps run(jet());
  const std::size_t before = bytes_of(run.emission, 0).size();
  for (int frame = 0; frame < 50; ++frame) {
    DiscEmitter shot = jet();
    shot.start = run.time;
    shot.stop = run.time + 0.005;
    ASSERT_TRUE(run.emission.add(shot).ok());
    BoxEmitter drop;
    drop.box = {Vec3::Zero(), Vec3::Constant(2 * dx)};
    std::uint64_t id = 0;
    ASSERT_TRUE(run.emission.add(drop, nullptr, &id).ok());
    EXPECT_GE(run.step(0.01).size(), 8u);
    EXPECT_EQ(run.emission.state(id)->particles, 8u) << "a handle keeps the number";
    EXPECT_TRUE(run.emission.set_enabled(id, false, run.time).ok()) << "without effect";
    EXPECT_TRUE(run.emission.remove(id));
    EXPECT_EQ(bytes_of(run.emission, run.time).size(), before);
  }
}

TEST(MovingEmitter, roll_back_and_saved_bytes_keep_a_motion_under_way) {
  Steps run(jet(dx, 2));
  ASSERT_TRUE(run.move(Vec3(0.3, 0.2, 0.1), Vec3(1, 1, 0), false, 0.05).ok());
  run.step(0.013);
  ASSERT_TRUE(run.emission.set_speed(run.id, 1.3, run.time).ok());
  const std::vector<std::uint8_t> bytes = bytes_of(run.emission, run.time);
  run.emission.checkpoint();
  run.emission.begin_step(run.time, 0.02);
  ASSERT_GT(run.emission.due(run.time, 0.02).size(), 0u);
  run.emission.settle(std::vector<Outcome>(run.emission.due_count(), Outcome::emitted));
  run.emission.roll_back();
  EXPECT_EQ(bytes_of(run.emission, run.time), bytes);
  Steps other(jet());
  Archive archive(Span<const std::uint8_t>{bytes});
  other.emission.visit(archive, run.time);
  ASSERT_TRUE(archive.ok()) << archive.status().message;
  other.time = run.time;
  for (int k = 0; k < 5; ++k) {
    const std::vector<Start> a = run.step(0.017, 2), b = other.step(0.017, 2);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].position, b[i].position);
  }
}

TEST(MovingEmitter, refuses_what_makes_no_sense_and_changes_nothing) {
  Steps run(jet());
  BoxEmitter box;
  box.box = {Vec3::Zero(), Vec3::Constant(2 * dx)};
  box.start = 1;
  std::uint64_t volume = 0;
  ASSERT_TRUE(run.emission.add(box, nullptr, &volume).ok());
  const std::vector<std::uint8_t> before = bytes_of(run.emission, 0);
  const auto refused = [&](const Status& s, const char* word) {
    EXPECT_NE(s.message.find(word), std::string::npos) << s.message;
    EXPECT_EQ(bytes_of(run.emission, 0), before);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused(run.move(Vec3(nan, 0, 0), Vec3(1, 0, 0)), "position");
  refused(run.move(Vec3::Zero(), Vec3::Zero()), "direction");
  refused(run.move(Vec3::Zero(), Vec3(0, nan, 0)), "direction");
  refused(run.move(Vec3::Zero(), Vec3(1, 0, 0), false, -1), "duration");
  EmitterPose flat;
  flat.rotation.coeffs().setZero();
  refused(run.emission.move(run.id, flat, {}), "rotation");
  std::uint64_t none = 0;
  refused(run.emission.add(jet(), &flat, &none), "rotation");
  refused(run.emission.aim(volume, Vec3::Zero(), Vec3(1, 0, 0), {}), "no nozzle");
  refused(run.emission.set_speed(run.id, -1, 0), "speed");
  refused(run.emission.set_speed(run.id, nan, 0), "speed");
  refused(run.emission.set_speed(run.id, 1e200, 0), "layers per second");
  refused(run.emission.set_speed(volume, 1, 0), "no direction");
  refused(run.emission.set_drops_per_second(run.id, 10, 0), "no rain");
  refused(run.emission.set_inherited_velocity(run.id, Vec3(0, nan, 0)), "inherited");
  refused(run.emission.set_enabled(99, true, 0), "no emitter 99");
  EXPECT_FALSE(run.emission.remove(99));
}

}  // namespace
}  // namespace oilskin::fluid
