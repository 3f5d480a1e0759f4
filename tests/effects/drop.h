/// Drops: how they are made, and what is measured of them.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "oilskin/surface_tension.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin::test {

constexpr double pi = 3.14159265358979323846;

/// A drop of water, in the middle of nothing or on a plate, with its effect.
struct Drop {
  double radius;  ///< of a sphere of its volume [m]; before start() as asked for
  SurfaceTensionSettings settings;
  double dx, xsph_rate = 50;
  Vec3 gravity = Vec3::Zero();
  int threads = 1;
  double part_of_limit = 1;  ///< dt over the effect's longest interval

  SurfaceTension tension;
  StaticMesh plate;
  SurfaceId plate_id;
  std::unique_ptr<World> world;

  Drop(double radius_in_spacings, double spacing) : radius(radius_in_spacings * spacing), dx(spacing) {}

  /// [s]: that of capillary waves of a spacing.
  double unit() const { return std::sqrt(1000 * dx * dx * dx / settings.coefficient); }
  double dt() const { return part_of_limit * tension.longest_interval(world->fluid_settings()); }
  /// Of mode 2 of an inviscid drop (Rayleigh) [1/s].
  double rayleigh() const {
    return std::sqrt(8 * settings.coefficient / (1000 * radius * radius * radius)) / (2 * pi);
  }
  double speed_unit() const { return std::sqrt(settings.coefficient / (1000 * radius)); }

  void make_world() {
    FluidSettings fluid;
    fluid.spacing = dx;
    fluid.xsph_rate = xsph_rate;
    WorldSettings w;
    w.gravity = gravity;
    w.threads = threads;
    world = std::make_unique<World>(w, fluid);
    ASSERT_TRUE(tension.set_settings(settings).ok());
    ASSERT_TRUE(world->add_effect(tension).ok());
  }
  /// In the plane y = 0.
  void add_plate(double half_width) {
    plate.add_rectangle(Vec3(-half_width, 0, half_width), Vec3(2 * half_width, 0, 0),
                        Vec3(0, 0, -2 * half_width), 8, 8);
    SurfaceSettings surface;
    ASSERT_TRUE(world->attach(plate, surface, &plate_id).ok());
  }
  /// Particles of the lattice through `origin` where inside(x).
  template <class Inside>
  void fill(const Vec3& origin, double reach, const Inside& inside) {
    std::vector<Vec3> x;
    const int n = static_cast<int>(reach / dx) + 2;
    for (int i = -n; i <= n; ++i)
      for (int j = -n; j <= n; ++j)
        for (int k = -n; k <= n; ++k) {
          const Vec3 p = origin + dx * Vec3(i, j, k);
          if (inside(p)) x.push_back(p);
        }
    const std::vector<Vec3> v(x.size(), Vec3::Zero());
    std::uint64_t blocked = 0;
    ASSERT_TRUE(world->add_particles(x, v, &blocked).ok());
    ASSERT_EQ(blocked, 0u);
    radius = std::cbrt(3 * volume() / (4 * pi));
  }
  /// `origin`: of the lattice [dx].
  void start_as_sphere(double origin = 0.5) {
    make_world();
    const double r = radius;
    fill(Vec3::Constant(origin * dx), r, [r](const Vec3& p) { return p.norm() < r; });
  }
  double volume() const {
    return static_cast<double>(world->particle_count()) * world->particle_mass() / 1000;
  }

  /// For a time [s], with the velocities damped at a rate [1/s].
  void run(double time, double damping = 0) {
    const double end = world->time() + time;
    while (world->time() < end) {
      ASSERT_TRUE(world->step(dt()).status.ok());
      if (damping == 0) continue;
      std::vector<Vec3> change;
      for (const Vec3& v : world->velocities()) change.push_back(-std::min(1.0, damping * dt()) * v);
      ASSERT_TRUE(world->add_velocities(change).ok());
    }
  }

