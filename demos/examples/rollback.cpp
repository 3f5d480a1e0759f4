// Rollback, as in games over a network: the game runs ahead with a guess of what the other player does. When
// the guess was wrong, it goes back to the last saved frame and replays. It ends bit for bit where a game
// ends that knew the inputs from the start.
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <cstdio>
#include <cstring>
#include <map>

#include "oilskin/bullet_emitter.h"

static bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

/// A ball on a cloth, under a hose that the other player steers.
struct Game {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  oilskin::bullet::btFluidSoftBodySolver softSolver;
  btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &constraints, &configuration, &softSolver};
  oilskin::bullet::btFluid water{btScalar(0.014)};  // rest distance of the particles [m]
  oilskin::bullet::btFluidDiscEmitter hose{btScalar(0.03), 1};
  btSphereShape sphere{btScalar(0.03)};
  btRigidBody ball{btRigidBody::btRigidBodyConstructionInfo(
      btScalar(0.05), nullptr, &sphere, btVector3(1, 1, 1) * btScalar(1.8e-5))};  // [kg], [kg m²]
  btSoftBody* cloth = nullptr;

  bool create() {
    world.getWorldInfo().m_gravity = btVector3(0, btScalar(-9.81), 0);
    const btScalar r = btScalar(0.15);
    cloth = btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), {-r, 0, -r}, {r, 0, -r}, {-r, 0, r},
                                           {r, 0, r}, 13, 13, 1 + 2 + 4 + 8, true);
    cloth->setTotalMass(btScalar(0.05));
    cloth->getCollisionShape()->setMargin(btScalar(0.005));
    world.addSoftBody(cloth);
    ball.setWorldTransform(btTransform(btQuaternion::getIdentity(), {0, btScalar(0.05), 0}));
    world.addRigidBody(&ball);
    return accepted(softSolver.addFluid(&water)) && accepted(softSolver.addCloth(cloth, btScalar(0.002))) &&
           accepted(softSolver.addRigidBody(&ball, btScalar(0.002))) && accepted(water.addEmitter(&hose));
  }
  ~Game() {
    softSolver.removeRigidBody(&ball);
    softSolver.removeCloth(cloth);
    world.removeRigidBody(&ball);
    world.removeSoftBody(cloth);
    delete cloth;
  }
  bool play(btScalar input) {  // one frame; −1 … 1 steers the hose
    const btVector3 place(input * btScalar(0.08), btScalar(0.1), 0);
    const btScalar frame = btScalar(0.002);  // [s]
    if (!accepted(hose.setWorldTransform(btTransform(btQuaternion::getIdentity(), place), frame)))
      return false;
    world.stepSimulation(frame, 0);
    return accepted(softSolver.getReport().status);
  }
  /// Water, cloth and ball, to the bit.
  bool equals(const Game& other) const {
    const btVector3 &a = ball.getWorldTransform().getOrigin(),
                    &b = other.ball.getWorldTransform().getOrigin();
    bool same = water.getWorld().state_hash() == other.water.getWorld().state_hash() &&
                std::memcmp(&a, &b, 3 * sizeof(btScalar)) == 0;
    for (int i = 0; i < cloth->m_nodes.size(); ++i)
      same = same &&
             std::memcmp(&cloth->m_nodes[i].m_x, &other.cloth->m_nodes[i].m_x, 3 * sizeof(btScalar)) == 0;
    return same;
  }
};

/// What the other player does in a frame.
static btScalar input(int frame) {
  return frame < 55 ? btScalar(-1) : btScalar(1);
}

int main() {
  Game game, knowing;  // the second one knows all inputs
  if (!game.create() || !knowing.create()) return 1;

  std::map<int, std::vector<std::uint8_t>> saved;  // by frame
  const int late = 9, frames = 100;                // inputs arrive so many frames late
  bool wasWrong = false, wentBack = false;
  for (int frame = 0; frame < frames; ++frame) {
    if (!knowing.play(input(frame))) return 1;
    if (frame % 10 == 0 && !accepted(game.softSolver.saveState(&saved[frame], &game.world))) return 1;
    const btScalar guess = input(frame < late ? 0 : frame - late);
    if (!game.play(guess)) return 1;
    if (guess == input(frame)) continue;
    wasWrong = wasWrong || !game.equals(knowing);
    if (input(frame - late + 1) == guess) continue;
    // The inputs up to this frame are known now, and were not what was guessed.
    const auto last = std::prev(saved.upper_bound(frame - late));
    if (!accepted(game.softSolver.restoreState(last->second, &game.world))) return 1;
    for (int again = last->first; again <= frame; ++again)
      if (!game.play(input(again))) return 1;
    wentBack = true;
    std::printf("frame %d: back to frame %d (%zu bytes), replayed %d frames: %s\n", frame, last->first,
                last->second.size(), frame - last->first + 1, game.equals(knowing) ? "equal" : "different");
  }
  std::printf("frame %d: %d particles, states are %s\n", frames, game.water.getNumParticles(),
              game.equals(knowing) ? "equal" : "different");
  return wasWrong && wentBack && game.equals(knowing) && game.water.getNumParticles() > 100 ? 0 : 1;
}
