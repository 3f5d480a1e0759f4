// A step that an exception ends leaves the world as it was: allocations that fail one after the other, hosts
// and observers that throw. This program replaces operator new.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <stdexcept>

#include "support/busy_scene.h"
#include "support/particle_arrays.h"
#include "world/saved_bytes.h"

namespace {

/// Allocations until one fails; 0 = none does.
thread_local std::uint64_t allocations_left = 0;

/// Of all allocations so far.
thread_local std::uint64_t allocated_bytes = 0;

void* allocate(std::size_t size) {
  allocated_bytes += size;
  if (allocations_left > 0 && --allocations_left == 0) throw std::bad_alloc();
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) {
  return allocate(size);
}
void* operator new[](std::size_t size) {
  return allocate(size);
}
// std::stable_sort() does without the memory that it asks for in this way.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return std::malloc(size > 0 ? size : 1);
}
// FCL's arrays. Without it AddressSanitizer's own would be paired with the delete[] below.
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return std::malloc(size > 0 ? size : 1);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace oilskin {
namespace {

using test::Bytes;
using test::save;
using Scene = test::BusyScene<float>;

/// What a host or an observer throws.
struct Failure : std::runtime_error {
  Failure() : std::runtime_error("thrown by a test") {}
};

/// All that a step may change and a caller can see.
struct Snapshot {
  explicit Snapshot(const World& w)
      : bytes(save(w)),
        hash(w.state_hash()),
        particles(w.particle_count()),
        contacts(w.contacts().size()),
        steps(w.step_count()),
        reported_step(w.report().step),
        emitted(w.report().emitted),
        flags(w.report().flags),
        time(w.time()),
        suggested_dt(w.suggested_dt(1)),
        neighbour_seconds(w.report().seconds.neighbours) {}

  Bytes bytes;
  std::uint64_t hash, particles, contacts, steps, reported_step, emitted, flags;
  double time, suggested_dt, neighbour_seconds;
};

void expect_same(const Snapshot& a, const Snapshot& b) {
  EXPECT_TRUE(a.bytes == b.bytes);
  EXPECT_EQ(a.hash, b.hash);
  EXPECT_EQ(a.particles, b.particles);
  EXPECT_EQ(a.contacts, b.contacts);
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.reported_step, b.reported_step);
  EXPECT_EQ(a.emitted, b.emitted);
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.suggested_dt, b.suggested_dt);
}

void expect_unchanged(const World& w, const Snapshot& before) {
  const Snapshot after(w);
  expect_same(after, before);
  EXPECT_EQ(after.neighbour_seconds, before.neighbour_seconds);
}

/// Bytes that the fifth step of some water on the corner of a level allocates.
std::uint64_t bytes_of_a_step(std::uint32_t cells, test::StaticMesh::Changes changes, int max_substeps) {
  FluidSettings fluid;
  fluid.max_substeps = max_substeps;
  World world(test::busy_world(1), fluid);
  test::StaticMesh level;
  const double width = 0.01 * cells;
  level.add_rectangle(Vec3::Constant(-0.05), Vec3(0, 0, width), Vec3(width, 0, 0), cells, cells);
  level.changes = changes;
  EXPECT_TRUE(world.attach(level, test::sheet_settings(), nullptr).ok());
  test::add_block(world, 5, Vec3(0, -0.045, 0), Vec3(0.1, -1, 0.1));
  for (int k = 0; k < 4; ++k) EXPECT_TRUE(world.step(4e-3).status.ok());
  const std::uint64_t before = allocated_bytes;
  world.step(4e-3);
  EXPECT_GT(world.report().contact.contacts, 0u);
  EXPECT_EQ(world.report().substeps > 1, max_substeps > 1);
  return allocated_bytes - before;
}

TEST(StillSurface, a_step_copies_nothing_of_it) {
  using Changes = test::StaticMesh::Changes;
  for (int max_substeps : {1, 4}) {
    const std::uint64_t small = bytes_of_a_step(20, Changes::never, max_substeps);
    const std::uint64_t large = bytes_of_a_step(200, Changes::never, max_substeps);
    EXPECT_LT(large, small + 10000) << "the level has 80,000 triangles";
    EXPECT_GT(bytes_of_a_step(200, Changes::unknown, max_substeps), large + 1000000);
  }
}

class ThrowingObserver : public IntervalObserver {
 public:
  int calls_left = 0;  // 0 = does not throw
  void on_interval(const Interval&) override {
    if (calls_left > 0 && --calls_left == 0) throw Failure();
  }
};

