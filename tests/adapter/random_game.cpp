#include "random_game.h"

#include <cmath>
#include <limits>

#include "core/hash.h"

namespace oilskin::bullet::test {

RandomGame::RandomGame(std::uint64_t number, int threads) : random_(number), threads_(threads) {
  for (int k = 0; k < 40; ++k) act();
}

/// In one of two orders: what was created last goes first, or the fluids do.
RandomGame::~RandomGame() {
  if (once_in(2)) {
    listeners_.clear();
    fluids_.clear();
  }
  for (; !objects_.empty(); objects_.pop_back()) destroy(std::move(objects_.back()));
  for (; !bodies_.empty(); bodies_.pop_back()) destroy(std::move(bodies_.back()));
  for (btSoftBody* cloth : cloths_) solver_->removeCloth(cloth);
}

void RandomGame::destroy(std::unique_ptr<btCollisionObject> object) {
  solver_->removeCollisionObject(object.get());
  bullet_.world.removeCollisionObject(object.get());
}

void RandomGame::destroy(std::unique_ptr<btRigidBody> body) {
  solver_->removeRigidBody(body.get());
  bullet_.world.removeRigidBody(body.get());
}

void RandomGame::play(int steps) {
  for (int k = 0; k < steps; ++k) {
    for (std::uint32_t calls = random_.below(4); calls > 0; --calls) act();
    step();
  }
}

void RandomGame::act() {
  constexpr Action actions[] = {
      &RandomGame::change_fluid,    &RandomGame::pour,           &RandomGame::pour,
      &RandomGame::use_emitter,     &RandomGame::use_emitter,    &RandomGame::use_sink,
      &RandomGame::use_force,       &RandomGame::use_listener,   &RandomGame::make_object,
      &RandomGame::attach_object,   &RandomGame::change_object,  &RandomGame::delete_object,
      &RandomGame::make_body,       &RandomGame::attach_body,    &RandomGame::change_body,
      &RandomGame::delete_body,     &RandomGame::make_cloth,     &RandomGame::attach_cloth,
      &RandomGame::change_cloth,    &RandomGame::delete_cloth,   &RandomGame::save,
      &RandomGame::restore,         &RandomGame::translate,      &RandomGame::ask,
      &RandomGame::limit_particles, &RandomGame::change_settings};
  (this->*actions[random_.below(static_cast<std::uint32_t>(std::size(actions)))])();
}

void RandomGame::step() {
  bullet_.step(once_in(5) ? 0.008 : 0.002);
  const StepReport& report = solver_->getReport();
  ++seen_.steps;
  seen_.crossings += report.contact.crossings_found_by_verify;
  seen_.steps_without_residual +=
      report.momentum_residual().norm() < 1e-6 * (1 + report.momentum_after.norm());
  const btFluidCoupling& coupling = solver_->getCoupling();
  seen_.steps_of_several += coupling.getNumFluids() > 1 && report.status.ok();
  for (int k = 0; k < coupling.getNumFluids(); ++k) {
    const World& world = coupling.getFluid(k)->getWorld();
    seen_.particle_steps += world.particle_count();
    for (const Vec3& x : world.positions()) seen_.is_finite &= x.allFinite();
    for (const Vec3& v : world.velocities()) seen_.is_finite &= v.allFinite();
  }
}

void RandomGame::hear() {
  ++seen_.heard;
  if (is_within_call_ || once_in(2)) return;
  is_within_call_ = true;
  act();
  is_within_call_ = false;
}

std::uint64_t RandomGame::state_hash() const {
  Hash64 hash;
  const auto add = [&](const btVector3& v) {
    for (int k = 0; k < 3; ++k) hash.add(static_cast<double>(v[k]));
  };
  for (const auto& f : fluids_) hash.add(f->getWorld().state_hash());
  for (const btSoftBody* cloth : cloths_)
    for (int i = 0; i < cloth->m_nodes.size(); ++i) add(cloth->m_nodes[i].m_x);
  for (const auto& b : bodies_) add(b->getWorldTransform().getOrigin()), add(b->getAngularVelocity());
  return hash.value();
}

/// Once in a while one that no call should take.
btScalar RandomGame::number(double low, double high) {
  constexpr double odd[] = {
      std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1, 0, 1e30, 1e-30};
  return bt(once_in(10) ? odd[random_.below(6)] : random_.uniform(low, high));
}

btTransform RandomGame::pose() {
  const Vec3 turn = random_.in_cube(3);
  return btTransform(btQuaternion(bt(turn[0]), bt(turn[1]), bt(turn[2])), place(0.2));
}

}  // namespace oilskin::bullet::test
