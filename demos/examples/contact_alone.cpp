// Contact without Oilskin's fluid and without Bullet: stones fall on a cloth of position-based dynamics, and
// ContactSolver::resolve() corrects the motion that both propose. Exit 1 if a stone passes the cloth.
//   contact_alone [SPEED]      of the stones [m/s], default 3
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "oilskin/contact.h"

using oilskin::Vec3;

constexpr std::uint32_t n = 25, stones = 300;  // nodes along an edge of the cloth
constexpr double dt = 0.001;                   // [s]
const Vec3 gravity(0, -9.81, 0);

/// 0.4 m × 0.4 m, 80 g, hung up at its corners.
static oilskin::SurfaceMotion make_cloth() {
  oilskin::SurfaceMotion cloth;
  cloth.id = 1;
  cloth.thickness = 0.002;
  cloth.delta = oilskin::minimum_separation(cloth.thickness, /*largest coordinate=*/10, cloth.storage);
  cloth.slip = {oilskin::SlipModel::coulomb, /*friction=*/0.5};
  cloth.nodes_movable = false;  // it takes its velocity from its positions: a moved node would gain speed
  cloth.velocity.assign(n * n, Vec3::Zero());
  cloth.inverse_mass.assign(n * n, n * n / 0.08);
  for (std::uint32_t corner : {0u, n - 1, n * (n - 1), n * n - 1}) cloth.inverse_mass[corner] = 0;
  for (std::uint32_t i = 0; i < n * n; ++i) {
    const std::uint32_t column = i % n, row = i / n;
    cloth.x_t1.push_back(0.4 * Vec3(column / (n - 1.) - 0.5, 0, row / (n - 1.) - 0.5));
    if (column == n - 1 || row == n - 1) continue;
    cloth.triangles.push_back({i, i + n, i + n + 1});
    cloth.triangles.push_back({i, i + n + 1, i + 1});
  }
  return cloth;
}

/// What the cloth proposes for a step: free flight, then the edges pulled back to their rest lengths.
static void propose(oilskin::SurfaceMotion& cloth, const std::vector<Vec3>& rest) {
  std::vector<Vec3>& x = cloth.x_t1;
  const std::vector<double>& w = cloth.inverse_mass;
  cloth.x_t0 = x;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (w[i] > 0) x[i] += dt * (cloth.velocity[i] + dt * gravity);
  for (int iteration = 0; iteration < 20; ++iteration)
    for (const auto& [a, b, c] : cloth.triangles)
      for (const auto& [i, j] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
        const Vec3 d = x[j] - x[i];
        const Vec3 pull = (1 - (rest[j] - rest[i]).norm() / d.norm()) / (w[i] + w[j]) * d;
        x[i] += w[i] * pull, x[j] -= w[j] * pull;
      }
  for (std::size_t i = 0; i < x.size(); ++i) cloth.velocity[i] = (x[i] - cloth.x_t0[i]) / dt;
}

int main(int argc, char** argv) {
  const double speed = argc > 1 ? std::atof(argv[1]) : 3;
  oilskin::SurfaceMotion cloth = make_cloth();
  oilskin::SurfaceMotion* surfaces[] = {&cloth};
  const std::vector<Vec3> rest = cloth.x_t1;
  std::vector<std::uint64_t> id;
  std::vector<Vec3> x_t0, x_t1, velocity(stones, Vec3(0, -speed, 0));
  std::vector<double> inverse_mass(stones, 1 / 1.25e-4);
  std::vector<std::uint8_t> removed(stones, 0);
  for (std::uint32_t i = 0; i < stones; ++i) {  // a spiral, a stone every 2 ms
    const double a = 2.4 * i, r = 0.05 * std::sqrt(i / 300.);
    id.push_back(i);
    x_t1.emplace_back(r * std::cos(a), 0.1 + 0.002 * speed * i, r * std::sin(a));
  }

  oilskin::ContactSolver contact;
  unsigned long long contacts = 0, crossings = 0, lost = 0;
  for (int step = 0; step < 1000; ++step) {
    propose(cloth, rest);
    x_t0 = x_t1;
    for (std::uint32_t i = 0; i < stones; ++i) x_t1[i] += dt * (velocity[i] += dt * gravity);
    oilskin::ParticleMotion motion;
    motion.id = id, motion.inverse_mass = inverse_mass, motion.removed = removed;
    motion.x_t0 = x_t0, motion.x_t1 = x_t1, motion.velocity = velocity;
    oilskin::ContactReport report;
    const oilskin::Status status = contact.resolve(dt, motion, surfaces, report);
    if (!status.ok()) return std::fprintf(stderr, "refused: %s\n", status.message.c_str()), 1;
    contacts += report.contacts, lost += report.removed;
    crossings += oilskin::ContactSolver::count_crossings(motion, surfaces);  // independent of resolve()
  }

  int on_cloth = 0;
  for (const Vec3& x : x_t1) on_cloth += x.y() > -0.4;  // what passed has fallen by metres
  std::printf("%u stones, %d on the cloth, %llu removed\n", stones, on_cloth, lost);
  std::printf("%llu contacts, crossings: %llu\n", contacts, crossings);
  return contacts > 0 && crossings == 0 && lost == 0 ? 0 : 1;
}
