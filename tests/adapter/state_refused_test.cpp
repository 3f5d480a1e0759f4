// States that cannot be saved or restored are refused in words, and nothing changes.
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/frame.h"
#include "state_scene.h"

namespace oilskin::bullet {
namespace {

using namespace test;

constexpr FrameKind saved_state = {{'O', 'I', 'L', 'S', 'T', 'A', 'T', 'E'}, 5, "saved state"};

/// A scene in use, and the state of another one that was built the same way.
struct Pair {
  StateScene here;
  Bytes saved;

  Pair() {
    StateScene other;
    other.play(12, 1);
    saved = other.save();
    here.play(7, -1);
    before_ = here.save();
  }
  /// The message; the scene must be as it was.
  std::string refusal(Span<const std::uint8_t> bytes) {
    const Status status = here.solver.restoreState(bytes);
    EXPECT_FALSE(status.ok());
    EXPECT_EQ(here.save(), before_);
    return status.message;
  }
  Bytes content() const {
    Span<const std::uint8_t> inside;
    EXPECT_TRUE(unframe(saved_state, saved, &inside).ok());
    return Bytes(inside.begin(), inside.end());
  }

 private:
  Bytes before_;
};

TEST(RefusedState, damaged_bytes) {
  Pair pair;
  const auto changed = [&](std::size_t at, std::uint8_t value) {
    Bytes bytes = pair.saved;
    bytes[at] = value;
    return pair.refusal(bytes);
  };
  EXPECT_EQ(pair.refusal({}), "the bytes are not a saved state");
  EXPECT_EQ(changed(0, 'o'), "the bytes are not a saved state");
  EXPECT_EQ(changed(12, 9), "the saved state has version 9; this library reads version 5");
  EXPECT_TRUE(has(changed(pair.saved.size() / 2, 77), "check sum"));
  for (std::size_t size = 0; size < pair.saved.size(); size += 1 + size / 15)
    EXPECT_NE(pair.refusal(Span<const std::uint8_t>(pair.saved).first(size)), "");
  Bytes world;
  ASSERT_TRUE(pair.here.water.getWorld().save(&world).ok());
  EXPECT_EQ(pair.refusal(world), "the bytes are not a saved state");
  ASSERT_TRUE(pair.here.solver.restoreState(pair.saved).ok());
}

TEST(RefusedState, content_that_ends_early_or_goes_on) {
  Pair pair;
  const Bytes content = pair.content();
  for (std::size_t size = 0; size < content.size(); size += 1 + size / 12) {
    const Bytes cut(content.begin(), content.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_TRUE(has(pair.refusal(framed(saved_state, cut)), "the saved state: ")) << size;
  }
  Bytes longer = content;
  longer.push_back(0);
  EXPECT_TRUE(has(pair.refusal(framed(saved_state, longer)), "more bytes"));
  Bytes other_precision = content;
  other_precision[0] = 12 - other_precision[0];
  EXPECT_TRUE(has(pair.refusal(framed(saved_state, other_precision)), "the other precision"));
}

TEST(RefusedState, another_number_of_fluids) {
  btFluidCoupling coupling;
  Bytes saved;
  ASSERT_TRUE(coupling.saveState(&saved).ok());
  ASSERT_TRUE(coupling.restoreState(saved).ok());
  Span<const std::uint8_t> inside;
  ASSERT_TRUE(unframe(saved_state, saved, &inside).ok());
  Bytes content(inside.begin(), inside.end());
  const std::size_t fluids = 1;  // what comes before their number [bytes]
  ASSERT_EQ(content[fluids], 0);
  content[fluids] = 2;
  content.insert(content.begin() + fluids + 8, 2 * 32, 0);  // without world, emitters, sinks, forces
  EXPECT_EQ(coupling.restoreState(framed(saved_state, content)).message,
            "the saved state has 2 fluids: call addFluid() first");
  btFluid water(bt(0.02));
  ASSERT_TRUE(coupling.addFluid(&water).ok());
  EXPECT_EQ(coupling.restoreState(framed(saved_state, content)).message,
            "the saved state has 2 fluids, the coupling 1");
  content.erase(content.begin() + fluids + 8, content.begin() + fluids + 8 + 32);
  content[fluids] = 1;
  EXPECT_NE(coupling.restoreState(framed(saved_state, content)).message, "") << "no world";
}

/// Each byte of the coupling's part may be wrong: the state is refused, or a game goes on with it.
TEST(RefusedState, changed_content_is_refused_or_goes_on) {
  Pair pair;
  const Bytes content = pair.content(), before = pair.here.save();
  int accepted = 0, refused = 0;
  for (std::size_t at = 1; at < content.size(); at += 1 + content.size() / 300) {
    Bytes changed = content;
    for (std::size_t k = at; k < std::min(at + 4, content.size()); ++k) changed[k] ^= 0xff;
    const Status status = pair.here.solver.restoreState(framed(saved_state, changed));
    status.ok() ? ++accepted : ++refused;
    if (!status.ok()) {
      ASSERT_EQ(pair.here.save(), before) << at;
      continue;
    }
    for (int i = 0; i < 2; ++i) pair.here.bullet.step(0.002);
    ASSERT_TRUE(pair.here.solver.restoreState(before).ok());
  }
  EXPECT_GT(accepted, 10);
  EXPECT_GT(refused, 10);
}

TEST(RefusedState, of_another_scene) {
  Pair pair;
  const auto refused_by = [&](const std::function<void(StateOptions&)>& change) {
    StateOptions options;
    change(options);
    StateScene other(options);
    const Bytes before = other.save();
    const Status status = other.solver.restoreState(pair.saved);
    EXPECT_FALSE(status.ok());
    EXPECT_EQ(other.save(), before);
    return status.message;
  };
  EXPECT_EQ(refused_by([](StateOptions& o) { o.cloth_nodes = 8; }),
            "object 2 has 64 nodes, the saved cloth 81");
  EXPECT_EQ(refused_by([](StateOptions& o) { o.mass = 0.2; }),
            "object 3 has another mass or inertia than the saved one: set that first");
  EXPECT_TRUE(has(refused_by([](StateOptions& o) { o.sensor_first = true; }),
                  "object 3 is a sensor, and was a rigid body in the saved state"));
  EXPECT_EQ(refused_by([](StateOptions& o) { o.is_rain = false; }),
            "emitter 2 is of another kind than the saved one");
  EXPECT_TRUE(has(refused_by([](StateOptions& o) { o.has_rain = false; }),
                  "the saved state has 2 emitters, the coupling 1"));
}

TEST(RefusedState, after_objects_were_removed_cut_or_became_sensors) {
  Pair pair;
  btFluidCoupling& coupling = pair.here.solver.getCoupling();
  const auto refusal = [&] {
    const Bytes before = pair.here.save();
    const Status status = coupling.restoreState(pair.saved);
    EXPECT_EQ(pair.here.save(), before);
    return status.message;
  };
  btSoftBody* cloth = pair.here.cloth;
  btSoftBody::Link& link = cloth->m_links[5];
  std::swap(link.m_n[0], link.m_n[1]);
  EXPECT_EQ(refusal(), "object 2 has other links than the saved cloth");
  std::swap(link.m_n[0], link.m_n[1]);
  cloth->appendAnchor(40, pair.here.box.get());
  EXPECT_EQ(refusal(), "object 2 has other anchors than the saved cloth");
  cloth->m_anchors.clear();

  // A wall that was a sensor for a while is the last surface of the fluid.
  btCollisionObject& tank = pair.here.tank.object;
  const int flags = tank.getCollisionFlags();
  tank.setCollisionFlags(flags | btCollisionObject::CF_NO_CONTACT_RESPONSE);
  pair.here.bullet.step(0.002);
  EXPECT_TRUE(has(refusal(), "object 1 is a sensor, and was a collision object"));
  tank.setCollisionFlags(flags);
  pair.here.bullet.step(0.002);
  EXPECT_TRUE(has(refusal(), "another order"));

  coupling.removeCollisionObject(&pair.here.sensor);
  EXPECT_TRUE(has(refusal(), "the saved state has 4 objects, the coupling 3"));
  EXPECT_TRUE(coupling.addCollisionObject(&pair.here.sensor, bt(0.004)).ok());
  pair.here.solver.removeFluid(&pair.here.water);
  EXPECT_EQ(refusal(), "the saved state has a fluid: call addFluid() first");
}

/// Of saving; `out` must be as it was.
std::string save_refused(const btFluidCoupling& coupling) {
  Bytes out = {1, 2, 3};
  const Status status = coupling.saveState(&out);
  EXPECT_EQ(out, (Bytes{1, 2, 3}));
  return status.message;
}

TEST(RefusedState, what_cannot_be_saved) {
  StateScene scene;
  scene.play(3, 0);
  const Bytes good = scene.save();
  const btFluidCoupling& coupling = scene.solver.getCoupling();
  EXPECT_TRUE(has(coupling.saveState(nullptr).message, "`out` is null"));

  scene.box->setLinearVelocity({0, std::numeric_limits<btScalar>::quiet_NaN(), 0});
  EXPECT_TRUE(has(save_refused(coupling), "the state cannot be saved: a number of Bullet's is not finite"));
  ASSERT_TRUE(scene.solver.restoreState(good).ok());
  EXPECT_EQ(scene.save(), good);

  scene.cloth->generateClusters(2);
  EXPECT_TRUE(has(save_refused(coupling), "object 2 is a soft body with clusters"));
  EXPECT_TRUE(has(scene.solver.restoreState(good).message, "object 2 is a soft body with clusters"));
  scene.cloth->releaseClusters();
  EXPECT_EQ(scene.save(), good);

  btDeformableBodySolver deformable;
  btSoftBodySolver* own = scene.cloth->getSoftBodySolver();
  scene.cloth->setSoftBodySolver(&deformable);
  EXPECT_TRUE(has(save_refused(coupling), "object 2 is a body of Bullet's deformable solver"));
  scene.cloth->setSoftBodySolver(own);
}

TEST(RefusedState, with_an_object_that_its_world_no_longer_has) {
  StateScene scene;
  btFluidCoupling& coupling = scene.solver.getCoupling();
  coupling.removeCollisionObject(&scene.tank.object);
  coupling.removeCollisionObject(&scene.sensor);
  coupling.setCollisionWorld(&scene.bullet.world);
  const Bytes good = scene.save();
  scene.bullet.world.removeRigidBody(scene.box.get());
  EXPECT_TRUE(has(save_refused(coupling), "object 2 is not in its world, or was deleted"));
  EXPECT_TRUE(has(coupling.restoreState(good).message, "object 2 is not in its world, or was deleted"));
  scene.bullet.world.addRigidBody(scene.box.get());
  EXPECT_TRUE(coupling.restoreState(good).ok());
}

TEST(RefusedState, within_the_call_of_a_listener) {
  struct Caller : btFluidListener {
    std::function<void()> act;
    void stepped(const StepReport&) override { act(); }
  } caller;
  StateScene scene;
  const Bytes good = scene.save();
  int calls = 0;
  caller.act = [&] {
    ++calls;
    EXPECT_TRUE(has(save_refused(scene.solver.getCoupling()), "a listener may not save or restore"));
    EXPECT_TRUE(has(scene.solver.restoreState(good).message, "a listener may not save or restore"));
  };
  EXPECT_TRUE(scene.solver.addListener(&caller).ok());
  scene.play(2, 0);
  EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace oilskin::bullet
