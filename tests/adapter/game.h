/// A small game for the tests: a world whose soft-body solver couples a fluid.
#pragma once

#include <string>

#include "bullet_world.h"
#include "oilskin/bullet.h"

namespace oilskin::bullet::test {

inline WorldSettings with_threads(int threads) {
  WorldSettings world = small_world();
  world.threads = threads;
  return world;
}

struct Game {
  btFluidSoftBodySolver solver;
  SoftWorld bullet{btVector3(0, bt(-9.81), 0), &solver};
  btFluid water;

  explicit Game(int threads = 1, const FluidSettings& fluid = coarse_fluid())
      : water(fluid, with_threads(threads), ContactSettings{}) {
    EXPECT_TRUE(solver.addFluid(&water).ok());
  }

  /// A block of 0.16 × 0.08 × 0.16 m above y.
  Status pour(double y = 0.03) {
    return water.addBox({bt(-0.08), bt(y), bt(-0.08)}, {bt(0.08), bt(y + 0.08), bt(0.08)});
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) bullet.step(0.001);
  }
  std::string messages() {
    std::string all;
    for (const std::string& message : solver.takeMessages()) all += message + "\n";
    return all;
  }
};

/// A thin box of 0.4 × 0.4 m whose top is at y.
struct Plate {
  btBoxShape shape{btVector3(bt(0.2), bt(0.02), bt(0.2))};
  btCollisionObject object;

  explicit Plate(double y = 0) {
    object.setCollisionShape(&shape);
    object.setWorldTransform(btTransform(btQuaternion::getIdentity(), {0, bt(y - 0.02), 0}));
  }
};

/// A tank with a floor at y = 0, 0.2 m wide, whose walls are higher than the water of Game.
struct Tank {
  btCompoundShape shape;
  btBoxShape side{btVector3(bt(0.02), bt(0.1), bt(0.14))}, front{btVector3(bt(0.14), bt(0.1), bt(0.02))},
      floor{btVector3(bt(0.14), bt(0.02), bt(0.14))};
  btCollisionObject object;

  Tank() {
    add(floor, 0, -0.02, 0);
    for (const double s : {-0.12, 0.12}) {
      add(side, s, 0.08, 0);
      add(front, 0, 0.08, s);
    }
    object.setCollisionShape(&shape);
  }

 private:
  void add(btBoxShape& box, double x, double y, double z) {
    shape.addChildShape(btTransform(btQuaternion::getIdentity(), {bt(x), bt(y), bt(z)}), &box);
  }
};

inline bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

}  // namespace oilskin::bullet::test
