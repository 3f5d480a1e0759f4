// Save and restore: a restored world continues bit for bit.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "support/busy_scene.h"
#include "world/saved_bytes.h"

namespace oilskin {
namespace {

using test::busy_world;
using test::BusyScene;
using test::Bytes;
using test::dfsph;
using test::save;

constexpr int saved_after = 30, steps_more = 50;

struct Case {
  const char* name;
  PressureSolver solver;
  BoundaryModel boundary;
  int max_substeps;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

FluidSettings settings_of(const Case& c) {
  FluidSettings f;
  f.solver = c.solver;
  f.boundary = c.boundary;
  f.max_substeps = c.max_substeps;
  f.max_iterations = 30;
  return f;
}

/// What a run did after the save: the trace of every interval, hashes, and what reports say of the fluid.
struct Ending {
  std::string trace;
  std::vector<std::uint64_t> hashes;
  std::vector<double> suggested;
  std::uint64_t emitted = 0, blocked = 0, stalled = 0, held = 0, iterations = 0;
  int most_substeps = 0;
};

template <class Scalar>
Ending go_on(BusyScene<Scalar>& scene, int first = saved_after, int steps = steps_more) {
  Ending e;
  std::ostringstream out;
  TraceWriter trace(out);
  scene.world.set_observer(&trace);
  for (int k = first; k < first + steps; ++k) {
    e.suggested.push_back(scene.world.suggested_dt(1));
    const StepReport& r = scene.step(k);
    EXPECT_TRUE(r.status.ok());
    e.hashes.push_back(scene.world.state_hash());
    e.emitted += r.emitted;
    e.blocked += r.blocked_starts;
    e.stalled += r.contact.stalled;
    e.held += r.contact.held;
    e.iterations += static_cast<std::uint64_t>(r.fluid.iterations + r.fluid.divergence_iterations);
    e.most_substeps = std::max(e.most_substeps, r.substeps);
  }
  scene.world.set_observer(nullptr);
  e.trace = out.str();
  return e;
}

template <class Scalar>
std::unique_ptr<BusyScene<Scalar>> started(const FluidSettings& fluid, int threads) {
  auto scene = std::make_unique<BusyScene<Scalar>>(busy_world(threads), fluid);
  scene->add_emitters();
  EXPECT_TRUE(scene->ok);
  for (int k = 0; k < saved_after; ++k) EXPECT_TRUE(scene->step(k).status.ok());
  return scene;
}

void expect_same(const Ending& a, const Ending& b) {
  EXPECT_EQ(a.hashes, b.hashes);
  EXPECT_EQ(a.trace, b.trace);
  EXPECT_EQ(a.suggested, b.suggested);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.emitted, b.emitted);
  EXPECT_EQ(a.blocked, b.blocked);
}

class Saved : public ::testing::TestWithParam<Case> {};

template <class Scalar>
void expect_to_go_on(const Case& c, int threads) {
  const auto scene = started<Scalar>(settings_of(c), 1);
  const Bytes bytes = save(scene->world);
  const auto hosts = scene->host_state();
  const std::uint64_t hash = scene->world.state_hash();
  const Ending uninterrupted = go_on(*scene);

  // The scene has what a save could forget.
  EXPECT_GT(uninterrupted.emitted, 300u);
  EXPECT_GT(uninterrupted.blocked, 0u);
  EXPECT_GT(uninterrupted.stalled, 0u);
  EXPECT_EQ(uninterrupted.most_substeps > 1, c.max_substeps > 1);

  // Other settings on purpose: the saved ones count.
  BusyScene<Scalar> other(busy_world(threads), FluidSettings{});
  const Status s = other.world.restore(bytes);
  ASSERT_TRUE(s.ok()) << s.message;
  other.set_host_state(hosts);
  EXPECT_EQ(other.world.state_hash(), hash);
  EXPECT_EQ(other.world.settings().threads, threads);
  EXPECT_EQ(other.world.fluid_settings().solver, c.solver);
  EXPECT_EQ(save(other.world), bytes);
  expect_same(go_on(other), uninterrupted);
}

TEST_P(Saved, a_restored_world_goes_on_bit_for_bit_float_host_two_threads) {
  expect_to_go_on<float>(GetParam(), 2);
}

TEST_P(Saved, a_restored_world_goes_on_bit_for_bit_double_host_one_thread) {
  expect_to_go_on<double>(GetParam(), 1);
}

INSTANTIATE_TEST_SUITE_P(
    Solvers, Saved,
    ::testing::Values(Case{"mcg03", PressureSolver::mcg03, BoundaryModel::contact_only, 1},
                      Case{"pcisph_substeps", PressureSolver::pcisph, BoundaryModel::contact_only, 3},
                      Case{"dfsph", PressureSolver::dfsph, BoundaryModel::contact_only, 1},
                      Case{"dfsph_mirrored_substeps", PressureSolver::dfsph, BoundaryModel::mirrored, 3}),
    [](const auto& one) { return std::string(one.param.name); });

FluidSettings plain() {
  FluidSettings f;
  f.max_iterations = 10;
  return f;
}

TEST(Save, two_threads_save_the_same_bytes_as_one_and_a_world_goes_back_in_time) {
  const auto scene = started<float>(plain(), 1);
  const Bytes bytes = save(scene->world);
  EXPECT_EQ(save(started<float>(plain(), 2)->world), bytes);
  const auto hosts = scene->host_state();
  const Ending once = go_on(*scene);
  ASSERT_TRUE(scene->world.restore(bytes).ok());
  scene->set_host_state(hosts);
  expect_same(go_on(*scene), once);
}

TEST(Save, surfaces_keep_their_ids_in_the_trace_and_get_the_handles_of_the_new_world) {
  const auto scene = started<double>(plain(), 1);
  scene->world.detach(scene->floor_id);  // a gap in the ids
  SurfaceSettings slippery = test::sheet_settings();
  ASSERT_TRUE(
      scene->world.set_slip(scene->cloth_id, {SlipModel::coulomb, 0.5, 0}, {SlipModel::sticking, 1, 0}).ok());
  scene->step(saved_after);
  const Bytes bytes = save(scene->world);
  const auto hosts = scene->host_state();
  const SurfaceMotion before = *scene->world.surface(scene->cloth_id);

  BusyScene<double> other(busy_world(1), plain());
  other.world.detach(other.cloth_id);
  other.world.detach(other.floor_id);
  other.world.detach(other.lid_id);
  other.world.detach(other.press_id);
  // In the order of the saved world, under any settings that attach() takes.
  ASSERT_TRUE(other.world.attach(other.cloth, test::sheet_settings(0.003), &other.cloth_id).ok());
  ASSERT_TRUE(other.world.attach(other.lid, test::sheet_settings(), &other.lid_id).ok());
  ASSERT_TRUE(other.world.attach(other.press, test::sheet_settings(), &other.press_id).ok());
  ASSERT_TRUE(other.world.restore(bytes).ok());
  other.set_host_state(hosts);
  EXPECT_EQ(other.world.surface_count(), 3u);
  const SurfaceMotion& after = *other.world.surface(other.cloth_id);
  EXPECT_EQ(after.id, before.id);
  EXPECT_EQ(after.thickness, slippery.thickness);
  EXPECT_EQ(after.delta, before.delta);
  EXPECT_EQ(after.x_t0, before.x_t0);
  EXPECT_EQ(after.impulse, before.impulse);
  expect_same(go_on(other, saved_after + 1, 20), go_on(*scene, saved_after + 1, 20));
  EXPECT_TRUE(other.world.surface(other.cloth_id)->slip_back.has_value());
}

/// A floor that counts how often it had to fill in its mesh.
class CountingFloor : public test::StaticMesh {
 public:
  int filled = 0;
  CountingFloor() {
    changes = Changes::never;
    add_rectangle(Vec3(-0.1, 0, -0.1), Vec3(0.2, 0, 0), Vec3(0, 0, 0.2), 8, 8);
  }
  Gathered gather(double dt, SurfaceMotion& m) override {
    const Gathered gathered = StaticMesh::gather(dt, m);
    filled += !gathered.unchanged;
    return gathered;
  }
};

// A game that goes back some frames would pay for its whole level in each.
TEST(Save, a_level_that_stands_where_it_stood_is_not_read_again) {
  CountingFloor floor;
  World w(test::under_gravity(), test::of_spacing(0.01));
  ASSERT_TRUE(w.attach(floor, test::sheet_settings(), nullptr).ok());
  test::add_block(w, 4, Vec3(-0.02, 0.005, -0.02), Vec3::Zero());
  for (int k = 0; k < 3; ++k) w.step(2e-3);
  const Bytes saved = save(w);
  std::vector<std::uint64_t> hashes;
  for (int k = 0; k < 20; ++k) hashes.push_back((w.step(2e-3), w.state_hash()));
  const int filled = floor.filled;
  ASSERT_TRUE(w.restore(saved).ok());
  for (std::uint64_t hash : hashes) {
    w.step(2e-3);
    ASSERT_EQ(w.state_hash(), hash);
  }
  EXPECT_EQ(floor.filled, filled);
  for (Vec3& x : floor.nodes) x.y() -= 0.001;
  floor.changes = test::StaticMesh::Changes::compared;
  ASSERT_TRUE(w.restore(saved).ok());
  w.step(2e-3);
  EXPECT_EQ(floor.filled, filled + 1) << "it moved";
  EXPECT_NE(w.state_hash(), hashes.front());
}

/// A host that fails on request.
class Fragile : public test::StaticMesh {
 public:
  bool broken = false;
  Gathered gather(double dt, SurfaceMotion& m) override {
    if (broken) return {Status::refused("broken"), false};
    return StaticMesh::gather(dt, m);
  }
};

TEST(Save, pending_resets_new_and_refused_surfaces_are_kept) {
  const auto make = [](World& w, Fragile& a, Fragile& b, std::array<SurfaceId, 2>& id) {
    for (Fragile* mesh : {&a, &b})
      mesh->add_rectangle(Vec3(-0.1, mesh == &a ? 0.0 : 0.05, -0.1), Vec3(0.2, 0, 0), Vec3(0, 0, 0.2));
    ASSERT_TRUE(w.attach(a, test::sheet_settings(), &id[0]).ok());
    ASSERT_TRUE(w.attach(b, test::sheet_settings(), &id[1]).ok());
  };
  const auto end = [](World& w, Fragile& a, Fragile& b, const std::array<SurfaceId, 2>& id) {
    std::vector<std::uint64_t> seen;
    for (int k = 0; k < 30; ++k) {
      if (k == 10) b.broken = false, w.reset_motion(id[1]);
      for (Vec3& x : a.nodes) x.y() += 0.0005;
      const StepReport& r = w.step(1e-3);
      seen.push_back(w.state_hash());
      seen.push_back(r.flags);
      for (SurfaceId one : id) seen.push_back(w.surface(one)->id);
    }
    return seen;
  };
  World w(busy_world(1), plain());
  Fragile a, b;
  std::array<SurfaceId, 2> id;
  make(w, a, b, id);
  test::add_block(w, 4, Vec3(-0.01, 0.004, -0.01), Vec3(0, -0.2, 0));
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(w.step(1e-3).status.ok());
  b.broken = true;
  EXPECT_TRUE(w.step(1e-3).flags & flag_surface_refused);
  for (Vec3& x : a.nodes) x.y() += 0.006;  // into the water
  w.reset_motion(id[0]);
  const Bytes bytes = save(w);
  const std::vector<Vec3> nodes = a.nodes;

  World other(busy_world(2), plain());
  Fragile a2, b2;
  std::array<SurfaceId, 2> id2;
  make(other, a2, b2, id2);
  ASSERT_TRUE(other.restore(bytes).ok());
  a2.nodes = nodes;
  b2.broken = true;
  const std::uint64_t before = w.surface(id[0])->id;
  const auto expected = end(w, a, b, id);
  EXPECT_EQ(end(other, a2, b2, id2), expected);
  EXPECT_NE(expected[2], before);  // the teleport was pending
}

TEST(Save, an_empty_world_too_and_none_of_wrong_settings) {
  World w(busy_world(1));
  World other(busy_world(1));
  EXPECT_TRUE(other.restore(save(w)).ok());
  EXPECT_TRUE(other.step(1e-3).status.ok());
  FluidSettings bad;
  bad.spacing = -1;
  const World refused(busy_world(1), bad);
  Bytes bytes = {1, 2, 3};
  EXPECT_FALSE(refused.save(&bytes).ok());
  EXPECT_EQ(bytes.size(), 3u);
}

/// add_velocities() takes what is no number; the next step removes the particle, in the restored world, too.
TEST(Save, particles_whose_velocities_are_no_numbers) {
  World w(busy_world(1)), other(busy_world(1));
  ASSERT_TRUE(
      w.add_particles(std::vector<Vec3>{Vec3(0, 0, 0), Vec3(0, 0.02, 0)}, std::vector<Vec3>(2, Vec3(1, 0, 0)))
          .ok());
  ASSERT_TRUE(w.step(1e-3).status.ok());
  ASSERT_EQ(w.particle_count(), 2u);
  std::vector<Vec3> dv(2, Vec3::Zero());
  dv[1].y() = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(w.add_velocities(dv).ok());
  const Status restored = other.restore(save(w));
  ASSERT_TRUE(restored.ok()) << restored.message;
  for (World* one : {&w, &other}) {
    EXPECT_EQ(one->step(1e-3).removed_invalid, 1u);
    EXPECT_EQ(one->particle_count(), 1u);
  }
  EXPECT_EQ(w.state_hash(), other.state_hash());
}

constexpr const char* folder_variable = "OILSKIN_SAVED_WORLD";

template <class T>
void write_all(const std::string& path, const std::vector<T>& values) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(values.data()),
             static_cast<std::streamsize>(values.size() * sizeof(T)));
}

