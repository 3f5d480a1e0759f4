// The contract of hosts on Bullet's soft body, in the precision that this file is compiled for, in steps and
// in sub-steps.
#include "support/contract_suite.h"

#include "adapter/bullet_world.h"
#include "oilskin/bullet.h"

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

}  // namespace
}  // namespace oilskin::test
