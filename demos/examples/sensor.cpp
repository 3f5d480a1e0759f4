// Sensors: a meter that measures the flow of a nozzle, and a drain that removes the water that enters it.
// Both are ghost objects without contact response: no walls. A listener hears the water on a plate between
// them.
#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <cstdio>

#include "oilskin/bullet.h"
#include "oilskin/bullet_listener.h"
#include "oilskin/bullet_query.h"
#include "oilskin/bullet_sensor.h"

static bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

/// A box that measures.
struct Sensor {
  btBoxShape shape;
  btGhostObject object;

  Sensor(const btVector3& center, const btVector3& halfExtents) : shape(halfExtents) {
    object.setCollisionShape(&shape);
    object.setCollisionFlags(object.getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE);
    object.setWorldTransform(btTransform(btQuaternion::getIdentity(), center));
  }
};

/// Hears the water on the plate, and empties the drain.
struct Game : oilskin::bullet::btFluidListener {
  const Sensor* drain = nullptr;
  oilskin::bullet::btFluid* water = nullptr;
  int touches = 0, removed = 0;

  void touchBegan(const btCollisionObject*, const oilskin::bullet::btFluidTouch& touch) override {
    ++touches;
    std::printf("the water reaches the plate at x = %.3f m\n", static_cast<double>(touch.m_place.x()));
  }
  void waterEntered(const btCollisionObject* sensor, const oilskin::bullet::btFluidFlow&) override {
    if (sensor == &drain->object)
      removed += water->removeParticles(&drain->shape, sensor->getWorldTransform());
  }
};

int main() {
  const btScalar radius = btScalar(0.03), speed = 1;  // of the nozzle [m], [m/s]
  oilskin::bullet::btFluid water(btScalar(0.01));
  oilskin::bullet::btFluidCoupling coupling(&water);
  Sensor meter({0, btScalar(0.2), 0}, {btScalar(0.1), btScalar(0.02), btScalar(0.1)});
  Sensor drain({0, btScalar(-0.2), 0}, {btScalar(0.5), btScalar(0.1), btScalar(0.5)});
  btBoxShape plateShape({btScalar(0.06), btScalar(0.01), btScalar(0.06)});
  btCollisionObject plate;
  plate.setCollisionShape(&plateShape);
  plate.setWorldTransform(btTransform(btQuaternion({0, 0, 1}, btScalar(0.3)), {0, 0, 0}));
  Game game;
  game.drain = &drain;
  game.water = &water;
  if (!accepted(coupling.addCollisionObject(&meter.object, btScalar(0.002))) ||
      !accepted(coupling.addCollisionObject(&drain.object, btScalar(0.002))) ||
      !accepted(coupling.addCollisionObject(&plate, btScalar(0.002))) ||
      !accepted(coupling.addListener(&game)) ||
      !accepted(water.addJet({0, btScalar(0.3), 0}, {0, -1, 0}, speed, radius)))
    return 1;

  double before = 0, after = 0;
  const int warmUp = 300, steps = 1000;
  const btScalar dt = btScalar(0.001);
  for (int i = 0; i < steps; ++i) {
    if (!accepted(coupling.step(dt).status)) return 1;
    const double entered = coupling.getReading(&meter.object)->m_flow.m_enteredVolume;
    if (i == warmUp) before = entered;
    after = entered;
  }
  const double flow = (after - before) / (static_cast<double>(dt) * (steps - 1 - warmUp));
  const double expected = std::acos(-1.0) * static_cast<double>(radius * radius * speed);
  const oilskin::bullet::btFluidQuery query(water);
  const auto left = static_cast<double>(query.getVolume(&drain.shape, drain.object.getWorldTransform()));
  std::printf("the meter measures %.3f l/s; the nozzle gives %.3f l/s\n", 1000 * flow, 1000 * expected);
  std::printf("%d particles went down the drain, and %.1f ml are in it\n", game.removed, 1e6 * left);

  const bool measured = std::abs(flow - expected) < 0.1 * expected;
  coupling.removeFluid(&water);
  return measured && game.touches == 1 && game.removed > 1000 && left < 1e-9 ? 0 : 1;
}
