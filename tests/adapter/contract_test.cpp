// The contract of hosts on Bullet's soft body, in the precision that this file is compiled for, in steps and
// in sub-steps; that of levels on Bullet's collision objects; that of bodies on Bullet's rigid bodies.
#include "support/contract_suite.h"

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

#include "adapter/bullet_world.h"
#include "bullet_adapter/collision_object_host.h"
#include "oilskin/bullet.h"
#include "support/body_contract.h"
#include "support/level_contract.h"

namespace oilskin::test {
namespace {

template <int max_substeps>
class BulletFixture {
 public:
  static constexpr bool is_double = bullet::test::is_double;
  static constexpr int nodes = 17;

  BulletFixture()
      : fluid_(contract_fluid(max_substeps), contract_world(), contract_contact()),
        bullet_(btVector3(0, 0, 0), &solver_) {
    cloth_ = bullet_.patch(nodes, 0.2, 0, 0, 0.2 * 0.04);
    EXPECT_TRUE(solver_.addFluid(&fluid_).ok());
  }

  World& world() { return fluid_.getWorld(); }
  Status attach(const SurfaceSettings& s) { return solver_.addCloth(cloth_, s); }
  void pin(int i, int j) { cloth_->setMass(i + nodes * j, 0); }
  void move_pin(int i, int j, const Vec3& by) { cloth_->m_nodes[i + nodes * j].m_x += bullet::to_bt(by); }
  void step(double dt) { bullet_.step(dt); }
  Vec3 momentum() const { return bullet::test::momentum(*cloth_); }
  Vec3 position(int i, int j) const { return bullet::to_vec3(cloth_->m_nodes[i + nodes * j].m_x); }
  SurfaceId id() const { return SurfaceId{1}; }

 private:
  bullet::btFluid fluid_;
  bullet::btFluidSoftBodySolver solver_;
  bullet::test::SoftWorld bullet_;
  btSoftBody* cloth_ = nullptr;
};

using Hosts = ::testing::Types<BulletFixture<1>, BulletFixture<6>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Bullet, HostContract, Hosts);

/// A shape as a collision object.
class BulletLevel {
 public:
  SurfaceHost& host() { return *host_; }
  void move(const Vec3& by) {
    btTransform t = object_.getWorldTransform();
    t.setOrigin(t.getOrigin() + bullet::to_bt(by));
    object_.setWorldTransform(t);
  }

 protected:
  void place(btCollisionShape* shape) {
    object_.setCollisionShape(shape);
    host_ = std::make_unique<bullet::CollisionObjectHost>(&object_, contract_world().kill_box);
  }

 private:
  btCollisionObject object_;
  std::unique_ptr<bullet::CollisionObjectHost> host_;
};

class HeightFieldLevel : public BulletLevel {
 public:
  HeightFieldLevel()
      : heights_(16 * 16, 0),
        field_(16, 16, static_cast<const void*>(heights_.data()), 1, -1, 1, 1, PHY_FLOAT, false) {
    field_.setLocalScaling(btVector3(btScalar(0.02), 1, btScalar(0.02)));
    place(&field_);
  }

 private:
  std::vector<btScalar> heights_;
  btHeightfieldTerrainShape field_;
};

class MeshLevel : public BulletLevel {
 public:
  MeshLevel() {
    const auto at = [](int i, int j) {
      return btVector3(btScalar(0.02 * i - 0.15), 0, btScalar(0.02 * j - 0.15));
    };
    for (int i = 0; i < 15; ++i)
      for (int j = 0; j < 15; ++j) {
        mesh_.addTriangle(at(i, j), at(i, j + 1), at(i + 1, j + 1));
        mesh_.addTriangle(at(i, j), at(i + 1, j + 1), at(i + 1, j));
      }
    shape_ = std::make_unique<btBvhTriangleMeshShape>(&mesh_, true);
    place(shape_.get());
  }

 private:
  btTriangleMesh mesh_;
  std::unique_ptr<btBvhTriangleMeshShape> shape_;
};

using Levels = ::testing::Types<HeightFieldLevel, MeshLevel>;
INSTANTIATE_TYPED_TEST_SUITE_P(Bullet, LevelContract, Levels);

template <int max_substeps>
class BulletBodyFixture {
 public:
  static constexpr bool is_double = bullet::test::is_double;

  BulletBodyFixture()
      : fluid_(contract_fluid(max_substeps), contract_world(), contract_contact()),
        bullet_(btVector3(0, 0, 0), &solver_),
        shape_(btVector3(1, 1, 1) * btScalar(body_half)) {
    btVector3 inertia(0, 0, 0);
    shape_.calculateLocalInertia(btScalar(body_mass), inertia);
    body_ = std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(btScalar(body_mass), nullptr, &shape_, inertia));
    body_->setLinearVelocity(bullet::to_bt(body_velocity()));
    body_->setAngularVelocity(bullet::to_bt(body_spin()));
    bullet_.world.addRigidBody(body_.get());
    EXPECT_TRUE(solver_.addFluid(&fluid_).ok());
  }
  ~BulletBodyFixture() {
    solver_.removeRigidBody(body_.get());
    bullet_.world.removeRigidBody(body_.get());
  }

  World& world() { return fluid_.getWorld(); }
  Status attach() { return solver_.addRigidBody(body_.get(), sheet_settings()); }
  void lock_height() {
    body_->setLinearFactor(btVector3(1, 0, 1));
    body_->setAngularFactor(0);
  }
  void step(double dt) { bullet_.step(dt); }
  Vec3 velocity() const { return bullet::to_vec3(body_->getLinearVelocity()); }
  Vec3 spin() const { return bullet::to_vec3(body_->getAngularVelocity()); }
  Vec3 center() const { return bullet::to_vec3(body_->getCenterOfMassPosition()); }
  Eigen::Matrix3d inverse_inertia() const {
    Eigen::Matrix3d all;
    for (int row = 0; row < 3; ++row)
      all.row(row) = bullet::to_vec3(body_->getInvInertiaTensorWorld().getRow(row));
    return all;
  }
  SurfaceId id() const { return SurfaceId{1}; }

 private:
  bullet::btFluid fluid_;
  bullet::btFluidSoftBodySolver solver_;
  bullet::test::SoftWorld bullet_;
  btBoxShape shape_;
  std::unique_ptr<btRigidBody> body_;
};

using Bodies = ::testing::Types<BulletBodyFixture<1>, BulletBodyFixture<6>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Bullet, BodyContract, Bodies);

}  // namespace
}  // namespace oilskin::test