  Vec3 centre() const {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& x : world->positions()) sum += x;
    return sum / static_cast<double>(world->particle_count());
  }
  double rms_speed() const {
    double sum = 0;
    for (const Vec3& v : world->velocities()) sum += v.squaredNorm();
    return std::sqrt(sum / static_cast<double>(world->particle_count()));
  }
  /// ⟨2 y² − x² − z²⟩/R².
  double elongation() const {
    const Vec3 c = centre();
    double sum = 0;
    for (const Vec3& x : world->positions()) {
      const Vec3 d = x - c;
      sum += 3 * d.y() * d.y() - d.squaredNorm();
    }
    return sum / (static_cast<double>(world->particle_count()) * radius * radius);
  }
  /// The radius of a sphere whose cone of 30° about a direction holds as many particles, over the 26
  /// directions of a cube: largest over smallest.
  double roundness() const {
    const Vec3 c = centre();
    double low = 1e9, high = 0;
    for (int a = -1; a <= 1; ++a)
      for (int b = -1; b <= 1; ++b)
        for (int d = -1; d <= 1; ++d) {
          if (a == 0 && b == 0 && d == 0) continue;
          const Vec3 e = Vec3(a, b, d).normalized();
          double count = 0;
          for (const Vec3& x : world->positions())
            count += (x - c).dot(e) > std::cos(pi / 6) * (x - c).norm();
          low = std::min(low, std::cbrt(count));
          high = std::max(high, std::cbrt(count));
        }
    return high / low;
  }
};

struct Oscillation {
  double frequency = 0, decay = 0, amplitude = 0, residual = 0;  ///< without damping [1/s], [1/s], –, –
};

/// a + e^(−λt) (b cos ωt + c sin ωt), by least squares over a grid of ω and λ.
inline Oscillation fit_oscillation(const std::vector<double>& t, const std::vector<double>& q, double guess) {
  Oscillation best;
  double least = 1e99;
  const auto n = static_cast<Eigen::Index>(t.size());
  const Eigen::Map<const Eigen::VectorXd> y(q.data(), n);
  for (double f = 0.6 * guess; f < 1.6 * guess; f += 0.004 * guess)
    for (double decay = 0; decay < 3 * guess; decay += 0.1 * guess) {
      Eigen::MatrixXd m(n, 3);
      for (Eigen::Index k = 0; k < n; ++k) {
        const double at = t[static_cast<std::size_t>(k)], e = std::exp(-decay * at);
        m.row(k) << 1, e * std::cos(2 * pi * f * at), e * std::sin(2 * pi * f * at);
      }
      const Eigen::Matrix3d normal = m.transpose() * m;
      const Eigen::Vector3d s = normal.ldlt().solve(m.transpose() * y);
      const double error = (m * s - y).squaredNorm();
      if (error >= least) continue;
      least = error;
      const double size = std::hypot(s[1], s[2]);
      best = {std::hypot(f, decay / (2 * pi)), decay, size, std::sqrt(error / static_cast<double>(n)) / size};
    }
  return best;
}

/// Mode 2 of a drop at rest, started with velocities that would deform it by `amplitude` of its radius.
inline Oscillation oscillate(Drop& drop, double amplitude, double periods) {
  const Vec3 c = drop.centre();
  const double rate = 0.5 * amplitude * 2 * pi * drop.rayleigh(), begin = drop.world->time();
  std::vector<Vec3> change;
  for (const Vec3& x : drop.world->positions())
    change.push_back(rate * (3 * (x - c).y() * Vec3::UnitY() - (x - c)));
  EXPECT_TRUE(drop.world->add_velocities(change).ok());
  std::vector<double> t, q;
  while (drop.world->time() - begin < periods / drop.rayleigh()) {
    EXPECT_TRUE(drop.world->step(drop.dt()).status.ok());
    t.push_back(drop.world->time() - begin);
    q.push_back(drop.elongation());
  }
  return fit_oscillation(t, q, drop.rayleigh());
}

/// The height of the centroid of a spherical cap of a volume above its base, of its contact angle [rad].
inline double cap_centroid(double volume, double angle) {
  const double c = std::cos(angle);
  const double r = std::cbrt(3 * volume / (pi * (2 + c) * (1 - c) * (1 - c))), h = r * (1 - c);
  return 3 * (2 * r - h) * (2 * r - h) / (4 * (3 * r - h)) - r * c;
}

/// The contact angle [degrees] of the cap with the volume and the centroid of a drop on its plate.
inline double contact_angle(const Drop& drop) {
  double low = 0.02, high = 3.12;
  const double height = drop.centre().y(), volume = drop.volume();
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (cap_centroid(volume, middle) < height ? low : high) = middle;
  }
  return 0.5 * (low + high) * 180 / pi;
}

}  // namespace oilskin::test
