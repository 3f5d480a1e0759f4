// The contract of hosts on the mock cloth, in steps and in sub-steps; that of levels on the mock mesh; that
// of bodies on the mock body.
#include "support/body_contract.h"
#include "support/contract_suite.h"
#include "support/level_contract.h"
#include "support/mock_body.h"
#include "support/mock_cloth.h"
#include "support/static_mesh.h"

namespace oilskin::test {
namespace {

template <class Scalar, int max_substeps = 1>
class MockFixture {
 public:
  static constexpr bool is_double = sizeof(Scalar) == 8;

  MockFixture()
      : world_(contract_world(), contract_fluid(max_substeps), contract_contact()), cloth_(grid()) {}

  World& world() { return world_; }
  Status attach(const SurfaceSettings& s) { return world_.attach(cloth_, s, &id_); }
  void pin(int i, int j) { cloth_.pin(node(i, j)); }
  void move_pin(int i, int j, const Vec3& by) { cloth_.x[node(i, j)] += by.cast<Scalar>(); }
  void step(double dt) { world_.step(dt); }
  Vec3 momentum() const { return cloth_.momentum(); }
  Vec3 position(int i, int j) const { return cloth_.x[node(i, j)].template cast<double>(); }
  SurfaceId id() const { return id_; }

 private:
  static GridShape grid() {
    GridShape g;
    g.nu = g.nv = 17;
    g.origin = Vec3(-0.1, 0, -0.1);
    g.u = Vec3(0.2, 0, 0);
    g.v = Vec3(0, 0, 0.2);
    return g;
  }
  static std::size_t node(int i, int j) { return static_cast<std::size_t>(i + 17 * j); }

  World world_;
  MockCloth<Scalar> cloth_;
  SurfaceId id_;
};

using Hosts =
    ::testing::Types<MockFixture<float>, MockFixture<double>, MockFixture<float, 6>, MockFixture<double, 6>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Mock, HostContract, Hosts);

class MockLevel {
 public:
  MockLevel() { mesh_.add_rectangle(Vec3(-0.15, 0, -0.15), Vec3(0, 0, 0.3), Vec3(0.3, 0, 0), 15, 15); }
  SurfaceHost& host() { return mesh_; }
  void move(const Vec3& by) {
    for (Vec3& x : mesh_.nodes) x += by;
  }

 private:
  StaticMesh mesh_;
};

INSTANTIATE_TYPED_TEST_SUITE_P(Mock, LevelContract, MockLevel);

template <int max_substeps>
class MockBodyFixture {
 public:
  static constexpr bool is_double = true;

  MockBodyFixture() : world_(contract_world(), contract_fluid(max_substeps), contract_contact()) {
    body_.mass = body_mass;
    body_.half = Vec3::Constant(body_half);
    body_.velocity = body_velocity();
    body_.spin = body_spin();
  }

  World& world() { return world_; }
  Status attach() { return world_.attach(body_, sheet_settings(), &id_); }
  void lock_height() {
    body_.free_axes.y() = 0;
    body_.turns = false;
  }
  void step(double dt) { world_.step(dt); }
  Vec3 velocity() const { return body_.velocity; }
  Vec3 spin() const { return body_.spin; }
  Vec3 center() const { return body_.center; }
  Eigen::Matrix3d inverse_inertia() const { return body_.inverse_inertia(); }
  SurfaceId id() const { return id_; }

 private:
  World world_;
  MockBody body_;
  SurfaceId id_;
};

using Bodies = ::testing::Types<MockBodyFixture<1>, MockBodyFixture<6>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Mock, BodyContract, Bodies);

}  // namespace
}  // namespace oilskin::test
