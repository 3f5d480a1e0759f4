/// A game on Bullet that makes random calls of the adapter, in random order, between steps and within the
/// calls of listeners: objects come, go, change and are deleted, numbers are odd, saved states damaged.
#pragma once

#include <memory>
#include <vector>

#include "support/random.h"  // before Bullet, which has a global seed

#include "bullet_world.h"
#include "oilskin/bullet_emitter.h"
#include "oilskin/bullet_force.h"
#include "oilskin/bullet_listener.h"
#include "oilskin/bullet_sink.h"

namespace oilskin::bullet::test {

class RandomGame {
 public:
  struct Seen {
    std::uint64_t accepted = 0, refused = 0;  // calls that return a Status
    std::uint64_t heard = 0;                  // calls of listeners
    std::uint64_t particle_steps = 0, crossings = 0;
    std::uint64_t steps_without_residual = 0, steps = 0, steps_of_several = 0;
    bool is_finite = true;
  };

  RandomGame(std::uint64_t number, int threads);
  ~RandomGame();
  RandomGame(const RandomGame&) = delete;
  RandomGame& operator=(const RandomGame&) = delete;

  void play(int steps);
  const Seen& seen() const { return seen_; }
  /// Of the water, the cloth and the rigid bodies.
  std::uint64_t state_hash() const;

 private:
  struct Listener;
  template <class Object>
  using Owned = std::vector<std::unique_ptr<Object>>;
  using Action = void (RandomGame::*)();

  // random_game.cpp
  void act();
  void step();
  void hear();
  void note(const Status& status) { ++(status.ok() ? seen_.accepted : seen_.refused); }
  bool once_in(std::uint32_t n) { return random_.below(n) == 0; }
  btScalar number(double low, double high);
  btVector3 place(double half) { return to_bt(random_.in_cube(half)); }
  btTransform pose();
  template <class List>
  std::uint32_t index_in(const List& list) {
    return random_.below(static_cast<std::uint32_t>(list.size()));
  }
  template <class Object>
  Object& any(Owned<Object>& all) {
    return *all[index_in(all)];
  }
  template <class Object>
  void erase_any(Owned<Object>& all) {
    if (!all.empty()) all.erase(all.begin() + index_in(all));
  }
  /// Takes one out of the list; the last one takes its place.
  template <class Item>
  Item take_any(std::vector<Item>& all) {
    std::swap(all.back(), all[index_in(all)]);
    Item item = std::move(all.back());
    all.pop_back();
    return item;
  }
  void destroy(std::unique_ptr<btCollisionObject> object);
  void destroy(std::unique_ptr<btRigidBody> body);
  /// One of those in the coupling; null = there is none.
  btFluid* fluid() {
    const btFluidCoupling& coupling = solver_->getCoupling();
    const auto count = static_cast<std::uint32_t>(coupling.getNumFluids());
    return count == 0 ? nullptr : coupling.getFluid(static_cast<int>(random_.below(count)));
  }

  // What may be done: random_actions.cpp
  void change_fluid();
  void pour();
  void limit_particles();
  void use_emitter();
  void use_sink();
  void use_force();
  void use_listener();
  void make_object();
  void attach_object();
  void change_object();
  void delete_object();
  void make_body();
  void attach_body();
  void change_body();
  void delete_body();
  void make_cloth();
  void attach_cloth();
  void change_cloth();
  void delete_cloth();
  void save();
  void restore();
  void translate();
  void ask();
  void change_settings();
  btCollisionShape* new_shape();
  btConvexShape* new_convex_shape();

  oilskin::test::Random random_;
  const int threads_;
  Seen seen_;
  bool is_within_call_ = false;
  std::vector<std::uint8_t> saved_;
  bool is_saved_with_world_ = false;

  Owned<btStridingMeshInterface> meshes_;
  Owned<btCollisionShape> shapes_;
  std::unique_ptr<btFluidSoftBodySolver> solver_ = std::make_unique<btFluidSoftBodySolver>();
  SoftWorld bullet_{btVector3(0, bt(-9.81), 0), solver_.get()};
  std::vector<btSoftBody*> cloths_;
  Owned<btCollisionObject> objects_;
  Owned<btRigidBody> bodies_;
  Owned<btFluid> fluids_;
  Owned<btFluidEmitter> emitters_;
  Owned<btFluidSink> sinks_;
  Owned<btFluidForce> forces_;
  Owned<Listener> listeners_;
};

/// Makes one random call with all that listeners tell.
struct RandomGame::Listener : btFluidListener {
  explicit Listener(RandomGame& g) : game(&g) {}
  void touchBegan(const btCollisionObject*, const btFluidTouch&) override { game->hear(); }
  void touchEnded(const btCollisionObject*) override { game->hear(); }
  void splash(const btCollisionObject*, const btFluidTouch&) override { game->hear(); }
  void waterEntered(const btCollisionObject*, const btFluidFlow&) override { game->hear(); }
  void waterLeft(const btCollisionObject*, const btFluidFlow&) override { game->hear(); }
  void stepped(const StepReport&) override { game->hear(); }

  RandomGame* game;
};

}  // namespace oilskin::bullet::test
