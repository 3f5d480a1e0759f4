/// A world in which everything happens that a saved world must know of: free and pinned cloth, a floor,
/// plates that pins hold or that come and go, emitters that run, wait, are blocked or have not begun.
#pragma once

#include <memory>

#include "support/mock_cloth.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin::test {

/// What a host's owner saves of it.
template <class Scalar>
struct ClothState {
  std::vector<typename MockCloth<Scalar>::SVec> x, v;
};

template <class Scalar>
class BusyScene {
 public:
  BusyScene(const WorldSettings& settings, const FluidSettings& fluid)
      : world(settings, fluid), cloth(cloth_shape()), press(press_shape()) {
    cloth.gravity = settings.gravity;
    for (std::size_t corner : {0u, 10u, 110u, 120u}) cloth.pin(corner);
    for (std::size_t i = 0; i < press.x.size(); ++i) press.pin(i);
    floor.add_rectangle(Vec3(-0.3, -0.1, -0.3), Vec3(0.6, 0, 0), Vec3(0, 0, 0.6), 4, 4);
    lid.add_rectangle(lid_corner(), Vec3(0.04, 0, 0), Vec3(0, 0, 0.04), 2, 2);
    ok = world.attach(cloth, sheet_settings(), &cloth_id).ok() &&
         world.attach(floor, sheet_settings(0.002), &floor_id).ok() &&
         world.attach(lid, sheet_settings(), &lid_id).ok() &&
         world.attach(press, sheet_settings(), &press_id).ok();
  }

  void add_emitters() {
    DiscEmitter jet;
    jet.center = Vec3(0.003, 0.05, -0.002);
    jet.direction = Vec3(0.2, -1, 0.1);
    jet.radius = 0.0105;
    jet.speed = 2;
    DiscEmitter covered = jet;  // the lid lies on its nozzle
    covered.center = lid_corner() + Vec3(0.02, 0, 0.02);
    covered.direction = Vec3(0, 1, 0);
    DiscEmitter later = jet;
    later.center.z() = 0.04;
    later.start = 0.07;
    BoxEmitter drop;
    drop.box = {Vec3(-0.06, 0.06, -0.06), Vec3(-0.04, 0.075, -0.04)};
    drop.start = 0.065;
    BoxEmitter puddle;  // between floor and press
    puddle.box = {Vec3(0.12, -0.097, -0.01), Vec3(0.135, -0.086, 0.01)};
    BoxEmitter loner = puddle;  // which cannot slip away: its press is held
    loner.box = {Vec3(0.22, -0.097, 0.03), Vec3(0.225, -0.092, 0.035)};
    RainEmitter rain;
    rain.corner = Vec3(-0.1, 0.08, -0.1);
    rain.edge_u = Vec3(0.2, 0, 0);
    rain.edge_v = Vec3(0, 0, 0.2);
    rain.drops_per_second = 300;
    rain.seed = 7;
    for (const DiscEmitter& e : {jet, covered, later}) ok = ok && world.add_emitter(e).ok();
    for (const BoxEmitter& e : {drop, puddle, loner}) ok = ok && world.add_emitter(e).ok();
    ok = ok && world.add_emitter(rain).ok();
  }

  /// Step number k, a function of k and of the state alone.
  const StepReport& step(int k, double dt = 2e-3) {
    cloth.x[10].x() += Scalar(k % 20 < 10 ? 0.0002 : -0.0002);  // a pin that its owner moves
    for (auto& x : press.x) x.y() -= Scalar(0.0004);            // down to the floor
    const bool away = k >= 33;                                  // the lid lets go of what waits under it
    for (Vec3& x : lid.nodes) x.y() = lid_corner().y() + (away ? -0.03 : 0);
    return world.step(k % 7 == 3 ? 0.7 * dt : dt);
  }

  std::pair<ClothState<Scalar>, ClothState<Scalar>> host_state() const {
    return {{cloth.x, cloth.v}, {press.x, press.v}};
  }
  void set_host_state(const std::pair<ClothState<Scalar>, ClothState<Scalar>>& state) {
    cloth.x = state.first.x, cloth.v = state.first.v;
    press.x = state.second.x, press.v = state.second.v;
  }

  World world;
  MockCloth<Scalar> cloth, press;
  StaticMesh floor, lid;
  SurfaceId cloth_id, floor_id, lid_id, press_id;
  bool ok = false;

 private:
  static Vec3 lid_corner() { return Vec3(-0.25, -0.05, -0.25); }
  static GridShape cloth_shape() {
    GridShape g;
    g.nu = g.nv = 11;
    g.origin = Vec3(-0.1, 0, -0.1);
    g.u = Vec3(0.2, 0.02, 0);
    g.v = Vec3(0, 0, 0.2);
    return g;
  }
  static GridShape press_shape() {
    GridShape g;
    g.nu = g.nv = 5;
    g.origin = Vec3(0.1, -0.075, -0.05);
    g.u = Vec3(0.14, 0, 0);
    g.v = Vec3(0, 0, 0.1);
    return g;
  }
};

/// Gravity, a kill box of half a metre.
inline WorldSettings busy_world(int threads) {
  WorldSettings s;
  s.kill_box = {Vec3::Constant(-0.5), Vec3::Constant(0.5)};
  s.threads = threads;
  return s;
}

}  // namespace oilskin::test