struct Case {
  const char* name;
  PressureSolver solver;
  BoundaryModel boundary;
  int max_substeps;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

std::unique_ptr<Scene> make_scene(const Case& c) {
  FluidSettings fluid;
  fluid.solver = c.solver;
  fluid.boundary = c.boundary;
  fluid.max_substeps = c.max_substeps;
  fluid.max_iterations = 10;
  auto scene = std::make_unique<Scene>(test::busy_world(1), fluid);
  scene->add_emitters();
  EXPECT_TRUE(scene->ok);
  ContactSettings contact;
  contact.verify = true;
  EXPECT_TRUE(scene->world.set_contact_settings(contact).ok());
  return scene;
}

class FailingAllocations : public ::testing::TestWithParam<Case> {
 protected:
  /// Steps both worlds. In `failing` each allocation of the step fails once before; returns how many did.
  int step_both(Scene& plain, Scene& failing, int k) {
    const Snapshot before(failing.world);
    const auto hosts = failing.host_state();
    int failures = 0;
    for (std::uint64_t n = 1; !HasFailure(); ++n) {
      bool failed = false;
      try {
        allocations_left = n;
        failing.step(k);
        allocations_left = 0;
      } catch (const std::exception&) {
        allocations_left = 0;
        failed = true;
      }
      if (!failed) break;
      ++failures;
      SCOPED_TRACE("step " + std::to_string(k) + ", allocation " + std::to_string(n));
      expect_unchanged(failing.world, before);
      failing.set_host_state(hosts);
    }
    plain.step(k);
    expect_same(Snapshot(failing.world), Snapshot(plain.world));
    return failures;
  }
};

TEST_P(FailingAllocations, leave_the_world_as_it_was_and_the_next_step_gives_the_same_bits) {
  const auto plain = make_scene(GetParam()), failing = make_scene(GetParam());
  ThrowingObserver idle;
  failing->world.set_observer(&idle);
  EXPECT_GT(step_both(*plain, *failing, 0), 100) << "volumes are filled, surfaces are new";
  for (int k = 1; k < 30; ++k) {
    plain->step(k);
    failing->step(k);
  }
  EXPECT_GT(plain->world.contacts().size(), 0u);
  EXPECT_GT(step_both(*plain, *failing, 30), 100);
  for (Scene* scene : {plain.get(), failing.get()}) scene->world.reset_motion(scene->floor_id);
  EXPECT_GT(step_both(*plain, *failing, 31), 100) << "a surface gets a new id";
  for (int k = 32; k < 40; ++k) {
    plain->step(k);
    failing->step(k);
  }
  expect_same(Snapshot(failing->world), Snapshot(plain->world));
}

INSTANTIATE_TEST_SUITE_P(
    Solvers, FailingAllocations,
    ::testing::Values(Case{"mcg03", PressureSolver::mcg03, BoundaryModel::contact_only, 1},
                      Case{"pcisph_substeps", PressureSolver::pcisph, BoundaryModel::contact_only, 3},
                      Case{"dfsph_mirrored", PressureSolver::dfsph, BoundaryModel::mirrored, 1}),
    [](const auto& instance) { return std::string(instance.param.name); });

/// A wall that throws on request.
class ThrowingWall : public test::StaticMesh {
 public:
  bool throws_in_gather = false, throws_in_scatter = false;

  ThrowingWall() {
    changes = Changes::unknown;
    add_rectangle(Vec3(-0.3, -0.12, -0.3), Vec3(0.6, 0, 0), Vec3(0, 0, 0.6));
  }
  Gathered gather(double dt, SurfaceMotion& m) override {
    Gathered gathered = StaticMesh::gather(dt, m);
    m.velocity[0] = Vec3::UnitX();  // some of it is written already
    if (throws_in_gather) throw Failure();
    return gathered;
  }
  void scatter(SurfaceMotion& m) override {
    m.impulse[0] = Vec3::UnitX();
    if (throws_in_scatter) throw Failure();
  }
};

/// Two equal worlds with a wall and an observer that can throw.
class Throwing : public ::testing::Test {
 protected:
  struct Setup {
    std::unique_ptr<Scene> scene =
        make_scene({"", PressureSolver::dfsph, BoundaryModel::mirrored, /*max_substeps=*/3});
    ThrowingWall wall;
    ThrowingObserver observer;

    Setup() {
      EXPECT_TRUE(scene->world.attach(wall, test::sheet_settings(), nullptr).ok());
      scene->world.set_observer(&observer);
    }
  };

