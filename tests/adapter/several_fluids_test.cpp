// Several fluids in one coupling: they touch the same objects, and none crosses.
#include <gtest/gtest.h>

#include <BulletCollision/CollisionDispatch/btGhostObject.h>

#include "audited_water.h"
#include "oilskin/bullet_emitter.h"
#include "oilskin/bullet_listener.h"
#include "oilskin/bullet_query.h"

namespace oilskin::bullet {
namespace {

using namespace test;

FluidSettings liquid(double spacing, double rest_density, int max_substeps) {
  FluidSettings f;
  f.spacing = spacing;
  f.rest_density = rest_density;
  f.max_substeps = max_substeps;
  return f;
}

WorldSettings without_gravity() {
  WorldSettings w = small_world();
  w.gravity.setZero();
  return w;
}

/// nx × ny × nx particles, one spacing apart.
void throw_block(btFluid& fluid, const Vec3& corner, const Vec3& velocity, int nx = 5, int ny = 5) {
  std::vector<Vec3> x;
  const double dx = fluid.getWorld().fluid_settings().spacing;
  x.reserve(static_cast<std::size_t>(nx * ny * nx));
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nx; ++k) x.push_back(corner + dx * Vec3(i, j, k));
  ASSERT_TRUE(fluid.getWorld().add_particles(x, std::vector<Vec3>(x.size(), velocity)).ok());
}

/// A cloth held at two edges, water that falls on it, and oil that hits it from below.
struct Scene {
  explicit Scene(int max_substeps = 4)
      : bullet(btVector3(0, 0, 0), &solver),
        cloth(bullet.patch(9, 0.4, 0, 15, 0.1)),
        water(liquid(0.015, 1000, max_substeps), without_gravity(), verified()),
        oil(liquid(0.02, 850, max_substeps), without_gravity(), verified()) {
    EXPECT_TRUE(solver.addFluid(&water).ok());
    EXPECT_TRUE(solver.addCloth(cloth, bt(0.002)).ok());
    EXPECT_TRUE(solver.addFluid(&oil).ok()) << "after the cloth";
  }
  void throw_both() {
    throw_block(water, Vec3(-0.03, 0.01, -0.03), Vec3(0.1, -1, 0));
    throw_block(oil, Vec3(-0.04, -0.1, -0.04), Vec3(0, 1.2, 0.1));
  }
  const btFluidCoupling& coupling() const { return solver.getCoupling(); }
  std::uint64_t hash() const {
    std::uint64_t h = water.getWorld().state_hash() ^ (oil.getWorld().state_hash() << 1);
    for (int i = 0; i < cloth->m_nodes.size(); ++i)
      for (int k = 0; k < 3; ++k) h = h * 31 + std::hash<btScalar>()(cloth->m_nodes[i].m_x[k]);
    return h;
  }

