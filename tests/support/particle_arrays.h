/// Particles that own their arrays, for tests of contact alone.
#pragma once

#include "oilskin/contact.h"

namespace oilskin::test {

struct ParticleArrays {
  std::vector<std::uint64_t> id;
  std::vector<Vec3> x_t0, x_t1, velocity;
  std::vector<double> inverse_mass;
  std::vector<std::uint8_t> removed;

  void add(const Vec3& x, const Vec3& v, double mass) {
    id.push_back(id.size() + 1);
    x_t0.push_back(x);
    x_t1.push_back(x);
    velocity.push_back(v);
    inverse_mass.push_back(mass > 0 ? 1 / mass : 0);
    removed.push_back(0);
  }
  ParticleMotion motion(double spacing = 0.005) {
    ParticleMotion m;
    m.id = id;
    m.x_t0 = x_t0;
    m.x_t1 = x_t1;
    m.velocity = velocity;
    m.inverse_mass = inverse_mass;
    m.removed = removed;
    m.spacing = spacing;
    return m;
  }
  /// x_t1 = x_t0 + dt v
  void move(double dt) {
    for (std::size_t i = 0; i < id.size(); ++i) x_t1[i] = x_t0[i] + dt * velocity[i];
  }
  void drop_removed() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < id.size(); ++i) {
      if (removed[i]) continue;
      id[kept] = id[i];
      x_t0[kept] = x_t0[i];
      x_t1[kept] = x_t1[i];
      velocity[kept] = velocity[i];
      inverse_mass[kept] = inverse_mass[i];
      removed[kept++] = 0;
    }
    id.resize(kept), x_t0.resize(kept), x_t1.resize(kept), velocity.resize(kept), inverse_mass.resize(kept),
        removed.resize(kept);
  }
};

/// A grid of (nu × nv) nodes over origin + s·u + t·v, two triangles a cell; node (i, j) has index i + nu·j.
inline SurfaceMotion make_grid(std::uint32_t nu, std::uint32_t nv, const Vec3& origin, const Vec3& u,
                               const Vec3& v, double node_mass, double thickness, double max_coordinate,
                               Storage storage, std::uint64_t id = 1) {
  SurfaceMotion s;
  s.id = id;
  s.storage = storage;
  s.thickness = thickness;
  s.delta = minimum_separation(thickness, max_coordinate, storage);
  for (std::uint32_t j = 0; j < nv; ++j)
    for (std::uint32_t i = 0; i < nu; ++i)
      s.x_t0.push_back(stored(origin + u * (i / (nu - 1.0)) + v * (j / (nv - 1.0)), storage));
  for (std::uint32_t j = 0; j + 1 < nv; ++j)
    for (std::uint32_t i = 0; i + 1 < nu; ++i) {
      const std::uint32_t a = i + nu * j, b = a + 1, c = a + nu, d = c + 1;
      s.triangles.push_back({a, b, d});
      s.triangles.push_back({a, d, c});
    }
  const std::size_t n = s.x_t0.size();
  s.x_t1 = s.x_t0;
  s.velocity.assign(n, Vec3::Zero());
  s.inverse_mass.assign(n, node_mass > 0 ? 1 / node_mass : 0);
  s.holdable.assign(n, 0);
  s.impulse.assign(n, Vec3::Zero());
  s.moved.assign(n, 0);
  return s;
}

}  // namespace oilskin::test
