// Hard case 54: a fold that closes on honey.
#include <gtest/gtest.h>

#include <cmath>

#include "hard_cases/hard_case.h"
#include "hard_cases/water.h"
#include "oilskin/implicit_viscosity.h"
#include "support/static_mesh.h"
#include "support/trace_watch.h"
#include "support/world_helpers.h"

namespace oilskin::test {
namespace {

using namespace water;

/// Two sheets with a common edge, which close like a book.
class Fold : public StaticMesh {
 public:
  static constexpr double length = 0.08, half_width = 0.05;  // [m]
  double angle = 0.9, rate = 0;                              // of a sheet from the vertical [rad], [rad/s]

  Fold() { place(); }
  Gathered gather(double dt, SurfaceMotion& m) override {
    const std::vector<Vec3> before = nodes;
    angle -= dt * rate;
    place();
    Gathered gathered = StaticMesh::gather(dt, m);
    for (std::size_t i = 0; i < nodes.size() && dt > 0; ++i) m.velocity[i] = (nodes[i] - before[i]) / dt;
    return gathered;
  }

 private:
  void place() {
    nodes.clear(), triangles.clear();
    const Vec3 along(0, 0, 2 * half_width), corner(0, 0, -half_width);
    for (double side : {-1.0, 1.0})
      add_rectangle(corner, length * Vec3(side * std::sin(angle), std::cos(angle), 0), along, 8, 10);
  }
};

std::vector<Vec3> between(const Fold& fold, double spacing, double top) {
  std::vector<Vec3> inside;
  const Vec3 normal(std::cos(fold.angle), -std::sin(fold.angle), 0);  // of the right sheet, outwards
  for (const Vec3& x : lattice(40, 14, 12, Vec3(-19.5 * spacing, 0.5 * spacing, -5.5 * spacing), spacing))
    if (std::max(normal.dot(x), normal.dot(Vec3(-x.x(), x.y(), 0))) < -0.5 * spacing && x.y() < top)
      inside.push_back(x);
  return inside;
}

TEST(HardFluid, a_fold_that_closes_on_honey_squeezes_it_out) {
  HardCase c("54",
             "a V of two sheets without slip, full of honey (ν = 0.1 and 1 m²/s), closes from 103° to 17°");
  const double open = 0.9, closed = 0.15, seconds = 0.3;
  double speed = 0, energy = 0, risen = 0, residual = 0, applied = 1;
  std::uint64_t findings = 0, pairs = 0, lost = 0, unconverged = 0;
  for (double nu : {0.1, 1.0}) {
    FluidSettings fluid = solver_of(PressureSolver::dfsph, true);
    fluid.viscosity = 0;
    fluid.xsph_rate = 0;
    fluid.max_substeps = 8;
    World w(world_of(0.5), fluid);
    ImplicitViscosity viscosity({nu});
    ASSERT_TRUE(w.add_effect(viscosity).ok());
    Fold fold;
    SurfaceSettings sheet = sheet_settings(0.001);
    sheet.slip.model = SlipModel::viscous_wall;
    ASSERT_TRUE(w.attach(fold, sheet, nullptr).ok());
    fill(w, between(fold, dx, 0.04));
    const std::size_t count = w.particle_count();
    ASSERT_GT(count, 300u);
    fold.rate = (open - closed) / seconds;
    TraceWatch watch;
    w.set_observer(&watch);
    for (int k = 0; w.time() < seconds - 1e-9; ++k) {
      const StepReport& r = w.step(1e-3);
      ASSERT_TRUE(r.status.ok());
      speed = std::max(speed, fastest(w));
      risen = std::max(risen, r.energy.risen / r.energy.scale);
      residual = std::max(residual, r.momentum_residual().norm());
      applied = std::min(applied, viscosity.report().applied);
      unconverged += !viscosity.report().converged;
      if (k % 20 != 19) continue;
      const audit::Summary s = watch.judge();
      findings += s.findings();
      pairs += s.pairs;
    }
    w.set_observer(nullptr);
    energy = std::max(energy, kinetic_energy(w));
    lost += count - w.particle_count();
  }
  c.equal("findings of the auditor", findings, 0);
  c.above("pairs audited", static_cast<double>(pairs), 1000);
  c.equal("particles lost", lost, 0);
  c.below("largest speed [m/s]", speed, 2);
  c.note("kinetic energy at the end [J]", energy);
  c.at_most("energy made in 0.2 s, of the scale", risen, 0.1);
  c.below("momentum residual [N s]", residual, 1e-10);
  c.equal("steps whose viscosity did not converge", unconverged, 0);
  c.above("smallest part of the viscous forces that acted", applied, 0.99);
}

}  // namespace
}  // namespace oilskin::test