  LedgerSolver solver;
  SoftWorld bullet;
  btSoftBody* cloth;
  btFluid water, oil;
};

TEST(SeveralFluids, none_crosses_and_momentum_is_kept) {
  for (int max_substeps : {1, 6}) {
    Scene s(max_substeps);
    s.throw_both();
    std::uint64_t of_water = 0, of_oil = 0;
    for (int k = 0; k < 80; ++k) {
      s.bullet.step(0.002);
      const StepReport& r = s.solver.getReport();
      ASSERT_TRUE(r.status.ok()) << r.status.message;
      ASSERT_EQ(r.contact.crossings_found_by_verify, 0u) << "step " << k;
      ASSERT_EQ(r.flags & (flag_leaked | flag_no_promise | flag_scatter_mismatch), 0u);
      ASSERT_EQ(r.alive, 250u);
      EXPECT_LE(r.momentum_residual().norm(), 1e-10);
      of_water += s.water.getWorld().contacts().size();
      of_oil += s.oil.getWorld().contacts().size();
    }
    EXPECT_GT(of_water, 100u);
    EXPECT_GT(of_oil, 100u);
    EXPECT_TRUE(s.solver.takeMessages().empty());
  }
}

TEST(SeveralFluids, each_has_its_own_handles_of_the_objects) {
  Scene s;
  btBoxShape shape(btVector3(bt(0.1), bt(0.1), bt(0.1)));
  btCollisionObject first, second;
  for (btCollisionObject* o : {&first, &second}) o->setCollisionShape(&shape);
  first.setWorldTransform(btTransform(btQuaternion::getIdentity(), {1, 0, 0}));
  second.setWorldTransform(btTransform(btQuaternion::getIdentity(), {-1, 0, 0}));
  const btFluidCoupling& c = s.coupling();
  ASSERT_TRUE(s.solver.addCollisionObject(&first, bt(0.002)).ok());
  s.solver.removeFluid(&s.oil);
  ASSERT_TRUE(s.solver.addCollisionObject(&second, bt(0.002)).ok());
  s.solver.removeCollisionObject(&first);
  ASSERT_TRUE(s.solver.addFluid(&s.oil).ok());
  EXPECT_EQ(c.getNumFluids(), 2);
  EXPECT_EQ(c.getFluid(), &s.water);
  EXPECT_EQ(c.getFluid(1), &s.oil);
  EXPECT_EQ(c.getFluid(2), nullptr);
  EXPECT_EQ(c.getFluid(-1), nullptr);
  const SurfaceId in_water = c.getSurfaceId(&second, &s.water), in_oil = c.getSurfaceId(&second, &s.oil);
  EXPECT_EQ(c.getSurfaceId(&second), in_water);
  EXPECT_FALSE(in_water == in_oil) << "water has had another object in between";
  EXPECT_EQ(c.getObject(in_water), &second);
  EXPECT_EQ(c.getObject(in_oil, &s.oil), &second);
  btFluid stranger;
  EXPECT_EQ(c.getSurfaceId(&second, &stranger).value, 0u);
  EXPECT_EQ(c.getObject(in_oil, &stranger), nullptr);
  s.throw_both();
  for (int k = 0; k < 40 && s.oil.getWorld().contacts().empty(); ++k) s.bullet.step(0.002);
  ASSERT_FALSE(s.oil.getWorld().contacts().empty());
  EXPECT_EQ(c.getObject(s.oil.getWorld().contacts()[0].surface, &s.oil), s.cloth);
}

TEST(SeveralFluids, come_and_go_in_any_order) {
  SoftWorld bullet;
  btSoftBody* cloth = bullet.patch(5, 0.4);
  auto water = std::make_unique<btFluid>(liquid(0.02, 1000, 1), without_gravity(), verified());
  auto oil = std::make_unique<btFluid>(liquid(0.02, 850, 1), without_gravity(), verified());
  auto coupling = std::make_unique<btFluidCoupling>(water.get());
  ASSERT_TRUE(coupling->addFluid(oil.get()).ok());
  ASSERT_TRUE(coupling->addCloth(cloth, bt(0.002)).ok());
  EXPECT_EQ(water->getWorld().surface_count() + oil->getWorld().surface_count(), 2u);
  ASSERT_TRUE(coupling->step(bt(0.001)).status.ok());
  water.reset();
  EXPECT_EQ(coupling->getFluid(), oil.get());
  ASSERT_TRUE(coupling->step(bt(0.001)).status.ok());
  EXPECT_NE(coupling->getSurface(cloth), nullptr);
  coupling->removeCloth(cloth);
  EXPECT_EQ(oil->getWorld().surface_count(), 0u);
  coupling.reset();
  EXPECT_TRUE(oil->getWorld().step(0.001).status.ok());
}

TEST(SeveralFluids, refusals_say_why_and_change_nothing) {
  Scene s;
  const auto why = [](const Status& status) { return status.message; };
  EXPECT_EQ(why(s.solver.addFluid(&s.water)), "this fluid is in this coupling already");
  FluidSettings bare = liquid(0.02, 1000, 1);
  bare.boundary = BoundaryModel::contact_only;
  btFluid other(bare, without_gravity(), verified());
  EXPECT_EQ(why(s.solver.addFluid(&other)),
            "the fluids of a coupling must have the same FluidSettings::boundary");
  // Its kill box is too large for the thickness of the cloth.
  WorldSettings vast = without_gravity();
  vast.kill_box = {Vec3::Constant(-1e15), Vec3::Constant(1e15)};
  btFluid unfit(liquid(0.02, 1000, 1), vast, verified());
  EXPECT_NE(why(s.solver.addFluid(&unfit)).find("kill box"), std::string::npos);
  EXPECT_EQ(s.coupling().getNumFluids(), 2);
  s.bullet.step(0.002);
  const double time = s.solver.getReport().time;
  EXPECT_FALSE(s.solver.addFluid(&unfit).ok());
  EXPECT_EQ(s.solver.getReport().time, time);
  EXPECT_GT(time, 0);
}

TEST(SeveralFluids, the_report_of_a_step_stays_when_one_leaves) {
  Scene s;
  s.throw_both();
  for (int k = 0; k < 10; ++k) s.bullet.step(0.002);
  EXPECT_EQ(s.solver.getReport().alive, 250u);
  EXPECT_NEAR(s.solver.takeReport().dt, 0.02, 1e-6);
  s.solver.removeFluid(&s.oil);
  EXPECT_EQ(s.solver.getReport().alive, 250u) << "the last step had both";
  s.bullet.step(0.002);
  EXPECT_EQ(s.solver.getReport().alive, 125u);
}

/// A mesh that changes before another fluid asks for it is a change for those that have it.
TEST(SeveralFluids, a_fluid_that_is_added_hides_no_change_of_the_mesh) {
  Scene s;
  s.bullet.step(0.002);
  const std::uint64_t id = s.coupling().getSurface(s.cloth)->id;
  std::swap(s.cloth->m_faces[3].m_n[0], s.cloth->m_faces[3].m_n[1]);
  btFluid third(liquid(0.02, 1000, 1), without_gravity(), verified());
  ASSERT_TRUE(s.solver.addFluid(&third).ok());
  s.bullet.step(0.002);
  const SurfaceMotion& cloth = *s.coupling().getSurface(s.cloth);
  EXPECT_NE(cloth.id, id);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(cloth.x_t1[cloth.triangles[3][k]], to_vec3(s.cloth->m_faces[3].m_n[k]->m_x));
  for (btFluid* f : {&s.oil, &third})
    EXPECT_EQ(f->getWorld().surface(s.coupling().getSurfaceId(s.cloth, f))->triangles, cloth.triangles);
  s.solver.removeFluid(&third);
}

/// Each must not take what the cloth carries of the other's weight for its own.
TEST(SeveralFluids, two_waters_at_one_place_on_light_cloth_make_no_energy) {
  btFluidSoftBodySolver solver;
  SoftWorld bullet(down, &solver);
  btSoftBody* cloth = bullet.patch(17, 0.2, 0, 0, 0.03);
  pin_border(cloth, 17);
  cloth->m_cfg.piterations = 10;
  btFluid first(liquid(0.01, 1000, 4), small_world(), verified());
  btFluid second(liquid(0.01, 1000, 4), small_world(), verified());
  ASSERT_TRUE(solver.addCloth(cloth, bt(0.002)).ok());
  for (btFluid* f : {&first, &second}) {
    ASSERT_TRUE(solver.addFluid(f).ok());
    throw_block(*f, Vec3(-0.055, 0.006, -0.055), Vec3::Zero(), 12, 4);
  }
  for (int k = 0; k < 150; ++k) {
    bullet.step(0.002);
    const StepReport& r = solver.getReport();
    ASSERT_TRUE(r.status.ok()) << r.status.message;
    ASSERT_EQ(r.contact.crossings_found_by_verify, 0u);
    // With the memory of the load of both: 0.06.
    EXPECT_LT(r.energy.risen_fraction(), 0.035) << "step " << k;
  }
}

/// Counts what falls through a ghost, of both fluids.
struct Gauge {
  btBoxShape shape{btVector3(bt(0.3), bt(0.02), bt(0.3))};
  btGhostObject object;
  Gauge() {
    object.setCollisionShape(&shape);
    object.setCollisionFlags(object.getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE);
    object.setWorldTransform(btTransform(btQuaternion::getIdentity(), {0, bt(0.5), 0}));
  }
};

std::uint64_t balance(const btFluidReading& r) {
  const btFluidFlow& f = r.m_flow;
  return f.m_entered - f.m_left + f.m_appeared - f.m_vanished;
}

TEST(SeveralFluids, sensors_count_all_of_them) {
  Scene s;
  Gauge gauge;
  ASSERT_TRUE(s.solver.addCollisionObject(&gauge.object, bt(0.002)).ok());
  const auto reading = [&] { return *s.coupling().getReading(&gauge.object); };
  throw_block(s.water, Vec3(-0.2, 0.53, 0), Vec3(0, -1, 0));
  throw_block(s.oil, Vec3(0.1, 0.53, 0), Vec3(0, -1, 0));
  for (int k = 0; k < 30; ++k) {
    s.bullet.step(0.002);
    ASSERT_EQ(reading().m_particles, balance(reading())) << "step " << k;
  }
  const std::uint64_t inside = reading().m_particles;
  EXPECT_GT(inside, 50u);
  s.solver.removeFluid(&s.oil);
  EXPECT_GT(reading().m_flow.m_vanished, 10u) << "oil that was inside";
  s.bullet.step(0.002);
  EXPECT_EQ(reading().m_particles, balance(reading()));
  EXPECT_LT(reading().m_particles, inside);
  ASSERT_TRUE(s.solver.addFluid(&s.oil).ok());
  s.bullet.step(0.002);
  EXPECT_EQ(reading().m_particles, balance(reading()));
  EXPECT_GT(reading().m_flow.m_appeared, 10u);
}

/// Sums the calls about the cloth.
struct Diary : btFluidListener {
  Vec3 impulse = Vec3::Zero();
  double largest_area = 0;
  int began = 0, ended = 0;
  void touchEnded(const btCollisionObject*) override { ++ended; }
  void touchBegan(const btCollisionObject*, const btFluidTouch& t) override {
    ++began;
    largest_area = std::max(largest_area, static_cast<double>(t.m_area));
  }
  void splash(const btCollisionObject*, const btFluidTouch& t) override {
    impulse += to_vec3(t.m_impulse);
    largest_area = std::max(largest_area, static_cast<double>(t.m_area));
  }
};

TEST(SeveralFluids, listeners_and_sums_hear_their_loads_once) {
  Scene s;
  Diary diary;
  ASSERT_TRUE(diary.setSplashThreshold(0).ok());
  ASSERT_TRUE(s.solver.addListener(&diary).ok());
  throw_block(s.water, Vec3(-0.1, 0.01, 0), Vec3(0, -1, 0));
  throw_block(s.oil, Vec3(0.05, 0.01, 0), Vec3(0, -1, 0));
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (const btFluid* f : {&s.water, &s.oil})
      for (const Vec3& v : f->getWorld().velocities()) sum += f->getWorld().particle_mass() * v;
    return sum;
  };
  const Vec3 before = momentum();
  for (int k = 0; k < 40; ++k) s.bullet.step(0.002);
  const Vec3 lost = before - momentum();
  EXPECT_LT(lost.y(), -0.1);
  EXPECT_LE((diary.impulse - lost).norm(), 1e-4 * lost.norm()) << diary.impulse.transpose();
  EXPECT_EQ(diary.began, 1);
  s.water.clear();
  s.oil.clear();
  for (int k = 0; k < 60; ++k) s.bullet.step(0.002);
  EXPECT_EQ(diary.ended, 1);
  EXPECT_GT(diary.largest_area, 20 * 0.015 * 0.015);
  btVector3 linear, angular;
  ASSERT_TRUE(s.solver.getCoupling().takeImpulse(s.cloth, linear, angular));
  EXPECT_LE((to_vec3(linear) - lost).norm(), 1e-4 * lost.norm());
}

