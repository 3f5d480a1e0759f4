/// What the tests of coupling methods share.
#pragma once

#include <gtest/gtest.h>

#include "study/comparators/coupling_method.h"
#include "study/comparators/study_hosts.h"

namespace oilskin::study {

/// The lattice of `spacing` that fills the box, at one velocity.
inline void add_water(CouplingMethod& method, const Box& box, const Vec3& velocity = Vec3::Zero(),
                      double spacing = 0.005) {
  const std::vector<Vec3> x = lattice_in(box, spacing);
  ASSERT_TRUE(method.add_particles(x, std::vector<Vec3>(x.size(), velocity)).ok());
}

/// Σ m v of the free nodes of a surface [kg m/s].
inline Vec3 sheet_momentum(const CouplingMethod& method, std::size_t surface = 0) {
  const SurfaceMotion& m = method.surface(surface);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < m.velocity.size(); ++i)
    if (m.inverse_mass[i] > 0) sum += m.velocity[i] / m.inverse_mass[i];
  return sum;
}

inline MethodSettings weightless() {
  MethodSettings settings;
  settings.gravity = Vec3::Zero();
  return settings;
}

/// A flat sheet of 2 × cells² triangles at rest at y = 0, all of whose nodes are prescribed.
inline SheetSettings rigid(double size = 0.2, int cells = 20) {
  SheetSettings sheet;
  sheet.size = size, sheet.cells = cells, sheet.held = Held::all;
  return sheet;
}

}  // namespace oilskin::study
