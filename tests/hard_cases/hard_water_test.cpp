// Hard cases 28, 29, 41, 45: water at rest, spray, a sheet between equal waters, an emitter inside cloth.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdlib>

#include "hard_cases/hard_case.h"
#include "hard_cases/water.h"
#include "support/mock_cloth.h"
#include "support/random.h"
#include "support/static_mesh.h"
#include "support/trace_watch.h"
#include "support/world_helpers.h"

namespace oilskin::test {
namespace {

using namespace water;

/// A square of cloth pinned on its rim, soft enough to sag under the water like a hammock.
struct Hammock {
  static constexpr int n = 11;
  World w;
  MockCloth<float> cloth;
  SurfaceId id;

  Hammock()
      : w(world_of(0.5, Vec3(0, -g, 0), 2), solver_of(PressureSolver::pcisph)),
        cloth(GridShape{n, n, Vec3(-0.05, 0, -0.05), Vec3(0.1, 0, 0), Vec3(0, 0, 0.1), 0.5}) {
    cloth.gravity = Vec3(0, -g, 0);
    cloth.stiffness = 10;
    cloth.damping = 0.05;
    for (std::size_t i = 0; i < cloth.x.size(); ++i) {
      const std::size_t a = i % n, b = i / n;
      const float u = cloth.x[i].x() / 0.05f, v = cloth.x[i].z() / 0.05f;
      cloth.x[i].y() = -0.03f * (1 - u * u) * (1 - v * v);
      if (a == 0 || b == 0 || a == n - 1 || b == n - 1) cloth.pin(i);
    }
    EXPECT_TRUE(w.attach(cloth, sheet_settings(), &id).ok());
    fill(w, lattice(4, 5, 4, Vec3(-0.0075, -0.027, -0.0075)));
  }
  Vec3 middle() const {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& x : w.positions()) sum += x / static_cast<double>(w.particle_count());
    return sum;
  }
};

double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;  // [MB]
}

TEST(HardFluid, water_rests_in_a_hammock) {
  const char* asked = std::getenv("OILSKIN_REST_STEPS");
  const int steps = asked ? std::atoi(asked) : 4000, settling = 1500;
  Hammock h;
  World& w = h.w;
  const std::size_t count = w.particle_count();
  TraceWatch watch;
  w.set_observer(&watch);
  double ledger = 0;
  std::uint64_t findings = 0, pairs = 0;
  const auto run = [&](int n) {  // mean kinetic energy
    double energy = 0;
    for (int k = 0; k < n; ++k) {
      const StepReport& r = w.step(1e-3);
      EXPECT_TRUE(r.status.ok());
      ledger = std::max(ledger, r.momentum_residual().norm() / (r.momentum_gravity.norm()));
      energy += kinetic_energy(w) / n;
      if (k % 20 != 19) continue;
      const audit::Summary s = watch.judge();
      findings += s.findings();
      pairs += s.pairs;
    }
    return energy;
  };
  run(settling);
  const double fall = static_cast<double>(count) * w.particle_mass() * g * dx;
  const double energy_before = run(500);
  const Vec3 middle = h.middle();
  const std::vector<MockCloth<float>::SVec> nodes = h.cloth.x;
  const double memory = peak_memory();
  run(steps - 500);
  const double energy_after = run(500), memory_grown = peak_memory() - memory;
  double drift = (h.middle() - middle).norm();
  for (std::size_t i = 0; i < nodes.size(); ++i)
    drift = std::max(drift, static_cast<double>((h.cloth.x[i] - nodes[i]).norm()));
  EXPECT_EQ(w.particle_count(), count);
  HardCase c("28", std::to_string(steps) + " steps at rest, 80 particles in a hammock of light cloth");
  c.equal("findings of the auditor", findings, 0);
  c.above("pairs audited", static_cast<double>(pairs), 10000);
  c.below("kinetic energy, of a fall by dx", energy_after / fall, 1);
  c.below("kinetic energy, of that after settling", energy_after / energy_before, 1.5);
  c.below("drift [dx]", drift / dx, 1);
  c.below("momentum residual, of gravity's", ledger, 1e-10);
  c.below_on_any_machine("growth of memory [MB]", memory_grown, 1);
}

