// Worlds, meshes and contact solvers on the threads of a host.
#include <gtest/gtest.h>

#include <stdexcept>

#include "oilskin/contact.h"
#include "oilskin/reconstruction.h"
#include "support/busy_scene.h"
#include "support/mock_jobs.h"

namespace oilskin {
namespace {

using test::JobsInUse;
using test::MockJobs;
using Scene = test::BusyScene<float>;

const std::vector<MockJobs::How>& orders() {
  static const std::vector<MockJobs::How> all = {test::in_reverse(), test::shuffled(), test::on_threads(3),
                                                 test::in_halves()};
  return all;
}

std::unique_ptr<Scene> make_scene(int threads) {
  FluidSettings fluid;
  fluid.occlusion = true;
  fluid.max_substeps = 3;
  auto scene = std::make_unique<Scene>(test::busy_world(threads), fluid);
  scene->add_emitters();
  test::add_block(scene->world, 12, Vec3(-0.03, 0.07, -0.03), Vec3(0, -2, 0));
  EXPECT_TRUE(scene->ok);
  return scene;
}

std::vector<std::uint64_t> run(Scene& scene, int steps) {
  std::vector<std::uint64_t> hashes;
  for (int k = 0; k < steps; ++k) {
    EXPECT_TRUE(scene.step(k).status.ok());
    hashes.push_back(scene.world.state_hash());
  }
  return hashes;
}

std::vector<std::uint8_t> save(const World& world) {
  std::vector<std::uint8_t> bytes;
  EXPECT_TRUE(world.save(&bytes).ok());
  return bytes;
}

TEST(JobSystem, no_order_and_no_number_of_threads_changes_a_bit_of_a_world) {
  const std::vector<std::uint64_t> serial = run(*make_scene(1), 15);
  for (const auto& how : orders()) {
    MockJobs jobs(how);
    const JobsInUse use(jobs);
    EXPECT_EQ(run(*make_scene(0), 15), serial);
    EXPECT_GT(jobs.loops, 500);
    EXPECT_EQ(jobs.most_at_once, 1) << "a task starts no loop";
  }
}

TEST(JobSystem, no_order_changes_a_bit_of_a_water_mesh) {
  const auto scene = make_scene(1);
  run(*scene, 5);
  ReconstructionInput input;
  input.positions = scene->world.positions();
  ReconstructionOptions options;
  options.spacing = scene->world.fluid_settings().spacing;
  options.threads = 1;
  WaterMesh serial;
  ASSERT_TRUE(reconstruct_surface(input, options, &serial).ok());
  for (const auto& how : orders()) {
    MockJobs jobs(how);
    const JobsInUse use(jobs);
    options.threads = 0;
    WaterMesh mesh;
    ASSERT_TRUE(reconstruct_surface(input, options, &mesh).ok());
    EXPECT_GT(jobs.loops, 10);
    EXPECT_TRUE(mesh.positions == serial.positions);
    EXPECT_TRUE(mesh.triangles == serial.triangles);
  }
}

/// Gives out the loops in halves, and throws in one of them between the halves.
struct Thrower {
  int loops_left = 0;  // 0 = does not throw
  void run(int count, const LoopTasks& tasks) {
    tasks(0, count / 2);
    if (loops_left > 0 && --loops_left == 0) throw std::runtime_error("out of threads");
    tasks(count / 2, count);
  }
};

TEST(JobSystem, one_that_throws_in_any_loop_leaves_the_world_as_it_was) {
  const auto plain = make_scene(1);
  Thrower thrower;
  MockJobs jobs([&](int count, const LoopTasks& tasks) { thrower.run(count, tasks); });
  const JobsInUse use(jobs);
  const auto failing = make_scene(0);
  ASSERT_EQ(run(*failing, 6), run(*plain, 6));
  const auto before = save(failing->world);
  const auto hosts = failing->host_state();
  int failures = 0;
  for (bool failed = true; failed && !HasFailure();) {
    thrower.loops_left = ++failures;
    try {
      failing->step(6);
      failed = false;
    } catch (const std::runtime_error& e) {
      EXPECT_STREQ(e.what(), "out of threads");
      EXPECT_TRUE(save(failing->world) == before) << "loop " << failures;
      failing->set_host_state(hosts);
    }
  }
  thrower.loops_left = 0;
  EXPECT_GT(failures, 30);
  plain->step(6);
  EXPECT_TRUE(save(failing->world) == save(plain->world));
}

TEST(JobSystem, one_that_leaves_tasks_out_is_named_and_leaves_the_world_as_it_was) {
  bool leaves_out = false;
  MockJobs jobs([&](int count, const LoopTasks& tasks) { tasks(leaves_out ? 1 : 0, count); });
  const JobsInUse use(jobs);
  const auto scene = make_scene(0);
  run(*scene, 2);
  const auto before = save(scene->world);
  leaves_out = true;
  try {
    scene->step(2);
    ADD_FAILURE() << "no exception";
  } catch (const std::runtime_error& e) {
    EXPECT_EQ(std::string(e.what()).rfind("JobSystem::run() did ", 0), 0u) << e.what();
  }
  EXPECT_TRUE(save(scene->world) == before);
}

// A game steps its worlds in tasks of its own, on the job system that the worlds use.
TEST(JobSystem, worlds_that_are_stepped_within_tasks_have_the_same_bits) {
  const std::vector<std::uint64_t> serial = run(*make_scene(1), 8);
  MockJobs jobs(test::on_threads(2));
  const JobsInUse use(jobs);
  const std::unique_ptr<Scene> scenes[] = {make_scene(0), make_scene(0), make_scene(0)};
  std::vector<std::uint64_t> hashes[3];
  const LoopTasks::Function step_world = [](void* context, int begin, int end) {
    for (int i = begin; i < end; ++i) (*static_cast<std::function<void(int)>*>(context))(i);
  };
  std::function<void(int)> body = [&](int i) { hashes[i] = run(*scenes[i], 8); };
  jobs.run(3, LoopTasks(step_world, &body));
  for (const auto& each : hashes) EXPECT_EQ(each, serial);
  EXPECT_GT(jobs.most_at_once, 1);
}

TEST(JobSystem, a_world_that_is_restored_keeps_its_own) {
  const auto scene = make_scene(1);
  run(*scene, 3);
  const auto saved = save(scene->world);
  MockJobs jobs(test::in_reverse());
  {
    const JobsInUse use(jobs);
    ASSERT_TRUE(scene->world.restore(saved).ok());
  }
  run(*scene, 3);
  EXPECT_EQ(jobs.loops, 0);
}

}  // namespace
}  // namespace oilskin