template <class T>
std::vector<T> read_all(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  std::vector<T> values(text.size() / sizeof(T));
  std::memcpy(static_cast<void*>(values.data()), text.data(), values.size() * sizeof(T));
  return values;
}

/// The part of the test below that runs in the other process.
TEST(Save, restored_in_this_process) {
  const char* folder = std::getenv(folder_variable);
  if (folder == nullptr) GTEST_SKIP() << "run by goes_on_in_another_process";
  const std::string at = std::string(folder) + "/";
  BusyScene<float> scene(busy_world(1), FluidSettings{});
  ASSERT_TRUE(scene.world.restore(read_all<std::uint8_t>(at + "world")).ok());
  using SVec = test::MockCloth<float>::SVec;
  scene.set_host_state({{read_all<SVec>(at + "x"), read_all<SVec>(at + "v")},
                        {read_all<SVec>(at + "press_x"), read_all<SVec>(at + "press_v")}});
  write_all(at + "hashes", go_on(scene).hashes);
}

TEST(Save, goes_on_in_another_process) {
  std::string name = (std::filesystem::temp_directory_path() / "oilskin-save-XXXXXX").string();
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  const auto scene = started<float>(dfsph(), 1);
  write_all(name + "/world", save(scene->world));
  const auto [cloth, press] = scene->host_state();
  write_all(name + "/x", cloth.x);
  write_all(name + "/v", cloth.v);
  write_all(name + "/press_x", press.x);
  write_all(name + "/press_v", press.v);
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string command = std::string(folder_variable) + "='" + name + "' '" + self +
                              "' --gtest_filter=Save.restored_in_this_process >/dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(read_all<std::uint64_t>(name + "/hashes"), go_on(*scene).hashes);
  std::filesystem::remove_all(name);
}

}  // namespace
}  // namespace oilskin
