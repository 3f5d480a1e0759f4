// The contract of hosts on Bullet's soft body, in the precision that this file is compiled for, in steps and
// in sub-steps; that of levels on Bullet's collision objects.
#include "support/contract_suite.h"

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

#include "adapter/bullet_world.h"
#include "bullet_adapter/collision_object_host.h"
#include "oilskin/bullet.h"
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

}  // namespace
}  // namespace oilskin::test
