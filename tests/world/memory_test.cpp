// All memory of the library comes from operator new, which a program may replace, and goes back to it. This
// program does.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "oilskin/force_fields.h"
#include "oilskin/reconstruction.h"
#include "oilskin/surface_tension.h"
#include "support/busy_scene.h"

namespace {

/// Of the blocks that operator new has given and not got back [bytes].
std::size_t used = 0, most_used = 0;

struct alignas(__STDCPP_DEFAULT_NEW_ALIGNMENT__) Header {
  std::size_t size;
};

void* allocate(std::size_t size) noexcept {
  void* const memory = std::malloc(sizeof(Header) + size);
  if (memory == nullptr) return nullptr;
  used += size;
  if (used > most_used) most_used = used;
  return new (memory) Header{size} + 1;
}

void release(void* block) noexcept {
  if (block == nullptr) return;
  Header* const header = static_cast<Header*>(block) - 1;
  used -= header->size;
  std::free(header);
}

void* allocate_or_throw(std::size_t size) {
  if (void* block = allocate(size)) return block;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) {
  return allocate_or_throw(size);
}
void* operator new[](std::size_t size) {
  return allocate_or_throw(size);
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return allocate(size);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return allocate(size);
}
void operator delete(void* block) noexcept {
  release(block);
}
void operator delete[](void* block) noexcept {
  release(block);
}
void operator delete(void* block, std::size_t) noexcept {
  release(block);
}
void operator delete[](void* block, std::size_t) noexcept {
  release(block);
}

namespace oilskin {
namespace {

/// Everything that a world may have, some steps of it, its saved bytes and a mesh of its water.
struct Everything {
  test::BusyScene<float> scene;
  ForceFields forces;
  SurfaceTension tension;
  WaterMesh mesh;
  std::vector<std::uint8_t> saved;

  Everything() : scene(test::busy_world(1), settings()), tension(SurfaceTensionSettings{}) {
    World& world = scene.world;
    scene.add_emitters();
    EXPECT_TRUE(world.add_effect(forces).ok() && world.add_effect(tension).ok());
    Region region;
    region.box = Box{Vec3::Constant(-0.4), Vec3(0.4, -0.3, 0.4)};
    EXPECT_TRUE(world.add_sink(region).ok() && world.set_max_age(10).ok());
    test::add_block(world, 16, Vec3(-0.04, 0.1, -0.04), Vec3(0, -2, 0));
    for (int k = 0; k < 12; ++k) EXPECT_TRUE(scene.step(k).status.ok());
    EXPECT_TRUE(world.save(&saved).ok() && world.restore(saved).ok());
    EXPECT_TRUE(scene.step(12).status.ok());
    EXPECT_GT(world.contacts().size(), 0u);
    ReconstructionInput input;
    input.positions = world.positions();
    ReconstructionOptions options;
    options.spacing = world.fluid_settings().spacing;
    options.threads = 1;
    EXPECT_TRUE(reconstruct_surface(input, options, &mesh).ok());
  }

  static FluidSettings settings() {
    FluidSettings fluid;
    fluid.occlusion = true;
    fluid.max_substeps = 2;
    return fluid;
  }
};

TEST(Memory, all_that_a_world_and_its_mesh_have_taken_goes_back) {
  static_cast<void>(std::make_unique<Everything>());  // what is made once for all worlds
  const std::size_t before = used;
  most_used = used;
  {
    const Everything everything;
    EXPECT_GT(used - before, 3000000u);
  }
  EXPECT_EQ(used, before);
}

#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
std::size_t in_use_of_process() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

TEST(Memory, at_least_95_percent_of_what_the_process_takes_for_a_world_comes_from_operator_new) {
  static_cast<void>(std::make_unique<Everything>());
  const std::size_t before = used, before_of_process = in_use_of_process();
  const Everything everything;
  const double counted = double(used - before), taken = double(in_use_of_process() - before_of_process);
  EXPECT_GT(counted, 0.95 * taken) << counted << " of " << taken << " bytes";
}
#endif

}  // namespace
}  // namespace oilskin
