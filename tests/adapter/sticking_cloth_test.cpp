// Dry friction of water on Bullet's cloth, which pulls its nodes back after each step (C.43).
#include <gtest/gtest.h>

#include <cmath>

#include "game.h"
#include "support/record.h"

namespace oilskin::bullet {
namespace {

using namespace test;

/// Mean speed [m/s] downhill, from 0.5 s to 0.6 s, of a layer of water on a sheet that is pinned at its
/// border. Gravity has an angle of 30° to its normal.
double creep(const SlipSettings& slip, BoundaryModel boundary, double dt) {
  constexpr double dx = 0.008, angle = 0.5235987755982988;
  constexpr int nodes = 25;
  FluidSettings fluid;
  fluid.spacing = dx;
  fluid.boundary = boundary;
  Game game(1, fluid);
  const btVector3 gravity(bt(9.81 * std::sin(angle)), bt(-9.81 * std::cos(angle)), 0);
  game.bullet.world.setGravity(gravity);
  game.bullet.world.getWorldInfo().m_gravity = gravity;
  btSoftBody* const cloth = game.bullet.patch(nodes, 0.3, 0, 0, 0.2 * 0.09);
  for (int k = 0; k < nodes; ++k)
    for (int i : {k, k + nodes * (nodes - 1), nodes * k, nodes * k + nodes - 1}) cloth->setMass(i, 0);
  cloth->m_cfg.piterations = 10;
  EXPECT_TRUE(game.solver.addCloth(cloth, bt(0.2 * dx), slip).ok());
  EXPECT_TRUE(game.water.addBox({bt(-0.1), bt(0.004), bt(-0.032)}, {bt(-0.036), bt(0.02), bt(0.032)}).ok());
  const auto mean_x = [&] {
    const Span<const Vec3> x = game.water.getWorld().positions();
    double sum = 0;
    for (const Vec3& p : x) sum += p.x();
    return sum / static_cast<double>(x.size());
  };
  double start = 0;
  const int steps = static_cast<int>(std::lround(0.6 / dt)), from = static_cast<int>(std::lround(0.5 / dt));
  for (int k = 0; k < steps; ++k) {
    if (k == from) start = mean_x();
    game.bullet.step(dt);
    const StepReport& r = game.solver.getReport();
    EXPECT_TRUE(r.status.ok()) << r.status.message;
    EXPECT_LT(r.momentum_residual().norm(), 1e-6);
  }
  return (mean_x() - start) / ((steps - from) * dt);
}

// Where nodes yield by their masses alone it creeps with 0.10 to 0.11 m/s at 1 ms, 0.025 to 0.044 at 1/240 s.
TEST(StickingCloth, water_does_not_creep) {
  const SlipSettings sticks{SlipModel::sticking, 0, 0}, rough{SlipModel::coulomb, 1, 0};
  for (const SlipSettings& slip : {sticks, rough})
    for (const BoundaryModel boundary : {BoundaryModel::mirrored, BoundaryModel::contact_only})
      for (const double dt : {1e-3, 1.0 / 240}) {
        const double speed = creep(slip, boundary, dt);
        std::ostringstream name;
        name << (slip.model == SlipModel::sticking ? "sticking" : "Coulomb")
             << (boundary == BoundaryModel::mirrored ? ", mirrored, " : ", contact alone, ") << dt;
        oilskin::test::record(name.str(), speed);
        EXPECT_LT(std::abs(speed), dt < 2e-3 ? 0.04 : 0.02) << name.str();
      }
}

}  // namespace
}  // namespace oilskin::bullet
