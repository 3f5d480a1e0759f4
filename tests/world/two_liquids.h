/// Worlds of water and oil, and the sheet between them, for tests of steps together.
#pragma once

#include "oilskin/world.h"
#include "support/mock_cloth.h"

namespace oilskin::test {

template <class Scalar>
using Cloth = MockCloth<Scalar>;

inline WorldSettings world_settings(const Vec3& gravity = Vec3::Zero(), int threads = 1) {
  WorldSettings s;
  s.kill_box = {Vec3::Constant(-1), Vec3::Constant(1)};
  s.gravity = gravity;
  s.threads = threads;
  return s;
}

inline FluidSettings water(int max_substeps = 1) {
  FluidSettings f;
  f.spacing = 0.01;
  f.max_substeps = max_substeps;
  return f;
}

inline FluidSettings oil(int max_substeps = 1) {
  FluidSettings f = water(max_substeps);
  f.spacing = 0.013;
  f.rest_density = 800;
  f.viscosity = 2e-4;
  return f;
}

inline ContactSettings verified() {
  ContactSettings s;
  s.verify = true;
  return s;
}

/// 0.2 m wide, at y = 0, around the axis.
inline GridShape sheet_shape() {
  GridShape shape;
  shape.origin = Vec3(-0.1, 0, -0.1);
  shape.u = Vec3(0.2, 0, 0);
  shape.v = Vec3(0, 0, 0.2);
  return shape;
}

}  // namespace oilskin::test
