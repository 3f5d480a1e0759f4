/// A game with one of everything whose state is saved: cloth, a rigid body, walls, a sensor, emitters, a
/// listener.
#pragma once

#include <sstream>

#include "game.h"
#include "oilskin/bullet_emitter.h"
#include "oilskin/bullet_listener.h"
#include "oilskin/bullet_sensor.h"

namespace oilskin::bullet::test {

using Bytes = std::vector<std::uint8_t>;

/// Writes down what it hears.
class Ear : public btFluidListener {
 public:
  std::ostringstream heard;

  void touchBegan(const btCollisionObject* object, const btFluidTouch& touch) override {
    write("began", object) << ' ' << touch.m_impulse.y() << ' ' << touch.m_place.x();
  }
  void touchEnded(const btCollisionObject* object) override { write("ended", object); }
  void splash(const btCollisionObject* object, const btFluidTouch& touch) override {
    write("splash", object) << ' ' << touch.m_impulse.y();
  }
  void waterEntered(const btCollisionObject* object, const btFluidFlow& flow) override {
    write("entered", object) << ' ' << flow.m_entered;
  }

 private:
  std::ostream& write(const char* what, const btCollisionObject* object) {
    return heard << '\n' << std::hexfloat << what << ' ' << object->getUserIndex();
  }
};

struct StateOptions {
  int threads = 1;
  int cloth_nodes = 9;
  double mass = 0.15;         ///< of the box [kg]
  bool sensor_first = false;  ///< the order of sensor and box
  bool is_rain = true;        ///< else a second nozzle
  bool has_rain = true;
};

inline btTransform at(double x, double y, double z) {
  return btTransform(btQuaternion::getIdentity(), {bt(x), bt(y), bt(z)});
}

/// A cloth that hangs on its corners over a tank in which a box floats; a nozzle and rain; a sensor in the
/// tank. The bodies do not touch each other, but through the water.
struct StateScene : Game {
  StateOptions options;
  Tank tank;
  btSoftBody* cloth = nullptr;
  btBoxShape box_shape{btVector3(bt(0.04), bt(0.04), bt(0.04))},
      sensor_shape{btVector3(bt(0.1), bt(0.03), bt(0.1))};
  btDefaultMotionState motion_state;
  std::unique_ptr<btRigidBody> box;
  btCollisionObject sensor;
  btFluidDiscEmitter nozzle{bt(0.03), 1};
  btFluidRainEmitter rain{bt(0.05), bt(0.05), 200, 0, 1};
  btFluidDiscEmitter second{bt(0.02), 1};
  Ear ear;

  explicit StateScene(const StateOptions& o = {}) : Game(o.threads), options(o) {
    cloth = bullet.patch(o.cloth_nodes, 0.12, 0.22, 15, 0.1);
    tank.object.setUserIndex(1);
    cloth->setUserIndex(2);
    make_box();
    make_sensor();
    btFluidCoupling& coupling = solver.getCoupling();
    EXPECT_TRUE(coupling.addCollisionObject(&tank.object, bt(0.004)).ok());
    EXPECT_TRUE(coupling.addCloth(cloth, bt(0.004)).ok());
    if (o.sensor_first) {
      EXPECT_TRUE(coupling.addCollisionObject(&sensor, bt(0.004)).ok());
    }
    EXPECT_TRUE(coupling.addRigidBody(box.get(), bt(0.004)).ok());
    if (!o.sensor_first) {
      EXPECT_TRUE(coupling.addCollisionObject(&sensor, bt(0.004)).ok());
    }
    EXPECT_TRUE(ear.setSplashThreshold(0).ok());
    EXPECT_TRUE(coupling.addListener(&ear).ok());
    EXPECT_TRUE(nozzle.teleport(at(0, 0.3, 0)).ok());
    EXPECT_TRUE(water.addEmitter(&nozzle).ok());
    btFluidEmitter& other = o.is_rain ? static_cast<btFluidEmitter&>(rain) : second;
    EXPECT_TRUE(other.teleport(at(-0.02, 0.25, 0.06)).ok());
    if (o.has_rain) {
      EXPECT_TRUE(water.addEmitter(&other).ok());
    }
  }
  ~StateScene() {
    water.removeEmitter(&nozzle);
    water.removeEmitter(&rain);
    water.removeEmitter(&second);
    solver.removeFluid(&water);
    bullet.world.removeRigidBody(box.get());
  }

  Bytes save() const {
    Bytes bytes;
    const Status status = solver.saveState(&bytes);
    EXPECT_TRUE(status.ok()) << status.message;
    return bytes;
  }
  /// Steps with the input of a player: the nozzle is moved, the box is pushed, a corner of the cloth is
  /// pulled.
  void play(int steps, double input) {
    for (int i = 0; i < steps; ++i) {
      EXPECT_TRUE(nozzle.setWorldTransform(at(0.02 * input, 0.3, 0), bt(0.002)).ok());
      box->applyCentralForce({bt(0.1 * input), 0, 0});
      cloth->m_nodes[0].m_x += btVector3(0, bt(1e-4 * input), 0);
      bullet.step(0.002);
      EXPECT_TRUE(solver.getReport().status.ok()) << solver.getReport().status.message;
    }
  }
  /// What a player could see or hear, to the bit.
  std::string look() const {
    std::ostringstream out;
    const auto write = [&](const btVector3& v) { out << v.x() << ' ' << v.y() << ' ' << v.z() << '\n'; };
    out << std::hexfloat << water.getWorld().state_hash() << ' ' << water.getNumParticles() << '\n';
    for (int i = 0; i < cloth->m_nodes.size(); ++i) {
      const btSoftBody::Node& n = cloth->m_nodes[i];
      for (const btVector3& v : {n.m_x, n.m_q, n.m_v, n.m_f, n.m_n}) write(v);
    }
    for (int row = 0; row < 3; ++row) write(box->getWorldTransform().getBasis()[row]);
    for (const btVector3& v :
         {box->getWorldTransform().getOrigin(), box->getLinearVelocity(), box->getAngularVelocity()})
      write(v);
    const btFluidReading& reading = *solver.getCoupling().getReading(&sensor);
    out << reading.m_particles << ' ' << reading.m_volume << ' ' << reading.m_flow.m_entered << ' '
        << nozzle.getEmittedVolume() << ' ' << rain.getEmittedVolume();
    return out.str();
  }

 private:
  void make_box() {
    box_shape.setMargin(bt(0.001));
    btVector3 inertia(0, 0, 0);
    box_shape.calculateLocalInertia(bt(options.mass), inertia);
    motion_state.setWorldTransform(at(0, 0.12, 0));
    box = std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(bt(options.mass), &motion_state, &box_shape, inertia));
    box->setUserIndex(3);
    bullet.world.addRigidBody(box.get());
  }
  void make_sensor() {
    sensor.setCollisionShape(&sensor_shape);
    sensor.setWorldTransform(at(0, 0.03, 0));
    sensor.setCollisionFlags(sensor.getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE);
    sensor.setUserIndex(4);
  }
};

}  // namespace oilskin::bullet::test
