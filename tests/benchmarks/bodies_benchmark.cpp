// A tank of 1 m with 9,375 particles of 4 cm, and boxes or balls of 6 cm that are attached to the water:
// 2.5 m away from it, or dropped into it. Prints milliseconds per step of 1/60 s, the mean of the second half
// of the steps.
//
// use: bodies_benchmark [bodies = 100] [far | in = far] [static | dynamic = static] [steps = 40]
//                       [boxes | balls = boxes]
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "oilskin/bullet.h"

namespace {

void expect(const oilskin::Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "%s\n", status.message.c_str());
  std::exit(2);
}

class Scene {
 public:
  Scene(int bodies, bool in_water, bool dynamic, bool round) {
    world_.setGravity(btVector3(0, btScalar(-9.81), 0));
    expect(solver_.addFluid(&water_));
    const btScalar t = btScalar(0.1), half = btScalar(0.5), wide = half + t;
    add_box({wide, t / 2, wide}, 0, {0, -t / 2, 0});
    for (const btScalar side : {btScalar(-1), btScalar(1)}) {
      add_box({t / 2, half, half}, 0, {side * (half + t / 2), half, 0});
      add_box({wide, half, t / 2}, 0, {0, half, side * (half + t / 2)});
    }
    const btScalar size = btScalar(0.03), mass = dynamic ? btScalar(0.1) : btScalar(0);
    if (!in_water && dynamic) ground();
    for (int i = 0; i < bodies; ++i) {
      const btScalar x = btScalar(i % 10), y = btScalar(i / 100), z = btScalar(i / 10 % 10);
      const btVector3 at =
          in_water ? btVector3(btScalar(0.1) * x - btScalar(0.45), btScalar(0.1) * y + btScalar(0.62),
                               btScalar(0.1) * z - btScalar(0.45))
                   : btVector3(btScalar(0.2) * x + 3, btScalar(0.2) * y + btScalar(0.051), btScalar(0.2) * z);
      if (round)
        add(std::make_unique<btSphereShape>(size), mass, at);
      else
        add_box({size, size, size}, mass, at);
    }
    expect(water_.addBox({-half, 0, -half}, {half, btScalar(0.6), half}));
  }

  ~Scene() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }

  /// One step. Returns its wall time [s].
  double step() {
    const auto start = std::chrono::steady_clock::now();
    world_.stepSimulation(btScalar(1) / 60, 0);
    expect(solver_.getReport().status);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  const oilskin::StepReport& report() const { return solver_.getReport(); }
  int particles() const { return water_.getNumParticles(); }

 private:
  btRigidBody* make(std::unique_ptr<btConvexShape> shape, btScalar mass, const btVector3& at) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape.get(), inertia);
    info.m_startWorldTransform.setOrigin(at);
    shapes_.push_back(std::move(shape));
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    world_.addRigidBody(bodies_.back().get());
    return bodies_.back().get();
  }
  static std::unique_ptr<btConvexShape> box(const btVector3& half) {
    auto shape = std::make_unique<btBoxShape>(half);
    shape->setMargin(btScalar(0.001));
    return shape;
  }
  void add(std::unique_ptr<btConvexShape> shape, btScalar mass, const btVector3& at) {
    btRigidBody* const body = make(std::move(shape), mass, at);
    const btScalar thickness = btScalar(0.002);
    expect(mass > 0 ? solver_.addRigidBody(body, thickness) : solver_.addCollisionObject(body, thickness));
  }
  void add_box(const btVector3& half, btScalar mass, const btVector3& at) { add(box(half), mass, at); }
  /// For bodies that are far: the water does not know it.
  void ground() { make(box({5, btScalar(0.05), 5}), 0, {7, btScalar(-0.05), 0}); }

  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver constraints_;
  oilskin::bullet::btFluidSoftBodySolver solver_;
  btSoftRigidDynamicsWorld world_{&dispatcher_, &broadphase_, &constraints_, &configuration_, &solver_};
  oilskin::bullet::btFluid water_{btScalar(0.04)};
  std::vector<std::unique_ptr<btConvexShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

}  // namespace

int main(int argc, char** argv) {
  const int bodies = argc > 1 ? std::atoi(argv[1]) : 100, steps = argc > 4 ? std::atoi(argv[4]) : 40;
  const bool in_water = argc > 2 && std::string(argv[2]) == "in",
             dynamic = argc > 3 && std::string(argv[3]) == "dynamic",
             round = argc > 5 && std::string(argv[5]) == "balls";
  if (bodies < 0 || steps < 2) return std::fprintf(stderr, "bodies >= 0 and steps >= 2\n"), 2;
  Scene scene(bodies, in_water, dynamic, round);
  double seconds = 0;
  oilskin::StageSeconds stages;
  const int counted = steps - steps / 2;
  for (int k = 0; k < steps; ++k) {
    const double s = scene.step();
    if (k < steps / 2) continue;
    seconds += s;
    stages += scene.report().seconds;
  }
  const auto ms = [&](double s) { return 1e3 * s / counted; };
  std::printf("%d %s %s %s, %d particles: %.1f ms a step, %d sub-steps in the last one\n", bodies,
              dynamic ? "dynamic" : "static", round ? "balls" : "boxes",
              in_water ? "in the water" : "far away", scene.particles(), ms(seconds),
              scene.report().substeps);
  std::printf(
      "  pressure %.1f, boundary %.1f, hidden neighbours %.1f, proximity %.2f, continuous test %.2f, gather "
      "%.2f\n",
      ms(stages.pressure), ms(stages.boundary), ms(stages.occlusion), ms(stages.proximity), ms(stages.ccd),
      ms(stages.gather));
  return 0;
}
