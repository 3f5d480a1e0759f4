// Save and restore: a restored world goes on bit for bit; what does not fit or is damaged is refused.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "support/busy_scene.h"
#include "support/random.h"
#include "world/save.h"

namespace oilskin {
namespace {

using Bytes = std::vector<std::uint8_t>;
using test::busy_world;
using test::BusyScene;

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

Bytes save(const World& w) {
  Bytes bytes;
  const Status s = w.save(&bytes);
  EXPECT_TRUE(s.ok()) << s.message;
  return bytes;
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

/// A host that fails when it is told to.
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

// --- Another process

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

FluidSettings dfsph() {
  FluidSettings f;
  f.solver = PressureSolver::dfsph;
  return f;
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

// --- What is refused

/// A small world and its bytes.
struct Small {
  World world;
  test::MockCloth<float> cloth;
  Bytes bytes;

  explicit Small(bool with_history = true) : world(busy_world(1), settings()) {
    EXPECT_TRUE(world.attach(cloth, test::sheet_settings(), nullptr).ok());
    if (!with_history) return;
    test::add_block(world, 3, Vec3(0.03, 0.003, 0.03), Vec3(0, -1, 0));
    DiscEmitter jet;
    jet.center = Vec3(0.05, 0.05, 0.05);
    jet.radius = 0.006;
    RainEmitter rain;
    rain.corner = Vec3(-0.1, 0.1, -0.1);
    EXPECT_TRUE(world.add_emitter(jet).ok());
    EXPECT_TRUE(world.add_emitter(rain).ok());
    for (int k = 0; k < 10; ++k) EXPECT_TRUE(world.step(1e-3).status.ok());
    bytes = save(world);
  }
  static FluidSettings settings() {
    FluidSettings f = dfsph();
    f.boundary = BoundaryModel::mirrored;
    return f;
  }
};

/// The refusal's message; the world is as it was.
std::string refusal(World& w, Span<const std::uint8_t> bytes) {
  const Bytes before = save(w);
  const StepReport* report = &w.report();
  const Status s = w.restore(bytes);
  EXPECT_FALSE(s.ok());
  EXPECT_EQ(save(w), before);
  EXPECT_EQ(&w.report(), report);
  return s.message;
}

TEST(Save, surfaces_that_do_not_match_are_refused) {
  const Small saved;
  World none(busy_world(1));
  EXPECT_EQ(refusal(none, saved.bytes),
            "the saved world has 1 surfaces, this one 0; attach the same hosts in the same order");
  const auto refused_for = [&](SurfaceHost& host) {
    World w(busy_world(1));
    EXPECT_TRUE(w.attach(host, test::sheet_settings(), nullptr).ok());
    return refusal(w, saved.bytes);
  };
  test::GridShape larger;
  larger.nu = 10;
  test::MockCloth<float> other_nodes(larger);
  EXPECT_NE(
      refused_for(other_nodes).find("surface 1 of the saved world has 81 nodes, the one attached here 90"),
      std::string::npos);
  test::MockCloth<float> torn;
  torn.triangles.pop_back();
  EXPECT_NE(refused_for(torn).find("128 triangles, the one attached here 127"), std::string::npos);
  test::MockCloth<float> flipped;
  std::swap(flipped.triangles[7][0], flipped.triangles[7][1]);
  EXPECT_NE(refused_for(flipped).find("other triangles"), std::string::npos);
  test::MockCloth<double> precise;
  EXPECT_NE(refused_for(precise).find("single precision, the one attached here double"), std::string::npos);
}

TEST(Save, damaged_bytes_are_refused_and_say_why) {
  const Small saved;
  Small here;
  ASSERT_TRUE(here.world.step(1e-3).status.ok());
  const auto changed = [&](std::size_t at, std::uint8_t value) {
    Bytes b = saved.bytes;
    b[at] = value;
    return refusal(here.world, b);
  };
  EXPECT_EQ(refusal(here.world, Bytes{}), "the bytes are not a saved world");
  EXPECT_EQ(changed(0, 'o'), "the bytes are not a saved world");
  EXPECT_EQ(changed(12, 9), "the saved world has version 9; this library reads version 1");
  EXPECT_NE(changed(saved.bytes.size() - 1, 77).find("check sum"), std::string::npos);
  Bytes swapped = saved.bytes;
  std::reverse(swapped.begin() + 8, swapped.begin() + 12);
  EXPECT_NE(refusal(here.world, swapped).find("byte order"), std::string::npos);
  for (std::size_t size = 0; size < saved.bytes.size(); size += 1 + size / 50)
    EXPECT_FALSE(here.world.restore(Span<const std::uint8_t>(saved.bytes).first(size)).ok());
  Bytes longer = saved.bytes;
  longer.push_back(0);
  refusal(here.world, longer);
}

/// The content with a right frame, as somebody would write it who means harm.
Bytes content_of(const Bytes& saved) {
  Span<const std::uint8_t> content;
  EXPECT_TRUE(world::unframe(saved, &content).ok());
  return Bytes(content.begin(), content.end());
}

TEST(Save, content_that_ends_early_or_goes_on_is_refused_behind_a_right_check_sum) {
  const Small saved;
  Small here;
  const Bytes content = content_of(saved.bytes);
  for (std::size_t size = 0; size < content.size(); size += 1 + size / 40) {
    const Bytes cut(content.begin(), content.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(here.world.restore(world::framed(cut)).ok()) << size;
  }
  Bytes longer = content;
  longer.push_back(0);
  EXPECT_NE(refusal(here.world, world::framed(longer)).find("more bytes"), std::string::npos);
}

TEST(Save, mutated_content_is_refused_or_runs) {
  const Small saved;
  const Bytes content = content_of(saved.bytes);
  test::Random random(47);
  int accepted = 0, refused = 0;
  const char* rounds = std::getenv("OILSKIN_SAVE_MUTATIONS");
  const int count = rounds ? std::atoi(rounds) : 400;
  for (int round = 0; round < count; ++round) {
    Bytes mutated = content;
    const std::uint32_t changes = 1 + random.below(3);
    for (std::uint32_t k = 0; k < changes; ++k) {
      // The first bytes hold settings and counters, where more depends on each.
      const auto range = static_cast<std::uint32_t>(random.uniform() < 0.5 ? 400 : content.size());
      const std::uint32_t at = random.below(range);
      const std::uint64_t word = random.uniform() < 0.3 ? ~std::uint64_t{0} : random.bits();
      std::memcpy(mutated.data() + at, &word,
                  std::min<std::size_t>(1 + random.below(8), content.size() - at));
    }
    Small here(false);
    const Status s = here.world.restore(world::framed(mutated));
    s.ok() ? ++accepted : ++refused;
    if (!s.ok()) continue;
    // Millions of iterations or drops are right, too, but nothing to wait for.
    const FluidSettings& f = here.world.fluid_settings();
    if (f.max_iterations > 100 || f.max_substeps > 10) continue;
    for (int k = 0; k < 3; ++k) here.world.step(1e-6);
  }
  EXPECT_GT(accepted, count / 20);
  EXPECT_GT(refused, count / 20);
}

}  // namespace
}  // namespace oilskin
