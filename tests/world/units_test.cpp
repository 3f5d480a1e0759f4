// A world in another unit of length does what it does in metres.
#include <gtest/gtest.h>

#include <cmath>

#include "support/record.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin {
namespace {

/// Of water that starts compressed in an open box, after 0.1 s.
struct Settled {
  double density_error = 0, height = 0;  ///< means [1], [dx]
};

/// `unit`: units of length in a metre.
Settled settle(double unit, PressureSolver solver, BoundaryModel boundary) {
  constexpr int n = 8;
  const double dx = 0.01 * unit;
  FluidSettings fluid;
  fluid.spacing = dx;
  fluid.rest_density = 1000 / std::pow(unit, 3);
  fluid.viscosity = 1e-6 * unit * unit;
  fluid.solver = solver;
  fluid.boundary = boundary;
  WorldSettings settings;
  settings.gravity = Vec3(0, -9.81 * unit, 0);
  settings.kill_box = {Vec3::Constant(-unit), Vec3::Constant(unit)};
  World w(settings, fluid);
  test::StaticMesh box;
  box.add_box({Vec3::Zero(), Vec3(n * dx, 3 * n * dx, n * dx)}, 2 * dx);
  EXPECT_TRUE(w.attach(box, test::sheet_settings(0.2 * dx), nullptr).ok());
  std::vector<Vec3> x;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) x.push_back(dx * Vec3(i + 0.5, 0.95 * j + 0.5, k + 0.5));
  std::uint64_t blocked = 0;
  EXPECT_TRUE(w.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero()), &blocked).ok());
  Settled result;
  constexpr int steps = 50;
  for (int k = 0; k < steps; ++k) {
    const StepReport& r = w.step(0.002);
    EXPECT_TRUE(r.status.ok()) << r.status.message;
    result.density_error += r.fluid.density_error_mean / steps;
  }
  for (const Vec3& p : w.positions()) result.height += p.y() / (dx * double(x.size()));
  return result;
}

// Corrections of compression have speeds in m/s: how long a metre is, gravity shows (F.18, B.30). With a
// power of two nothing is rounded otherwise than in metres.
TEST(Units, of_another_length_give_what_metres_do) {
  for (const PressureSolver solver : {PressureSolver::pcisph, PressureSolver::dfsph})
    for (const BoundaryModel boundary : {BoundaryModel::mirrored, BoundaryModel::contact_only}) {
      const Settled metres = settle(1, solver, boundary), other = settle(128, solver, boundary);
      test::record("density error", metres.density_error);
      EXPECT_NEAR(other.density_error, metres.density_error, 1e-9);
      EXPECT_NEAR(other.height, metres.height, 1e-9);
    }
}

}  // namespace
}  // namespace oilskin
