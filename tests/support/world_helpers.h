/// Small things that tests of whole worlds share.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "oilskin/world.h"

namespace oilskin::test {

inline SurfaceSettings sheet_settings(double thickness = 0.001) {
  SurfaceSettings s;
  s.thickness = thickness;
  return s;
}

/// The default settings, with the gravity of the earth along −y.
inline WorldSettings under_gravity() {
  WorldSettings s;
  s.gravity = Vec3(0, -9.81, 0);
  return s;
}

/// The default settings, with a spacing [m].
inline FluidSettings of_spacing(double spacing) {
  FluidSettings s;
  s.spacing = spacing;
  return s;
}

/// Of particle i [kg].
inline double mass_of(const World& w, std::size_t i) {
  const Span<const float> ratio = w.mass_ratios();
  return (ratio.empty() ? 1 : static_cast<double>(ratio[i])) * w.particle_mass();
}

inline Vec3 fluid_momentum(const World& w) {
  Vec3 p = Vec3::Zero();
  for (std::size_t i = 0; i < w.particle_count(); ++i) p += mass_of(w, i) * w.velocities()[i];
  return p;
}

/// The speed of the fastest particle [m/s].
inline double fastest(const World& w) {
  double speed = 0;
  for (const Vec3& v : w.velocities()) speed = std::max(speed, v.norm());
  return speed;
}

inline double kinetic_energy(const World& w) {
  double sum = 0;
  for (std::size_t i = 0; i < w.particle_count(); ++i)
    sum += 0.5 * mass_of(w, i) * w.velocities()[i].squaredNorm();
  return sum;
}

/// Kinetic energy and that of gravity.
inline double mechanical_energy(const World& w) {
  double sum = kinetic_energy(w);
  for (std::size_t i = 0; i < w.particle_count(); ++i)
    sum -= mass_of(w, i) * w.settings().gravity.dot(w.positions()[i]);
  return sum;
}

/// A block of n³ particles above the sheet, all with one velocity.
inline void add_block(World& w, int n, const Vec3& corner, const Vec3& velocity) {
  std::vector<Vec3> x, v;
  const double dx = w.fluid_settings().spacing;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        x.push_back(corner + dx * Vec3(i, j, k));
        v.push_back(velocity);
      }
  std::uint64_t blocked = 0;
  ASSERT_TRUE(w.add_particles(x, v, &blocked).ok());
  ASSERT_EQ(blocked, 0u);
}

}  // namespace oilskin::test
