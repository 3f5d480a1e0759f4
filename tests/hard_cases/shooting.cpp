#include "hard_cases/shooting.h"

#include <gtest/gtest.h>

#include "support/exact.h"

namespace oilskin::test {

void aim(ContactScene& scene, const std::vector<Vec3>& targets, double speed, Random& random, bool straight) {
  for (const Vec3& target : targets)
    for (double side : {1.0, -1.0}) {
      Vec3 displacement = Vec3(0, -side, 0);
      if (!straight) displacement = (displacement + 0.6 * random.in_cube(1)).normalized();
      scene.particles.add(target - 0.5 * displacement * speed * scene.dt, displacement * speed,
                          particle_mass);
    }
}

bool exactly_intersects(const ContactScene& scene, std::size_t particle) {
  const auto point = [](const Vec3& x) { return exact::Point{x.x(), x.y(), x.z()}; };
  const ParticleArrays& p = scene.particles;
  Box displacement;
  displacement.add(p.x_t0[particle]);
  displacement.add(p.x_t1[particle]);
  for (const SurfaceMotion& s : scene.surfaces)
    for (const Triangle& t : s.triangles) {
      exact::Motion m;
      m.t0[0] = point(p.x_t0[particle]);
      m.t1[0] = point(p.x_t1[particle]);
      Box swept;
      for (int k = 0; k < 3; ++k) {
        swept.add(s.x_t0[t[k]]);
        swept.add(s.x_t1[t[k]]);
        m.t0[k + 1] = point(s.x_t0[t[k]]);
        m.t1[k + 1] = point(s.x_t1[t[k]]);
      }
      if (swept.overlaps(displacement) && exact::point_triangle(m).hit) return true;
    }
  return false;
}

void Shooting::shoot(ContactScene scene, const Vec3& up, bool still) {
  std::vector<std::uint8_t> hits;
  for (std::size_t i = 0; i < scene.particles.id.size(); ++i) {
    hits.push_back(exactly_intersects(scene, i));
    true_hits += hits.back();
  }
  found.add(resolve_checked(scene));
  EXPECT_EQ(found.total.removed, 0u);
  for (std::size_t i = 0; still && i < hits.size(); ++i) {
    const double before = scene.particles.x_t0[i].dot(up), after = scene.particles.x_t1[i].dot(up);
    if (hits[i]) {
      EXPECT_GT(before * after, 0) << "particle " << i << " is not stopped";
    }
  }
}

void Shooting::expect_in(HardCase& row) const {
  const double shots = static_cast<double>(found.audit.particles);
  row.note("shots", found.audit.particles);
  row.above("true hits", static_cast<double>(true_hits), std::floor(shots / 2));
  row.no_crossings(found);
}

}  // namespace oilskin::test