TEST(SeveralFluids, queries_are_of_one_of_them) {
  Scene s;
  throw_block(s.water, Vec3(-0.03, 0.004, -0.03), Vec3(0, -0.5, 0));
  throw_block(s.oil, Vec3(-0.04, 0.5, -0.04), Vec3(0, 0, 0));
  for (int k = 0; k < 5; ++k) s.bullet.step(0.002);
  const btFluidQuery of_water(s.water), of_oil(s.oil);
  int wet[2] = {0, 0};
  for (int i = 0; i < s.cloth->m_nodes.size(); ++i) {
    wet[0] += of_water.isNodeWet(s.cloth, i);
    wet[1] += of_oil.isNodeWet(s.cloth, i);
  }
  EXPECT_GT(wet[0], 0);
  EXPECT_EQ(wet[1], 0);
  EXPECT_TRUE(of_oil.isWet(btVector3(0, bt(0.54), 0)));
  EXPECT_FALSE(of_water.isWet(btVector3(0, bt(0.54), 0)));
}

TEST(SeveralFluids, a_saved_coupling_goes_on_bit_for_bit) {
  Scene plain, again;
  btFluidDiscEmitter nozzle_a(bt(0.03), bt(1)), nozzle_b(bt(0.03), bt(1));
  btFluidDiscEmitter* nozzle[] = {&nozzle_a, &nozzle_b};
  Gauge gauge[2];
  Scene* scenes[] = {&plain, &again};
  for (int k = 0; k < 2; ++k) {
    ASSERT_TRUE(nozzle[k]->teleport(btTransform(btQuaternion::getIdentity(), {0, bt(-0.3), 0})).ok());
    ASSERT_TRUE(scenes[k]->oil.addEmitter(nozzle[k]).ok());
    ASSERT_TRUE(scenes[k]->solver.addCollisionObject(&gauge[k].object, bt(0.002)).ok());
  }
  plain.throw_both();
  for (int k = 0; k < 25; ++k) plain.bullet.step(0.002);
  std::vector<std::uint8_t> saved;
  ASSERT_TRUE(plain.solver.saveState(&saved).ok());
  const Status restored = again.solver.restoreState(saved);
  ASSERT_TRUE(restored.ok()) << restored.message;
  for (int k = 0; k < 25; ++k) {
    plain.bullet.step(0.002);
    again.bullet.step(0.002);
    ASSERT_EQ(plain.hash(), again.hash()) << "step " << k;
  }
  EXPECT_GT(again.oil.getNumParticles(), 125);
  again.solver.removeFluid(&again.oil);
  EXPECT_EQ(again.solver.restoreState(saved).message, "the saved state has 2 fluids, the coupling 1");
  ASSERT_TRUE(again.solver.addFluid(&again.oil).ok());
  const std::uint64_t before = again.hash();
  saved[saved.size() / 2] ^= 1;
  EXPECT_FALSE(again.solver.restoreState(saved).ok());
  EXPECT_EQ(again.hash(), before);
}

