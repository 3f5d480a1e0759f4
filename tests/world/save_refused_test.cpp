// Saved worlds that do not fit or are damaged are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "support/busy_scene.h"
#include "support/random.h"
#include "world/save.h"
#include "world/saved_bytes.h"

namespace oilskin::test {
namespace {

/// A small world and its bytes.
struct Small {
  World world;
  MockCloth<float> cloth;
  Bytes bytes;

  explicit Small(bool with_history = true) : world(busy_world(1), settings()) {
    EXPECT_TRUE(world.attach(cloth, sheet_settings(), nullptr).ok());
    if (!with_history) return;
    add_block(world, 3, Vec3(0.03, 0.003, 0.03), Vec3(0, -1, 0));
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
    EXPECT_TRUE(w.attach(host, sheet_settings(), nullptr).ok());
    return refusal(w, saved.bytes);
  };
  GridShape larger;
  larger.nu = 10;
  MockCloth<float> other_nodes(larger);
  EXPECT_NE(
      refused_for(other_nodes).find("surface 1 of the saved world has 81 nodes, the one attached here 90"),
      std::string::npos);
  MockCloth<float> torn;
  torn.triangles.pop_back();
  EXPECT_NE(refused_for(torn).find("128 triangles, the one attached here 127"), std::string::npos);
  MockCloth<float> flipped;
  std::swap(flipped.triangles[7][0], flipped.triangles[7][1]);
  EXPECT_NE(refused_for(flipped).find("other triangles"), std::string::npos);
  MockCloth<double> precise;
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
  EXPECT_EQ(changed(12, 11), "the saved world has version 11; this library reads version 15");
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
  Random random(47);
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
}  // namespace oilskin::test
