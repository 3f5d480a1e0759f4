/// A fluid alone, in a tank whose walls are nothing but a bound on velocities.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "core/hash.h"
#include "fluid/fluid_solver.h"

namespace oilskin::fluid {

struct Tank {
  FluidSettings settings;
  std::shared_ptr<Workers> workers;
  FluidSolver solver;
  Particles particles;
  Vec3 gravity = Vec3(0, -9.81, 0);
  FluidReport report;
  StageSeconds seconds;
  bool walls = true;
  Box box{Vec3::Zero(), Vec3(1, 1, 1)};

  explicit Tank(const FluidSettings& s, int threads = 1)
      : settings(complete(s)), workers(std::make_shared<Workers>(threads)), solver(settings, workers) {}

  static FluidSettings complete(FluidSettings s) {
    s.xsph_rate = s.xsph_rate.value_or(10);
    return s;
  }

  /// The lattice, `distance` apart, with its corner half a distance off `corner`.
  void fill(int nx, int ny, int nz, double distance, const Vec3& corner = Vec3::Zero()) {
    for (int c = 0; c < nz; ++c)
      for (int b = 0; b < ny; ++b)
        for (int a = 0; a < nx; ++a) add(corner + distance * Vec3(a + 0.5, b + 0.5, c + 0.5), Vec3::Zero());
  }
  void add(const Vec3& x, const Vec3& v) {
    particles.push_back(particles.size() + 1, x, v, settings.rest_density);
  }

  /// Bounds on the velocity of particles near a wall, which keeps a quarter of the spacing free.
  std::vector<PredictionContact> contacts(double dt) const {
    std::vector<PredictionContact> all;
    const double gap = settings.spacing / 4, near = 2 * settings.spacing;
    for (std::uint32_t i = 0; i < particles.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const double low = particles.position[i][k] - box.min[k],
                     high = box.max[k] - particles.position[i][k];
        if (low < near) all.push_back({i, Vec3::Unit(k), -std::max(0.0, low - gap) / dt});
        if (high < near) all.push_back({i, -Vec3::Unit(k), -std::max(0.0, high - gap) / dt});
      }
    return all;
  }

  void step(double dt) {
    solver.prepare(particles, seconds);
    const std::vector<PredictionContact> bounds = walls ? contacts(dt) : std::vector<PredictionContact>();
    solver.propose(dt, gravity, particles, bounds, {}, particles.velocity, report, seconds);
    for (const PredictionContact& c : bounds) {
      Vec3& v = particles.velocity[c.particle];
      v += std::max(0.0, c.min_normal_velocity - v.dot(c.normal)) * c.normal;
    }
    for (std::size_t i = 0; i < particles.size(); ++i) particles.position[i] += dt * particles.velocity[i];
  }

  /// Particle numbers in order of id.
  std::vector<std::size_t> by_id() const {
    std::vector<std::size_t> order(particles.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return particles.id[a] < particles.id[b]; });
    return order;
  }

  std::uint64_t hash() const {
    Hash64 h;
    for (const std::size_t i : by_id()) {
      h.add(particles.id[i]);
      h.add(particles.position[i]);
      h.add(particles.velocity[i]);
      h.add(particles.density[i]);
      h.add(particles.pressure[i]);
    }
    return h.value();
  }

  /// Σ v / Σ |v|: momentum, all masses being equal.
  Vec3 velocity_sum() const {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& v : particles.velocity) sum += v;
    return sum;
  }
  double speed_sum() const {
    double sum = 0;
    for (const Vec3& v : particles.velocity) sum += v.norm();
    return sum;
  }
  double fastest() const {
    double v = 0;
    for (const Vec3& u : particles.velocity) v = std::max(v, u.norm());
    return v;
  }
  double densest() const { return *std::max_element(particles.density.begin(), particles.density.end()); }
  bool finite() const {
    for (std::size_t i = 0; i < particles.size(); ++i)
      if (!particles.position[i].allFinite() || !particles.velocity[i].allFinite() ||
          !std::isfinite(particles.pressure[i]) || !std::isfinite(particles.density[i]))
        return false;
    return true;
  }
};

inline FluidSettings water(double spacing = 0.005) {
  FluidSettings s;
  s.spacing = spacing;
  s.boundary = BoundaryModel::contact_only;
  return s;
}

inline std::string solver_name(PressureSolver solver) {
  return solver == PressureSolver::mcg03 ? "mcg03" : solver == PressureSolver::pcisph ? "pcisph" : "dfsph";
}

inline FluidSettings gas_water(double spacing = 0.005) {
  FluidSettings s = water(spacing);
  s.solver = PressureSolver::mcg03;
  return s;
}

}  // namespace oilskin::fluid
