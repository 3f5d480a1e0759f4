// Contact alone: particles that fly like stones, a cloth of position-based dynamics, and oilskin/contact.h
// between them. Neither our fluid nor Bullet. Prints what happened; exit 1 if a particle passed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "oilskin/contact.h"

using oilskin::Triangle;
using oilskin::Vec3;

namespace {

const Vec3 gravity(0, -9.81, 0);

/// Somebody's cloth: n × n nodes over 0.4 m × 0.4 m, hung up at its corners.
struct Cloth {
  static constexpr std::uint32_t n = 25;
  struct Link {
    std::uint32_t a, b;
    double length;
  };
  std::vector<Vec3> x, v, proposed;
  std::vector<double> inverse_mass;
  std::vector<Triangle> triangles;
  std::vector<Link> links;

  explicit Cloth(double mass) : inverse_mass(n * n, n * n / mass) {
    for (std::uint32_t i = 0; i < n * n; ++i)
      x.push_back(0.4 * Vec3(i % n / (n - 1.) - 0.5, 0, i / n / (n - 1.) - 0.5));
    v.assign(n * n, Vec3::Zero());
    for (std::uint32_t i = 0; i + n < n * n; ++i) {
      link(i, i + n);
      if (i % n == n - 1) continue;
      link(i, i + n + 1), link(i + 1, i + n);
      triangles.push_back({i, i + n, i + n + 1});
      triangles.push_back({i, i + n + 1, i + 1});
    }
    for (std::uint32_t i = 0; i < n * n; ++i)
      if (i % n < n - 1) link(i, i + 1);
    for (std::uint32_t corner : {0u, n - 1, n * (n - 1), n * n - 1}) inverse_mass[corner] = 0;
  }

  void link(std::uint32_t a, std::uint32_t b) { links.push_back({a, b, (x[a] - x[b]).norm()}); }

  /// Position-based dynamics: fly, pull the links back to their lengths, read the velocity off the way.
  void propose(double dt) {
    proposed = x;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (inverse_mass[i] > 0) proposed[i] += dt * (v[i] + dt * gravity);
    for (int iteration = 0; iteration < 20; ++iteration)
      for (const Link& l : links) {
        const double w = inverse_mass[l.a] + inverse_mass[l.b];
        const Vec3 d = proposed[l.b] - proposed[l.a];
        if (w == 0 || d.isZero(0)) continue;
        const Vec3 pull = (d.norm() - l.length) / (w * d.norm()) * d;
        proposed[l.a] += inverse_mass[l.a] * pull;
        proposed[l.b] -= inverse_mass[l.b] * pull;
      }
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = (proposed[i] - x[i]) / dt;
  }
};

/// Somebody's particles.
struct Particles {
  std::vector<std::uint64_t> id;
  std::vector<Vec3> x, v, proposed;
  std::vector<double> inverse_mass;
  std::vector<std::uint8_t> removed;

  void add(const Vec3& position, const Vec3& velocity, double mass) {
    id.push_back(id.size());
    x.push_back(position);
    v.push_back(velocity);
    inverse_mass.push_back(1 / mass);
    removed.push_back(0);
  }
  void propose(double dt) {
    proposed = x;
    for (std::size_t i = 0; i < x.size(); ++i) {
      v[i] += dt * gravity;
      proposed[i] += dt * v[i];
    }
  }
};

/// What contact is told of the cloth once …
oilskin::SurfaceMotion surface_of(const Cloth& cloth) {
  oilskin::SurfaceMotion s;
  s.id = 1;
  s.triangles = cloth.triangles;
  s.thickness = 0.002;
  s.delta = oilskin::minimum_separation(s.thickness, /*largest coordinate=*/10, s.storage);
  s.slip.model = oilskin::SlipModel::coulomb;
  s.slip.friction = 0.5;
  s.nodes_movable = false;  // position-based dynamics would make speed of it
  s.inverse_mass = cloth.inverse_mass;
  return s;
}

}  // namespace

int main(int argc, char** argv) {
  char* end = nullptr;
  const double speed = argc > 1 ? std::strtod(argv[1], &end) : 3;  // of the particles [m/s]
  if (argc > 2 || !(speed >= 0 && speed <= 1e6) || (argc > 1 && (end == argv[1] || *end))) {
    std::fprintf(stderr, "usage: contact_alone [speed, 0 … 1e6 m/s]\n");
    return 2;
  }
  const double dt = 0.001;
  Cloth cloth(0.08);
  Particles particles;
  oilskin::SurfaceMotion sheet = surface_of(cloth);
  oilskin::SurfaceMotion* surfaces[] = {&sheet};
  oilskin::ContactSolver contact;
  oilskin::ContactReport report;
  std::uint64_t crossings = 0, contacts = 0, removed = 0;
  Vec3 given = Vec3::Zero();

  for (int step = 0; step < 1000; ++step) {
    if (step % 2 == 0 && particles.id.size() < 300) {
      const double a = 2.4 * static_cast<double>(particles.id.size());  // a sunflower's spiral
      const double r = 0.05 * std::sqrt(static_cast<double>(particles.id.size()) / 300);
      particles.add({r * std::cos(a), 0.1, r * std::sin(a)}, {0, -speed, 0}, 1.25e-4);
    }
    cloth.propose(dt);
    particles.propose(dt);

    // … and in every step.
    sheet.x_t0 = cloth.x;
    sheet.x_t1 = cloth.proposed;
    sheet.velocity = cloth.v;
    oilskin::ParticleMotion motion;
    motion.id = particles.id;
    motion.x_t0 = particles.x;
    motion.x_t1 = particles.proposed;
    motion.velocity = particles.v;
    motion.inverse_mass = particles.inverse_mass;
    motion.removed = particles.removed;
    const oilskin::Status status = contact.resolve(dt, motion, surfaces, report);
    if (!status.ok()) {
      std::fprintf(stderr, "refused: %s\n", status.message.c_str());
      return 2;
    }
    crossings += oilskin::ContactSolver::count_crossings(motion, surfaces);
    contacts += report.contacts;
    removed += report.removed;
    given += report.impulse_on_free_nodes + report.impulse_on_prescribed;

    cloth.x = sheet.x_t1;
    cloth.v = sheet.velocity;
    particles.x = particles.proposed;
  }

  int carried = 0;
  double fastest = 0;
  for (std::size_t i = 0; i < particles.id.size(); ++i) {
    carried += particles.x[i].y() > -0.4;  // what the cloth lets go falls by metres
    if (particles.x[i].y() > -0.4) fastest = std::max(fastest, particles.v[i].norm());
  }
  std::printf("%zu particles, %d carried by the cloth, %llu removed\n", particles.id.size(), carried,
              static_cast<unsigned long long>(removed));
  std::printf("%llu contacts, %.3g N s given to the cloth, fastest particle on it %.2g m/s\n",
              static_cast<unsigned long long>(contacts), given.norm(), fastest);
  std::printf("crossings: %llu\n", static_cast<unsigned long long>(crossings));
  return crossings == 0 && removed == 0 ? 0 : 1;
}
