// Bytes → World::restore(), as they are and as the content of a right frame. It must refuse, or give a world
// that runs.
#include "fuzz/fuzz_target.h"
#include "oilskin/world.h"
#include "support/mock_cloth.h"
#include "support/static_mesh.h"
#include "world/save.h"

namespace oilskin::fuzz {

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t longest_input = 1 << 15;

test::GridShape small_sheet() {
  test::GridShape g;
  g.nu = g.nv = 3;
  g.origin = Vec3(-0.02, 0, -0.02);
  g.u = Vec3(0.04, 0, 0);
  g.v = Vec3(0, 0, 0.04);
  return g;
}

/// Two surfaces, a few particles.
class SmallWorld {
 public:
  explicit SmallWorld(const FluidSettings& fluid = {}) : world(settings(), fluid), cloth(small_sheet()) {
    floor.add_rectangle(Vec3(-0.1, -0.05, -0.1), Vec3(0.2, 0, 0), Vec3(0, 0, 0.2));
    SurfaceSettings surface;
    expect(world.attach(cloth, surface, nullptr).ok() && world.attach(floor, surface, nullptr).ok(),
           "small worlds attach their surfaces");
  }

  World world;

 private:
  static WorldSettings settings() {
    WorldSettings s;
    s.threads = 1;
    return s;
  }
  test::MockCloth<float> cloth;
  test::StaticMesh floor;
};

Bytes saved(PressureSolver solver, BoundaryModel boundary, int steps) {
  FluidSettings fluid;
  fluid.solver = solver;
  fluid.boundary = boundary;
  SmallWorld w(fluid);
  DiscEmitter jet;
  jet.center = Vec3(0, 0.01, 0);
  jet.radius = 0.006;
  RainEmitter rain;
  rain.corner = Vec3(-0.02, 0.02, -0.02);
  BoxEmitter later;
  later.box = {Vec3::Constant(0.1), Vec3::Constant(0.11)};
  later.start = 1;
  expect(w.world.add_emitter(jet).ok() && w.world.add_emitter(rain).ok() && w.world.add_emitter(later).ok(),
         "small worlds have emitters");
  for (int k = 0; k < steps; ++k) w.world.step(2e-3);
  Bytes bytes;
  expect(w.world.save(&bytes).ok(), "a world can be saved");
  return bytes;
}

/// Steps so short that no emitter can start more than a few particles, and no more work than a fuzzer waits
/// for: settings of millions of iterations are right, but slow.
void run(World& world) {
  const FluidSettings& f = world.fluid_settings();
  if (f.max_iterations > 50 || f.max_substeps > 4 || world.contact_settings().solver_iterations > 50) return;
  for (int k = 0; k < 2; ++k) world.step(1e-9);
}

}  // namespace

std::vector<Bytes> seeds() {
  const std::vector<Bytes> worlds = {saved(PressureSolver::pcisph, BoundaryModel::contact_only, 0),
                                     saved(PressureSolver::mcg03, BoundaryModel::contact_only, 6),
                                     saved(PressureSolver::pcisph, BoundaryModel::contact_only, 8),
                                     saved(PressureSolver::dfsph, BoundaryModel::mirrored, 8)};
  std::vector<Bytes> all = {worlds[0]};  // with its frame
  for (const Bytes& world : worlds) {
    Span<const std::uint8_t> content;
    expect(world::unframe(world, &content).ok(), "what was saved has a right frame");
    all.emplace_back(content.begin(), content.end());
  }
  return all;
}

}  // namespace oilskin::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oilskin;
  if (size > fuzz::longest_input) return 0;
  const Span<const std::uint8_t> bytes(data, size);
  fuzz::SmallWorld small;
  const std::uint64_t before = small.world.state_hash();
  if (!small.world.restore(bytes).ok() && !small.world.restore(world::framed(bytes)).ok()) {
    fuzz::expect(small.world.state_hash() == before, "a refusal leaves the world as it was");
    return 0;
  }
  std::vector<std::uint8_t> first, second;
  fuzz::expect(small.world.save(&first).ok(), "a restored world can be saved");
  fuzz::expect(small.world.restore(first).ok() && small.world.save(&second).ok() && first == second,
               "what a restored world saves is what it restores");
  fuzz::run(small.world);
  return 0;
}
