/// What tests of implicit viscosity share.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "oilskin/implicit_viscosity.h"
#include "support/random.h"
#include "support/record.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin::test {

constexpr double gravity = 9.81;  // [m/s²]

inline WorldSettings world_of(const Vec3& acceleration, int threads = 1) {
  WorldSettings s;
  s.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
  s.gravity = acceleration;
  s.threads = threads;
  return s;
}

/// Without other viscosity.
inline FluidSettings fluid_of(double spacing = 0.005, double support_ratio = 2) {
  FluidSettings s;
  s.spacing = spacing;
  s.support_ratio = support_ratio;
  s.viscosity = 0;
  s.xsph_rate = 0;
  return s;
}

inline SurfaceSettings sheet(SlipModel slip, double thickness = 0.001) {
  SurfaceSettings s = sheet_settings(thickness);
  s.slip.model = slip;
  return s;
}

inline std::vector<Vec3> lattice(int nx, int ny, int nz, double dx, const Vec3& corner) {
  std::vector<Vec3> x;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) x.push_back(corner + dx * Vec3(i + 0.5, j + 0.5, k + 0.5));
  return x;
}

inline void fill(World& w, const std::vector<Vec3>& x, const std::function<Vec3(const Vec3&)>& velocity) {
  std::vector<Vec3> v;
  for (const Vec3& p : x) v.push_back(velocity(p));
  std::uint64_t blocked = 0;
  ASSERT_TRUE(w.add_particles(x, v, &blocked).ok());
  ASSERT_EQ(blocked, 0u);
}

inline Vec3 at_rest(const Vec3&) {
  return Vec3::Zero();
}

inline Vec3 angular_momentum(const World& w) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < w.particle_count(); ++i)
    sum += w.particle_mass() * w.positions()[i].cross(w.velocities()[i]);
  return sum;
}

inline Vec3 middle(const World& w) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : w.positions()) sum += x / static_cast<double>(w.particle_count());
  return sum;
}

}  // namespace oilskin::test