TEST(SeveralFluids, a_translated_coupling_goes_on_without_a_jump) {
  Scene s;
  s.throw_both();
  for (int k = 0; k < 20; ++k) s.bullet.step(0.002);
  const Status status = s.solver.translate(btVector3(8, -4, 16));
  ASSERT_TRUE(status.ok()) << status.message;
  for (int k = 0; k < 20; ++k) {
    s.bullet.step(0.002);
    const StepReport& r = s.solver.getReport();
    ASSERT_TRUE(r.status.ok()) << r.status.message;
    ASSERT_EQ(r.contact.crossings_found_by_verify, 0u);
    ASSERT_EQ(r.alive, 250u);
    ASSERT_LT(r.energy.max_speed, 5);
  }
  EXPECT_LT((s.oil.getWorld().positions()[0] - Vec3(8, -4, 16)).norm(), 1);
}

TEST(SeveralFluids, a_teleport_of_the_cloth_is_one_for_all) {
  Scene s;
  s.throw_both();
  for (int k = 0; k < 25; ++k) s.bullet.step(0.002);
  for (int i = 0; i < s.cloth->m_nodes.size(); ++i)
    for (btVector3* x : {&s.cloth->m_nodes[i].m_x, &s.cloth->m_nodes[i].m_q}) *x += btVector3(0, 1, 0);
  s.solver.resetMotion(s.cloth);
  for (int k = 0; k < 10; ++k) {
    s.bullet.step(0.002);
    ASSERT_TRUE(s.solver.getReport().status.ok());
    ASSERT_EQ(s.solver.getReport().contact.crossings_found_by_verify, 0u);
  }
  EXPECT_EQ(s.water.getNumParticles() + s.oil.getNumParticles(), 250);
  for (const btFluid* f : {&s.water, &s.oil})
    for (const Vec3& v : f->getWorld().motions()) EXPECT_LT(v.norm(), 5) << "swept along";
}

}  // namespace
}  // namespace oilskin::bullet
