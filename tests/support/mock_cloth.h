/// A mass–spring grid as a SurfaceHost: the smallest host that does all of its duties. Stores its numbers as
/// floats or doubles, integrates with symplectic Euler sub-steps, so that velocities are primary and nodes
/// may be moved.
#pragma once

#include <cmath>

#include "oilskin/surface_motion.h"

namespace oilskin::test {

struct GridShape {
  std::uint32_t nu = 9, nv = 9;
  Vec3 origin = Vec3::Zero(), u = Vec3(0.1, 0, 0), v = Vec3(0, 0, 0.1);
  double areal_density = 0.2;  ///< [kg/m²]
};

template <class Scalar>
class MockCloth : public SurfaceHost {
 public:
  using SVec = Eigen::Matrix<Scalar, 3, 1>;

  std::vector<SVec> x, v;
  std::vector<Scalar> inverse_mass;
  std::vector<Triangle> triangles;
  Vec3 gravity = Vec3::Zero();
  double stiffness = 200;  ///< of springs [N/m]
  double damping = 0.002;  ///< of springs [N s/m]
  bool pins_holdable = true;
  bool announce_new = false;  ///< the next gather reports a new surface

  explicit MockCloth(const GridShape& g = {}) {
    for (std::uint32_t j = 0; j < g.nv; ++j)
      for (std::uint32_t i = 0; i < g.nu; ++i) {
        x.push_back((g.origin + g.u * (i / (g.nu - 1.0)) + g.v * (j / (g.nv - 1.0))).template cast<Scalar>());
        v.push_back(SVec::Zero());
      }
    const auto node = [&](std::uint32_t i, std::uint32_t j) { return i + g.nu * j; };
    for (std::uint32_t j = 0; j < g.nv; ++j)
      for (std::uint32_t i = 0; i < g.nu; ++i) {
        if (i + 1 < g.nu) add_spring(node(i, j), node(i + 1, j));
        if (j + 1 < g.nv) add_spring(node(i, j), node(i, j + 1));
        if (i + 1 == g.nu || j + 1 == g.nv) continue;
        add_spring(node(i, j), node(i + 1, j + 1));
        add_spring(node(i + 1, j), node(i, j + 1));
        triangles.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1)});
        triangles.push_back({node(i, j), node(i + 1, j + 1), node(i, j + 1)});
      }
    const double mass = g.areal_density * g.u.cross(g.v).norm() / (g.nu * g.nv);
    inverse_mass.assign(x.size(), static_cast<Scalar>(1 / mass));
  }

  void pin(std::size_t node) { inverse_mass[node] = 0; }
  /// Of a pin: it weighs `dry_mass` [kg] and what it has absorbed.
  void free_pin(std::size_t node, double dry_mass) {
    inverse_mass[node] = static_cast<Scalar>(1 / (dry_mass + (absorbed_.empty() ? 0 : absorbed_[node])));
  }

  Gathered gather(double dt, SurfaceMotion& motion) override {
    const int substeps = dt > 0 ? static_cast<int>(std::ceil(dt / stable_step())) : 0;
    for (int k = 0; k < substeps; ++k) advance(dt / substeps);
    const bool is_new = motion.triangles.size() != triangles.size() || announce_new;
    announce_new = false;
    if (is_new) motion.triangles = triangles;
    motion.storage = sizeof(Scalar) == 4 ? Storage::float32 : Storage::float64;
    motion.nodes_movable = true;
    motion.x_t1.resize(x.size());
    motion.velocity.resize(x.size());
    motion.inverse_mass.resize(x.size());
    motion.holdable.assign(x.size(), pins_holdable ? 1 : 0);
    for (std::size_t i = 0; i < x.size(); ++i) {
      motion.x_t1[i] = x[i].template cast<double>();
      motion.velocity[i] = v[i].template cast<double>();
      motion.inverse_mass[i] = static_cast<double>(inverse_mass[i]);
      if (inverse_mass[i] == 0 && dt > 0 && motion.x_t0.size() == x.size())
        motion.velocity[i] = (motion.x_t1[i] - motion.x_t0[i]) / dt;  // a pin that the user moved
    }
    return {Status{}, is_new};
  }

  void scatter(SurfaceMotion& motion) override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      v[i] += (motion.inverse_mass[i] * motion.impulse[i]).template cast<Scalar>();
      if (motion.moved[i]) x[i] = motion.x_t1[i].template cast<Scalar>();
      motion.x_t1[i] = x[i].template cast<double>();
    }
    weigh_nodes(motion.absorbed_mass);
  }

  Vec3 momentum() const {
    Vec3 p = Vec3::Zero();
    for (std::size_t i = 0; i < x.size(); ++i)
      if (inverse_mass[i] > 0) p += v[i].template cast<double>() / static_cast<double>(inverse_mass[i]);
    return p;
  }

 private:
  struct Spring {
    std::uint32_t a, b;
    double rest;
  };

  void add_spring(std::uint32_t a, std::uint32_t b) {
    springs_.push_back({a, b, (x[b] - x[a]).template cast<double>().norm()});
  }

  void weigh_nodes(const std::vector<double>& absorbed) {
    if (absorbed.size() != x.size()) return;
    absorbed_.resize(x.size(), 0);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double change = absorbed[i] - absorbed_[i];
      absorbed_[i] = absorbed[i];
      if (inverse_mass[i] == 0 || change == 0) continue;
      inverse_mass[i] = static_cast<Scalar>(1 / (1 / static_cast<double>(inverse_mass[i]) + change));
    }
  }

  // Eight springs join at a node: their stiffest mode must stay well below symplectic Euler's limit of 2/ω.
  double stable_step() const {
    double lightest = std::numeric_limits<double>::infinity();
    for (Scalar u : inverse_mass)
      if (u > 0) lightest = std::min(lightest, 1 / static_cast<double>(u));
    return 0.25 * std::sqrt(lightest / (8 * stiffness));
  }

  void advance(double dt) {
    std::vector<Vec3> force(x.size(), Vec3::Zero());
    for (const Spring& s : springs_) {
      const Vec3 d = (x[s.b] - x[s.a]).template cast<double>();
      const double length = d.norm();
      if (length == 0) continue;
      const Vec3 along = d / length;
      const Vec3 relative = (v[s.b] - v[s.a]).template cast<double>();
      const Vec3 f = (stiffness * (length - s.rest) + damping * relative.dot(along)) * along;
      force[s.a] += f;
      force[s.b] -= f;
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (inverse_mass[i] == 0) continue;  // a pin stays where the user puts it
      v[i] += (dt * (gravity + static_cast<double>(inverse_mass[i]) * force[i])).template cast<Scalar>();
      x[i] += (dt * v[i].template cast<double>()).template cast<Scalar>();
    }
  }

  std::vector<Spring> springs_;
  std::vector<double> absorbed_;  // part of the mass of each node [kg]
};

}  // namespace oilskin::test
