/// What tests of sub-steps share: settings, and a sheet that its owner drives.
#pragma once

#include "oilskin/world.h"

namespace oilskin::test {

inline WorldSettings box(double half, const Vec3& gravity = Vec3::Zero(), int threads = 1) {
  WorldSettings s;
  s.kill_box = {Vec3::Constant(-half), Vec3::Constant(half)};
  s.gravity = gravity;
  s.threads = threads;
  return s;
}

/// At most so many intervals in a step.
inline FluidSettings cut_into(int max_substeps, double cfl = 0.4) {
  FluidSettings s;
  s.max_substeps = max_substeps;
  s.cfl = cfl;
  return s;
}

/// A sheet that its owner puts somewhere else before every step.
class Driven : public SurfaceHost {
 public:
  std::vector<Vec3> nodes;
  std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}};
  Storage storage = Storage::float32;
  bool holdable = false;
  int writes = 0;

  explicit Driven(double half) {
    for (const Vec3& x :
         {Vec3(-half, 0, -half), Vec3(half, 0, -half), Vec3(half, 0, half), Vec3(-half, 0, half)})
      nodes.push_back(x);
  }
  void move(const Vec3& by) {
    for (Vec3& x : nodes) x = stored(x + by, storage);
  }
  Gathered gather(double dt, SurfaceMotion& m) override {
    const bool is_new = m.triangles.empty();
    m.triangles = triangles;
    m.storage = storage;
    for (Vec3& x : nodes) x = stored(x, storage);
    m.x_t1 = nodes;
    m.velocity.assign(4, Vec3::Zero());
    if (dt > 0 && m.x_t0.size() == 4)
      for (int i = 0; i < 4; ++i) m.velocity[i] = (m.x_t1[i] - m.x_t0[i]) / dt;
    m.inverse_mass.assign(4, 0);
    m.holdable.assign(4, holdable);
    return {Status{}, is_new};
  }
  void scatter(SurfaceMotion& m) override {
    for (int i = 0; i < 4; ++i) {
      if (m.moved[i]) nodes[i] = m.x_t1[i], ++writes;
      m.x_t1[i] = nodes[i];
    }
  }
};

}  // namespace oilskin::test