TEST(HardFluid, spray_is_ballistic) {
  HardCase c("29", "60 single particles and pairs in free flight, 300 steps, all solvers");
  double worst = 0, pressure = 0;
  for (PressureSolver solver : all_solvers)
    for (bool mirrored : {false, true}) {
      if (mirrored && solver == PressureSolver::mcg03) continue;
      FluidSettings fluid = solver_of(solver, mirrored);
      fluid.viscosity = 0, fluid.xsph_rate = 0;  // a pair that is sheared is not ballistic with them
      World w(world_of(50), fluid);
      StaticMesh floor;  // far below
      floor.add_rectangle(Vec3(-40, -40, -40), Vec3(80, 0, 0), Vec3(0, 0, 80));
      SurfaceId id;
      ASSERT_TRUE(w.attach(floor, sheet_settings(), &id).ok());
      Random random(29);
      std::vector<Vec3> x, v;
      for (int k = 0; k < 60; ++k) {
        x.push_back(Vec3(0.5 * (k % 8), 0.5 * (k / 8), 0.1 * random.uniform()));
        v.push_back(random.in_cube(3));
        if (k % 3 != 0) continue;
        x.push_back(x.back() + random.direction() * random.uniform(0.3, 2.2) * dx);  // a pair
        v.push_back(k % 2 ? v.back() : Vec3(v.back() + random.in_cube(0.5)));
      }
      ASSERT_TRUE(w.add_particles(x, v).ok());
      const double dt = 1e-3;
      const int steps = 300;
      for (int k = 0; k < steps; ++k) {
        ASSERT_TRUE(w.step(dt).status.ok());
        for (double p : w.pressures()) pressure = std::max(pressure, std::abs(p));
      }
      ASSERT_EQ(w.particle_count(), x.size());
      for (std::size_t i = 0; i < w.particle_count(); ++i) {
        const std::size_t k = w.ids()[i] - 1;
        const Vec3 gravity(0, -g, 0);
        const Vec3 speed = v[k] + steps * dt * gravity;
        // Symplectic Euler: the sum of the velocities of all steps.
        const Vec3 place = x[k] + steps * dt * v[k] + 0.5 * steps * (steps + 1) * dt * dt * gravity;
        worst = std::max({worst, (w.velocities()[i] - speed).norm() / speed.norm(),
                          (w.positions()[i] - place).norm() / (place - x[k]).norm()});
      }
    }
  c.below("distance from the parabola, relative", worst, 1e-12);
  c.at_most("largest pressure [Pa]", pressure, 0);
}