  /// The step throws Failure and changes nothing; without what made it throw it is that of the other world.
  template <class Arm, class Disarm>
  void expect_no_trace(const Arm& arm, const Disarm& disarm) {
    Setup plain, failing;
    for (int k = 0; k < 20; ++k) {
      const Snapshot before(failing.scene->world);
      const auto hosts = failing.scene->host_state();
      arm(failing);
      EXPECT_THROW(failing.scene->step(k), Failure);
      disarm(failing);
      SCOPED_TRACE("step " + std::to_string(k));
      expect_unchanged(failing.scene->world, before);
      failing.scene->set_host_state(hosts);
      plain.scene->step(k);
      failing.scene->step(k);
      expect_same(Snapshot(failing.scene->world), Snapshot(plain.scene->world));
      if (HasFailure()) return;
    }
    EXPECT_GT(plain.scene->world.particle_count(), 100u);
  }
};

TEST_F(Throwing, a_host_in_gather_leaves_no_trace) {
  expect_no_trace([](Setup& s) { s.wall.throws_in_gather = true; },
                  [](Setup& s) { s.wall.throws_in_gather = false; });
}

TEST_F(Throwing, a_host_in_scatter_leaves_no_trace) {
  expect_no_trace([](Setup& s) { s.wall.throws_in_scatter = true; },
                  [](Setup& s) { s.wall.throws_in_scatter = false; });
}

TEST_F(Throwing, an_observer_of_the_first_sub_step_leaves_no_trace) {
  expect_no_trace([](Setup& s) { s.observer.calls_left = 1; }, [](Setup& s) { s.observer.calls_left = 0; });
}

// The first sub-step is certified and committed by then.
TEST_F(Throwing, an_observer_of_the_last_sub_step_leaves_no_trace) {
  Setup plain, failing;
  int later = 0;
  for (int k = 0; k < 40; ++k) {
    const int substeps = plain.scene->step(k).substeps;
    later += substeps > 1;
    const Snapshot before(failing.scene->world);
    const auto hosts = failing.scene->host_state();
    failing.observer.calls_left = substeps;
    EXPECT_THROW(failing.scene->step(k), Failure);
    expect_unchanged(failing.scene->world, before);
    failing.scene->set_host_state(hosts);
    failing.scene->step(k);
    expect_same(Snapshot(failing.scene->world), Snapshot(plain.scene->world));
    if (HasFailure()) return;
  }
  EXPECT_GT(later, 5);
}

TEST(AddParticles, that_fails_adds_none) {
  const auto scene = make_scene({"", PressureSolver::pcisph, BoundaryModel::contact_only, 1});
  const std::vector<Vec3> x(1000, Vec3(0, 0.2, 0)), v(1000, Vec3::Zero());
  const Bytes before = save(scene->world);
  int failures = 0;
  for (std::uint64_t n = 1;; ++n) {
    try {
      allocations_left = n;
      const Status status = scene->world.add_particles(x, v);
      allocations_left = 0;
      EXPECT_TRUE(status.ok());
      break;
    } catch (const std::bad_alloc&) {
      allocations_left = 0;
      ++failures;
      EXPECT_TRUE(save(scene->world) == before) << "allocation " << n;
    }
  }
  EXPECT_GT(failures, 5);
  EXPECT_EQ(scene->world.particle_count(), 1000u);
}

TEST(ContactSolver, can_be_used_after_an_allocation_failed) {
  SurfaceMotion sheet;
  test::ParticleArrays particles;
  const auto begin = [&] {
    sheet = test::make_grid(6, 6, Vec3::Zero(), Vec3(0.05, 0, 0), Vec3(0, 0, 0.05), 1e-5, 0.002, 1,
                            Storage::float64);
    particles = {};
    for (int k = 0; k < 5; ++k) particles.add(Vec3(0.008 * k + 0.005, 0.004, 0.02), Vec3(0, -8, 0), 1e-4);
    particles.move(1e-3);
  };
  ContactSolver failing(ContactSettings{}, 1), plain(ContactSettings{}, 1);
  SurfaceMotion* surfaces[] = {&sheet};
  ContactReport report;
  begin();
  ParticleMotion motion = particles.motion();
  ASSERT_TRUE(plain.resolve(1e-3, motion, surfaces, report).ok());
  EXPECT_GT(report.contacts, 0u);
  const std::vector<Vec3> expected = particles.x_t1, expected_nodes = sheet.x_t1;
  int failures = 0;
  for (std::uint64_t n = 1;; ++n) {
    begin();
    motion = particles.motion();
    try {
      allocations_left = n;
      const Status status = failing.resolve(1e-3, motion, surfaces, report);
      allocations_left = 0;
      EXPECT_TRUE(status.ok());
      break;
    } catch (const std::exception&) {
      allocations_left = 0;
      ++failures;
    }
  }
  EXPECT_GT(failures, 20);
  EXPECT_EQ(particles.x_t1, expected);
  EXPECT_EQ(sheet.x_t1, expected_nodes);
  EXPECT_EQ(failing.contacts().size(), plain.contacts().size());
}

TEST(StepTogether, of_which_an_allocation_failed_leaves_no_link_between_the_worlds) {
  for (std::uint64_t n = 1; n < 40; ++n) {
    test::StaticMesh level;
    level.add_rectangle(Vec3::Zero(), Vec3(0, 0, 0.1), Vec3(0.1, 0, 0));
    World world(test::busy_world(1));
    ASSERT_TRUE(world.attach(level, test::sheet_settings(), nullptr).ok());
    {
      World first(test::busy_world(1));
      ASSERT_TRUE(first.attach(level, test::sheet_settings(), nullptr).ok());
      World* both[] = {&first, &world};
      allocations_left = n;
      EXPECT_THROW(World::step_together(both, 1e-3), std::exception) << n;
      allocations_left = 0;
    }
    EXPECT_EQ(world.step(1e-3).flags & flag_surface_refused, 0u) << n;
  }
}

}  // namespace
}  // namespace oilskin
