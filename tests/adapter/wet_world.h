/// A Bullet world with water and rigid bodies. Compiled in both precisions.
#pragma once

#include <gtest/gtest.h>

#include "bullet_world.h"
#include "oilskin/bullet.h"

namespace oilskin::bullet::test {

inline const btVector3 down(0, bt(-9.81), 0);

/// A world with water of 1 cm, without gravity unless it is given.
class WetWorld {
 public:
  explicit WetWorld(const btVector3& gravity = btVector3(0, 0, 0))
      : bullet(gravity, &solver), water(fluid(), world_of(gravity), verified()) {
    EXPECT_TRUE(solver.addFluid(&water).ok());
  }
  ~WetWorld() {
    for (auto& b : bodies_) bullet.world.removeRigidBody(b.get());
  }

  btRigidBody* add(btCollisionShape* shape, double mass, const btVector3& at) {
    shapes_.emplace_back(shape);
    shape->setMargin(bt(0.001));
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(bt(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(bt(mass), nullptr, shape, inertia);
    info.m_startWorldTransform.setOrigin(at);
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bullet.world.addRigidBody(bodies_.back().get());
    return bodies_.back().get();
  }
  btRigidBody* add_box(double mass, const btVector3& half, const btVector3& at) {
    return add(new btBoxShape(half), mass, at);
  }
  /// A square tank, its floor at y = 0.
  void add_tank(double width, double height) {
    const btScalar w = bt(width / 2), h = bt(height / 2), t = bt(0.02);
    std::vector<btRigidBody*> walls = {add_box(0, {w + 2 * t, t, w + 2 * t}, {0, -t, 0})};
    for (btScalar side : {bt(-1), bt(1)}) {
      walls.push_back(add_box(0, {t, h, w + 2 * t}, {side * (w + t), h, 0}));
      walls.push_back(add_box(0, {w, h, t}, {0, h, side * (w + t)}));
    }
    for (btRigidBody* wall : walls) EXPECT_TRUE(solver.addCollisionObject(wall, bt(0.002)).ok());
  }
  /// Fills the box with particles 1 cm apart where `is_free`.
  template <class IsFree>
  void fill(const btVector3& low, const btVector3& high, const IsFree& is_free) {
    std::vector<Vec3> x;
    for (double i = double(low.x()) + 0.005; i < double(high.x()); i += 0.01)
      for (double j = double(low.y()) + 0.005; j < double(high.y()); j += 0.01)
        for (double k = double(low.z()) + 0.005; k < double(high.z()); k += 0.01)
          if (is_free(Vec3(i, j, k))) x.emplace_back(i, j, k);
    EXPECT_TRUE(water.getWorld().add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())).ok());
  }
  /// The same around a box.
  void fill_around(const btVector3& low, const btVector3& high, btRigidBody* body) {
    const btTransform inside = body->getWorldTransform().inverse();
    const btVector3 half = static_cast<btBoxShape*>(body->getCollisionShape())->getHalfExtentsWithoutMargin();
    fill(low, high, [&](const Vec3& x) {
      const btVector3 local = (inside * btVector3(bt(x.x()), bt(x.y()), bt(x.z()))).absolute() - half;
      return local[local.maxAxis()] > bt(0.003);
    });
  }
  void run(double seconds, double dt) {
    for (double t = 0; t < seconds - 1e-9; t += dt) {
      bullet.step(dt);
      const StepReport& r = solver.getReport();
      ASSERT_TRUE(r.status.ok()) << r.status.message;
      ASSERT_EQ(r.contact.crossings_found_by_verify, 0u);
      ASSERT_EQ(r.flags & (flag_leaked | flag_scatter_mismatch | flag_no_promise | flag_surface_refused), 0u);
    }
  }
  Vec3 water_momentum() const {
    Vec3 sum = Vec3::Zero();
    const World& w = water.getWorld();
    for (std::size_t i = 0; i < w.particle_count(); ++i) sum += w.particle_mass() * w.velocities()[i];
    return sum;
  }

  btFluidSoftBodySolver solver;
  SoftWorld bullet;
  btFluid water;

 private:
  static FluidSettings fluid() {
    FluidSettings f;
    f.spacing = 0.01;
    return f;
  }
  static WorldSettings world_of(const btVector3& gravity) {
    WorldSettings w = small_world();
    w.gravity = to_vec3(gravity);
    return w;
  }

  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

}  // namespace oilskin::bullet::test
