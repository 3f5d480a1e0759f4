/// Water in hard cases of the fluid.
#pragma once

#include <gtest/gtest.h>

#include "support/world_helpers.h"

namespace oilskin::test::water {

constexpr double g = 9.81, dx = 0.005;  // [m/s²], [m]
constexpr PressureSolver all_solvers[] = {PressureSolver::mcg03, PressureSolver::pcisph,
                                          PressureSolver::dfsph};
constexpr PressureSolver incompressible_solvers[] = {PressureSolver::pcisph, PressureSolver::dfsph};

/// A lattice of nx × ny × nz particles from `corner`, with the given spacing.
inline std::vector<Vec3> lattice(int nx, int ny, int nz, const Vec3& corner, double spacing = dx) {
  std::vector<Vec3> x;
  for (int c = 0; c < nz; ++c)
    for (int b = 0; b < ny; ++b)
      for (int a = 0; a < nx; ++a) x.push_back(corner + spacing * Vec3(a, b, c));
  return x;
}

inline void fill(World& w, const std::vector<Vec3>& x, const Vec3& velocity = Vec3::Zero()) {
  std::uint64_t blocked = 0;
  ASSERT_TRUE(w.add_particles(x, std::vector<Vec3>(x.size(), velocity), &blocked).ok());
  ASSERT_EQ(blocked, 0u);
}

inline double max_density(const World& w) {
  double largest = 0;
  for (double d : w.densities()) largest = std::max(largest, d / w.fluid_settings().rest_density);
  return largest;
}

inline WorldSettings world_of(double half, const Vec3& gravity = Vec3(0, -g, 0), int threads = 1) {
  WorldSettings s;
  s.kill_box = {Vec3::Constant(-half), Vec3::Constant(half)};
  s.gravity = gravity;
  s.threads = threads;
  return s;
}

inline FluidSettings solver_of(PressureSolver solver, bool mirrored = false) {
  FluidSettings s;
  s.solver = solver;
  s.boundary = mirrored ? BoundaryModel::mirrored : BoundaryModel::contact_only;
  s.max_substeps = 1;  // what one interval does is judged
  return s;
}

}  // namespace oilskin::test::water
