// A wetting effect after steps of which an allocation failed. This program replaces operator new.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "effects/wetting_scene.h"
#include "world/saved_bytes.h"

namespace {

/// Allocations until one fails; 0 = none does.
std::uint64_t allocations_left = 0;

void* allocate(std::size_t size) {
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
// std::stable_sort() and FCL's arrays do without the memory that they ask for in this way.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return std::malloc(size > 0 ? size : 1);
}
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

namespace oilskin::test {
namespace {

// The effect finds its cloths anew in each step.
TEST(WettingMemory, that_fails_anywhere_in_a_step_leaves_the_capacities) {
  WetScene scene(thirsty());
  GridShape below = sheet();
  below.origin.y() -= 0.1;
  MockCloth<double> second(below);
  SurfaceId id;
  ASSERT_TRUE(scene.world.attach(second, sheet_settings(), &id).ok());
  scene.add_block(4, Vec3(-0.01, 0.004, -0.01), Vec3(0, -1, 0));
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(scene.world.step(1e-3).status.ok());
  const double capacity = sum(scene.wetting.capacity(id));
  ASSERT_NEAR(capacity, thirsty().fabric.capacity * 0.04, 1e-9);
  int failed = 0;
  for (std::uint64_t n = 1; n < 5000; ++n) {
    const Bytes before = save(scene.world);
    const MockCloth<double> cloths[] = {scene.cloth, second};
    bool has_failed = false;
    allocations_left = n;
    try {
      (void)scene.world.step(1e-4);
    } catch (const std::bad_alloc&) {
      has_failed = true;
    }
    const bool is_done = allocations_left > 0;
    allocations_left = 0;
    SCOPED_TRACE("allocation " + std::to_string(n));
    ASSERT_EQ(sum(scene.wetting.capacity(id)), capacity);
    ASSERT_NEAR(sum(scene.wetting.capacity(scene.id)), capacity, 1e-9);
    if (is_done) break;
    if (!has_failed) continue;  // some code does without
    ++failed;
    ASSERT_TRUE(save(scene.world) == before);
    scene.cloth = cloths[0];
    second = cloths[1];
  }
  EXPECT_GT(failed, 50);
}

}  // namespace
}  // namespace oilskin::test
