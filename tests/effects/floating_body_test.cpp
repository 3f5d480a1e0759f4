// A body that floats stays where it floats, whatever the friction between it and the liquid.
#include <gtest/gtest.h>

#include <algorithm>

#include "effects/honey_world.h"
#include "support/mock_body.h"

namespace oilskin {
namespace {

using namespace test;

constexpr double dx = 0.01, edge = 6 * dx;
constexpr int across = 14, depth = 10;

/// A cube of half the density of the liquid, half below its surface, in a tank.
class FloatingCube {
 public:
  FloatingCube(SlipModel slip, double nu, double density = 500)
      : world_(world_of(Vec3(0, -gravity, 0)), liquid()), honey_({nu > 0 ? nu : 1}) {
    const double half = 0.5 * across * dx;
    tank_.add_box({Vec3(-half, 0, -half), Vec3(half, 2 * depth * dx, half)}, 2 * dx);
    body_.half = Vec3::Constant(edge / 2);
    body_.center = Vec3(0, depth * dx, 0);
    body_.mass = density * edge * edge * edge;
    body_.gravity = world_.settings().gravity;
    EXPECT_TRUE(world_.attach(tank_, sheet(SlipModel::viscous_wall, 0.2 * dx), nullptr).ok());
    EXPECT_TRUE(world_.attach(body_, sheet(slip, 0.2 * dx), nullptr).ok());
    if (nu > 0) {
      EXPECT_TRUE(world_.add_effect(honey_).ok());
    }
    std::vector<Vec3> x = lattice(across, depth, across, dx, Vec3(-half, 0, -half));
    const auto is_taken = [&](const Vec3& p) {
      return (p - body_.center).cwiseAbs().maxCoeff() < edge / 2 + 0.3 * dx;
    };
    x.erase(std::remove_if(x.begin(), x.end(), is_taken), x.end());
    fill(world_, x, at_rest);
  }

  /// How far it has risen after a time [m].
  double rise_after(double seconds, double dt) {
    const double start = body_.center.y();
    while (world_.time() < seconds - 0.5 * dt) {
      const StepReport& r = world_.step(dt);
      EXPECT_TRUE(r.status.ok());
      EXPECT_LT(r.momentum_residual().norm(), 1e-12);
    }
    return body_.center.y() - start;
  }

 private:
  static FluidSettings liquid() {
    FluidSettings s = of_spacing(dx);
    s.viscosity = 1e-6;
    return s;
  }

  StaticMesh tank_;
  MockBody body_;
  World world_;
  ImplicitViscosity honey_;
};

// The host adds gravity to the body after the liquid has lifted it. Where friction does not count that, the
// body sinks by 2.3 cm in the first second in honey, 2.4 cm where water sticks, 0.7 cm by Coulomb's law.
TEST(FloatingBody, friction_does_not_drag_it_down) {
  const std::pair<SlipModel, double> cases[] = {
      {SlipModel::viscous_wall, 0.05}, {SlipModel::sticking, 0}, {SlipModel::coulomb, 0}};
  for (const auto& [slip, nu] : cases) {
    const double rise = FloatingCube(slip, nu).rise_after(1, 1.0 / 120);
    record(nu > 0 ? "honey" : slip == SlipModel::sticking ? "sticking" : "Coulomb", rise / dx);
    EXPECT_LT(std::abs(rise), 0.5 * dx);
  }
}

// Viscosity sees velocities before pressure holds the liquid: without (V.12) honey hangs on its tank, and
// presses on a body with less than its weight.
TEST(FloatingBody, honey_carries_it_at_every_step) {
  for (const double dt : {1.0 / 60, 1.0 / 240}) {
    const double rise = FloatingCube(SlipModel::viscous_wall, 0.05).rise_after(0.5, dt);
    record("rise", rise / dx);
    EXPECT_LT(std::abs(rise), 0.6 * dx);
  }
}

}  // namespace
}  // namespace oilskin
