// Hard cases 52 and 53: water at rest on springs of any mass, and beside slots of any width.
#include <gtest/gtest.h>

#include <cmath>

#include "hard_cases/hard_case.h"
#include "hard_cases/water.h"
#include "support/mock_cloth.h"
#include "support/random.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin::test {
namespace {

using namespace water;

/// What the scenes of a case found.
struct Measured {
  double speed = 0, risen = 0;
  std::uint32_t flags = 0;
  std::size_t lost = 0;

  void add(const Measured& o) {
    speed = std::max(speed, o.speed);
    risen = std::max(risen, o.risen);
    flags |= o.flags;
    lost += o.lost;
  }
  void add(const World& w, std::size_t particles) {
    const StepReport& r = w.report();
    speed = std::max(speed, r.energy.max_speed);
    if (r.energy.scale > 0) risen = std::max(risen, r.energy.risen_fraction());
    flags |= r.flags;
    lost = particles - w.particle_count();
  }
};

/// A block of water that is put to rest on a sheet of springs whose border is pinned.
class Loaded : public WorldScene {
 public:
  static constexpr int across = 6, layers = 4;

  /// `ratio`: mass of the cloth over that of the water.
  Loaded(const FluidSettings& fluid, double ratio, int threads, Measured& found)
      : found_(found), world_(world_of(1, Vec3(0, -g, 0), threads), fluid), cloth_(shape(ratio)) {
    const double water_mass = across * layers * across * world_.particle_mass();
    cloth_.gravity = Vec3(0, -g, 0);
    // In proportion to the heavier of both.
    cloth_.stiffness = 20 * std::max(1.0, ratio) * water_mass * g / dx;
    cloth_.damping = 0.1 * std::sqrt(cloth_.stiffness * ratio * water_mass / (nodes * nodes));
    for (std::size_t i = 0; i < cloth_.x.size(); ++i) {
      const std::size_t a = i % nodes, b = i / nodes;
      if (a == 0 || b == 0 || a == nodes - 1 || b == nodes - 1) cloth_.pin(i);
    }
    SurfaceId id;
    EXPECT_TRUE(world_.attach(cloth_, sheet_settings(), &id).ok());
    fill(world_, lattice(across, layers, across, Vec3(-2.5 * dx, 0.5 * dx, -2.5 * dx)));
  }
  World& world() override { return world_; }
  void after_step(int) override { found_.add(world_, across * layers * across); }

 private:
  static constexpr int nodes = 9;
  static GridShape shape(double ratio) {
    GridShape s{nodes, nodes, Vec3(-0.04, 0, -0.04), Vec3(0.08, 0, 0), Vec3(0, 0, 0.08)};
    s.areal_density = ratio * across * layers * across * 1000 * dx * dx * dx / (0.08 * 0.08);
    return s;
  }

  Measured& found_;
  World world_;
  MockCloth<double> cloth_;
};

/// Springs give back what a load has stored in nodes that are lighter than it, and with one impulse a step
/// water and springs push each other up. What is asked there is that the run stays finite and says so.
TEST(HardEverywhere, water_is_put_on_springs_of_a_millionth_to_a_million_times_its_mass) {
  HardCase c("52", "a block put to rest on pinned springs of 1e-6 to 1e6 times its mass, two solvers, 1 ms");
  Found all;
  Measured heavy, light;
  std::uint64_t untold = 0;
  for (const PressureSolver solver : incompressible_solvers)
    for (const double ratio : {1e-6, 1e-2, 1.0, 1e3, 1e6}) {
      const bool mirrored = solver == PressureSolver::dfsph;
      Measured found;
      all.add(run_checked(
          [&](int threads) {
            return std::make_unique<Loaded>(solver_of(solver, mirrored), ratio, threads, found);
          },
          50, 1e-3));
      (ratio < 1 ? light : heavy).add(found);
      untold += found.risen > energy_made_limit && (found.flags & flag_energy_made) == 0;
    }
  c.no_crossings(all);
  c.equal("particles lost, springs not lighter than the water", heavy.lost, 0);
  c.below("largest speed, the same springs [m/s]", heavy.speed, 2);
  c.at_most("energy risen, of what is released", heavy.risen, 0.05);
  c.note("largest speed, lighter springs [m/s]", light.speed);
  c.note("energy risen, of what is released", light.risen);
  c.equal("runs that made energy and do not say so", untold, 0);
}

/// A tank whose water may pass under a wall into a slot.
class Slotted : public WorldScene {
 public:
  static constexpr int across = 8;

  Slotted(const FluidSettings& fluid, double width, double opening, int threads, Measured& found)
      : found_(found), world_(world_of(1, Vec3(0, -g, 0), threads), fluid) {
    const Vec3 x(across * dx, 0, 0), y(0, 3 * across * dx, 0), z(0, 0, across * dx);
    const Vec3 to_slot(-width, 0, 0);
    walls_.add_rectangle(to_slot, x - to_slot, z);
    for (const Vec3& at : {to_slot, x}) walls_.add_rectangle(at, y, z);
    for (const Vec3& at : {to_slot, Vec3(to_slot + z)}) walls_.add_rectangle(at, x - to_slot, y);
    walls_.add_rectangle(Vec3(0, opening, 0), y, z);
    SurfaceId id;
    EXPECT_TRUE(world_.attach(walls_, sheet_settings(), &id).ok());
    fill(world_, lattice(across, across, across, Vec3::Constant(0.5 * dx)));
  }
  World& world() override { return world_; }
  void after_step(int) override { found_.add(world_, across * across * across); }

 private:
  Measured& found_;
  StaticMesh walls_;
  World world_;
};

TEST(HardEverywhere, water_passes_into_slots_of_random_width) {
  HardCase c("53", "water of 8 layers passes under a wall into slots of 0.5 to 4 dx, two solvers");
  Random random(53);
  Found all;
  Measured worst;
  for (int k = 0; k < 8; ++k) {
    const FluidSettings fluid = solver_of(incompressible_solvers[k % 2], true);
    const double width = random.uniform(0.5, 4) * dx, opening = random.uniform(0.5, 4) * dx;
    const double dt = random.log_uniform(5e-4, 2e-3);
    Measured found;
    all.add(run_checked(
        [&](int threads) { return std::make_unique<Slotted>(fluid, width, opening, threads, found); },
        static_cast<int>(std::ceil(0.15 / dt)), dt));
    worst.add(found);
  }
  c.no_crossings(all);
  c.equal("particles lost", worst.lost, 0);
  c.below("largest speed [m/s]", worst.speed, 3);
  c.at_most("energy risen, of what is released", worst.risen, 0.05);
}

}  // namespace
}  // namespace oilskin::test
