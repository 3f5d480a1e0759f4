/// Rigid bodies as surfaces, and particles around them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "oilskin/contact.h"
#include "support/mock_body.h"
#include "support/particle_arrays.h"
#include "support/random.h"

namespace oilskin::test {

/// The body as a surface that stands where it is.
inline SurfaceMotion surface_of(MockBody& body, double thickness = 0.001) {
  SurfaceMotion s;
  EXPECT_TRUE(body.gather(0, s).status.ok());
  s.id = 1;
  s.thickness = thickness;
  s.delta = minimum_separation(thickness, 10, s.storage);
  s.x_t0 = s.x_t1;
  s.body->center_t0 = s.body->center_t1;
  return s;
}

/// Of particles on their x_t0.
inline Vec3 momentum(const ParticleArrays& p) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < p.id.size(); ++i) sum += p.velocity[i] / p.inverse_mass[i];
  return sum;
}
inline Vec3 angular_momentum(const ParticleArrays& p) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < p.id.size(); ++i) sum += p.x_t0[i].cross(p.velocity[i]) / p.inverse_mass[i];
  return sum;
}
inline double energy(const ParticleArrays& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.id.size(); ++i) sum += 0.5 * p.velocity[i].squaredNorm() / p.inverse_mass[i];
  return sum;
}

inline MockBody random_body(Random& random) {
  MockBody body;
  body.mass = std::exp(random.uniform(-3, 3));
  body.half = Vec3(random.uniform(0.02, 0.1), random.uniform(0.02, 0.1), random.uniform(0.02, 0.1));
  body.center = random.in_cube(0.3);
  body.rotation = Eigen::AngleAxisd(random.uniform(0, 6), random.direction()).toRotationMatrix();
  body.velocity = random.in_cube(1);
  body.spin = random.in_cube(5);
  return body;
}

/// Particles just outside random points of the faces, which approach.
inline ParticleArrays around(const MockBody& body, Random& random, int count) {
  ParticleArrays p;
  for (int k = 0; k < count; ++k) {
    Vec3 at(random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8));
    const int axis = k % 3;
    const double side = k % 2 ? 1 : -1;
    Vec3 local = at.cwiseProduct(body.half), out = Vec3::Zero();
    local[axis] = side * (body.half[axis] + 0.0005);
    out[axis] = side;
    p.add(body.center + body.rotation * local, body.velocity - 2 * (body.rotation * out) + random.in_cube(1),
          std::exp(random.uniform(-4, 1)));
  }
  p.move(1e-3);
  return p;
}

}  // namespace oilskin::test