TEST(HardFluid, a_sheet_between_equal_waters_stays_where_it_is) {
  HardCase c("41", "a light sheet, pinned on its rim, in the middle of water at rest");
  constexpr int nx = 6, layers = 10, nz = 6;
  World w(world_of(0.5), solver_of(PressureSolver::pcisph, true));
  const Vec3 x(2 * nx * dx, 0, 0), y(0, 0.1, 0), z(0, 0, nz * dx);
  StaticMesh box;
  box.add_rectangle(Vec3::Zero(), x, z, 6, 3);
  for (const Vec3& at : {Vec3(Vec3::Zero()), x}) box.add_rectangle(at, y, z, 10, 3);
  for (const Vec3& at : {Vec3(Vec3::Zero()), z}) box.add_rectangle(at, x, y, 6, 10);
  // Pinned on its rim, which lies in the walls; free and light inside.
  MockCloth<double> sheet(GridShape{11, 7, Vec3(nx * dx, 0, 0), y, z, 0.3});
  sheet.gravity = Vec3(0, -g, 0);
  sheet.stiffness = 500;
  sheet.damping = 0.1;
  for (std::size_t i = 0; i < sheet.x.size(); ++i)
    if (i % 11 == 0 || i % 11 == 10 || i / 11 == 0 || i / 11 == 6) sheet.pin(i);
  SurfaceId box_id, sheet_id;
  ASSERT_TRUE(w.attach(box, sheet_settings(), &box_id).ok());
  ASSERT_TRUE(w.attach(sheet, sheet_settings(), &sheet_id).ok());
  fill(w, lattice(2 * nx, layers, nz, Vec3::Constant(0.5 * dx)));
  TraceWatch watch;
  w.set_observer(&watch);
  double displacement = 0, impulse = 0, time = 0, fastest_node = 0;
  while (w.time() < 0.3) {
    const StepReport& r = w.step(1e-3);
    ASSERT_TRUE(r.status.ok());
    ASSERT_LE(r.momentum_residual().norm(), 1e-12);
    if (w.time() < 0.15) continue;
    time += 1e-3;
    const SurfaceMotion& s = *w.surface(sheet_id);
    for (std::size_t i = 0; i < s.x_t1.size(); ++i) {
      displacement = std::max(displacement, std::abs(s.x_t1[i].x() - nx * dx));
      impulse += s.impulse[i].x();
      if (s.inverse_mass[i] > 0) fastest_node = std::max(fastest_node, s.velocity[i].norm());
    }
  }
  w.set_observer(nullptr);
  EXPECT_EQ(w.particle_count(), std::size_t{2 * nx * layers * nz});
  const double one_side = 0.5 * 1000 * g * std::pow(layers * dx, 2) * nz * dx;
  c.equal("findings of the auditor", watch.judge().findings(), 0);
  c.below("displacement [dx]", displacement / dx, 0.5);
  c.below("force, of one side's", std::abs(impulse / time) / one_side, 0.02);
}

TEST(HardFluid, an_emitter_inside_cloth_waits) {
  HardCase c("45", "a nozzle, a box and rain that start in a sheet, which is taken away later");
  WorldSettings settings = world_of(0.5);
  World w(settings);
  MockCloth<double> cloth(GridShape{21, 21, Vec3(-0.1, 0, -0.1), Vec3(0.2, 0, 0), Vec3(0, 0, 0.2)});
  for (std::size_t i = 0; i < cloth.x.size(); ++i) cloth.pin(i);
  cloth.pins_holdable = false;  // its owner takes it away
  SurfaceId id;
  ASSERT_TRUE(w.attach(cloth, sheet_settings(), &id).ok());
  DiscEmitter jet;
  jet.center = Vec3(0.001, 1e-9, 0.002);
  jet.radius = 0.01;
  jet.direction = Vec3(0, 1, 0);
  BoxEmitter box;
  box.box = {Vec3(0.05, -0.0125, 0.05), Vec3(0.075, 0.0125, 0.075)};  // the sheet is its middle layer
  RainEmitter rain;
  rain.corner = Vec3(-0.09, 0, -0.09);
  rain.edge_u = Vec3(0.05, 0, 0);
  rain.edge_v = Vec3(0, 0, 0.05);
  ASSERT_TRUE(w.add_emitter(jet).ok());
  ASSERT_TRUE(w.add_emitter(box).ok());
  ASSERT_TRUE(w.add_emitter(rain).ok());
  TraceWatch watch;
  w.set_observer(&watch);
  std::uint64_t blocked = 0, emitted = 0, later = 0;
  for (int k = 0; k < 60; ++k) {
    if (k >= 30)
      for (auto& x : cloth.x) x.y() -= 0.0005;
    const StepReport& r = w.step(1e-3);
    ASSERT_TRUE(r.status.ok());
    blocked += r.blocked_starts;
    (k < 30 ? emitted : later) += r.emitted;
  }
  w.set_observer(nullptr);
  c.equal("findings of the auditor", watch.judge().findings(), 0);
  // Those of the box outside the sheet; none of the jet and the rain.
  c.equal("started beside the sheet", emitted, 100);
  c.above("starts blocked", static_cast<double>(blocked), 300);
  c.above("started after the sheet was taken away", static_cast<double>(later), 25);
}

}  // namespace
}  // namespace oilskin::test
