// Emitters of scenes that move as prescribed, and whose water ends by age: on every host.
#include <gtest/gtest.h>

#include <cmath>

#include "hosts/bullet_simulation.h"

namespace oilskin::demo {
namespace {

constexpr double pi = 3.14159265358979323846;

Scene nozzle_scene(HostKind host) {
  Scene s;
  s.host = host;
  s.dt = 0.002;
  s.world.gravity = Vec3::Zero();
  s.fluid.spacing = 0.01;
  DiscEmitter nozzle;
  nozzle.center = Vec3(0.3, 0.5, 0);
  nozzle.radius = 0.025;
  nozzle.speed = 2;
  s.emitters.emplace_back(nozzle);
  return s;
}

class EmitterScenes : public ::testing::TestWithParam<HostKind> {
 protected:
  std::unique_ptr<Simulation> run(const Scene& scene, int steps) {
    SimulationOptions options;
    options.threads = 1;
    auto simulation = make_simulation(scene, options);
    for (int k = 0; k < steps; ++k) {
      const StepReport& r = simulation->step(scene.dt);
      EXPECT_TRUE(r.status.ok()) << r.status.message;
      by_age_ += r.removed_by_age;
    }
    return simulation;
  }
  Scene scene_ = nozzle_scene(GetParam());
  std::uint64_t by_age_ = 0;
};

/// The number of particles that a nozzle is asked for in a time [s].
double asked(const Scene& scene, const World& world, double seconds) {
  const auto& nozzle = std::get<DiscEmitter>(scene.emitters[0].shape);
  return scene.fluid.rest_density * pi * nozzle.radius * nozzle.radius * nozzle.speed * seconds /
         world.particle_mass();
}

TEST_P(EmitterScenes, a_nozzle_that_is_carried_gives_its_velocity_to_the_water_if_asked) {
  scene_.emitters[0].motion.velocity = Vec3(1, 0, 0.5);
  for (const bool inherits : {true, false}) {
    scene_.emitters[0].inherits_motion = inherits;
    const auto simulation = run(scene_, 50);
    const World& world = simulation->world();
    EXPECT_LT((simulation->nozzles()[0].center - Vec3(0.4, 0.5, 0.05)).norm(), 1e-6);
    const double layer = asked(scene_, world, scene_.fluid.spacing / 2);
    EXPECT_NEAR(double(world.particle_count()), asked(scene_, world, 0.1), 1.01 * layer);
    Vec3 mean = Vec3::Zero();
    for (const Vec3& v : world.velocities()) mean += v / double(world.particle_count());
    EXPECT_LT((mean - (inherits ? Vec3(1, -2, 0.5) : Vec3(0, -2, 0))).norm(), 0.05) << mean.transpose();
    for (const Vec3& x :
         world.positions()) {  // all of it is on the way: the jet stays below its nozzle, or trails
      const double age = (0.5 - x.y()) / 2;
      const Vec3 start = Vec3(0.3, 0.5, 0) + (inherits ? 0.1 : 0.1 - age) * Vec3(1, 0, 0.5);
      EXPECT_LT(Vec3(x.x() - start.x(), 0, x.z() - start.z()).norm(), 0.03);
    }
  }
}

TEST_P(EmitterScenes, a_nozzle_turns_about_its_axis_from_start_to_stop_and_rests_then) {
  scene_.fluid.xsph_rate = 0;  // or water that left earlier brakes it
  Motion& motion = scene_.emitters[0].motion;
  motion.spin_axis = Vec3(0, 0, 2);
  motion.spin_rate = 0.5 * pi / 0.04;
  motion.start = 0.01;
  motion.stop = 0.05;
  const auto simulation = run(scene_, 40);
  const Nozzle nozzle = simulation->nozzles()[0];
  EXPECT_LT((nozzle.center - Vec3(-0.5, 0.3, 0)).norm(), 1e-6) << "a quarter turn about the z axis";
  EXPECT_LT((nozzle.direction - Vec3(1, 0, 0)).norm(), 1e-6);
  const World& world = simulation->world();
  int near = 0;  // of what started in the last 0.02 s
  for (std::size_t i = 0; i < world.particle_count(); ++i) {
    const double along = world.positions()[i].x() + 0.5;
    if (along < 0 || along > 0.04 || std::abs(world.positions()[i].y() - 0.3) > 0.03) continue;
    ++near;
    EXPECT_LT((world.velocities()[i] - Vec3(2, 0, 0)).norm(), 0.3) << "it inherits nothing any more";
  }
  EXPECT_GT(near, 50);
}

TEST_P(EmitterScenes, water_ends_at_the_age_of_its_emitter) {
  scene_.emitters[0].max_age = 0.03;
  FilledBox block;
  block.box = {Vec3(-0.5, 0, 0), Vec3(-0.45, 0.05, 0.05)};
  scene_.emitters.emplace_back(block);
  const auto simulation = run(scene_, 50);
  const World& world = simulation->world();
  const double layer = asked(scene_, world, scene_.fluid.spacing / 2);
  EXPECT_NEAR(double(world.particle_count()) - 125, asked(scene_, world, 0.03), 2 * layer);
  EXPECT_GT(double(by_age_), asked(scene_, world, 0.06));
  EXPECT_TRUE(std::isinf(world.max_age())) << "the block has no limit";
}

TEST_P(EmitterScenes, a_volume_is_filled_where_its_motion_has_brought_it) {
  FilledBox block;
  block.box = {Vec3(0, 0, 0), Vec3(0.05, 0.05, 0.05)};
  block.velocity = Vec3(0, 1, 0);
  block.start = 0.02;
  Emitter moving = block;
  moving.motion.velocity = Vec3(10, 0, 0);
  scene_.emitters = {moving};
  const auto simulation = run(scene_, 11);
  const World& world = simulation->world();
  EXPECT_EQ(world.particle_count(), 125u);
  Vec3 middle = Vec3::Zero(), velocity = Vec3::Zero();
  for (std::size_t i = 0; i < world.particle_count(); ++i) {
    middle += world.positions()[i] / 125;
    velocity += world.velocities()[i] / 125;
  }
  EXPECT_NEAR(middle.x(), 0.025 + 10 * 0.022, 0.011);
  EXPECT_LT((velocity - Vec3(10, 1, 0)).norm(), 1e-4);
}

TEST_P(EmitterScenes, a_nozzle_that_the_scene_moves_cannot_be_aimed) {
  scene_.emitters.push_back(scene_.emitters[0]);
  std::get<DiscEmitter>(scene_.emitters[1].shape).center.x() = 0.6;
  scene_.emitters[0].motion.velocity = Vec3(0, 0, 1);
  const auto simulation = run(scene_, 1);
  EXPECT_EQ(simulation->aim_nozzle(0, Vec3(1, 0, 0)).message, "nozzle 0 moves as the scene prescribes");
  EXPECT_TRUE(simulation->aim_nozzle(1, Vec3(1, 0, 0)).ok());
  EXPECT_EQ(simulation->aim_nozzle(2, Vec3(1, 0, 0)).message, "there is no nozzle 2");
}

INSTANTIATE_TEST_SUITE_P(Hosts, EmitterScenes, ::testing::Values(HostKind::bullet, HostKind::mock),
                         [](const auto& host) {
                           return std::string(host.param == HostKind::mock ? "mock" : "bullet");
                         });

}  // namespace
}  // namespace oilskin::demo
