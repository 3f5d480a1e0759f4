/// The promise of the modes that keep away from obstacles.
#pragma once

#include "reconstruction/runs.h"
#include "reconstruction/scenes.h"
#include "reconstruction/triangle_oracle.h"

namespace oilskin::test {

/// `gap` in spacings.
inline ReconstructionOptions options_for(const WaterScene& s, double cell, double gap, ObstacleMode contact) {
  ReconstructionOptions o;
  o.spacing = s.spacing;
  o.cell = cell;
  o.gap = gap * s.spacing;
  o.contact = contact;
  o.threads = 2;
  return o;
}

/// The volume of the mesh over that of the water, spacing³ a particle.
inline double share_of(const ReconstructionReport& report, const WaterScene& s) {
  return report.volume / (double(s.particles.size()) * std::pow(s.spacing, 3));
}

inline Vec3 position(const WaterMesh& mesh, std::uint32_t v) {
  return {mesh.positions[v][0], mesh.positions[v][1], mesh.positions[v][2]};
}

/// By both routes: the library's check, and exact signs and long doubles.
inline void expect_promise(const WaterScene& s, const WaterMesh& mesh, double gap) {
  expect_clean(check_mesh(mesh, s.obstacles(), gap), gap);
  for (const ObstacleMesh& obstacle : s.obstacles()) {
    const PairAudit audit = audit_pairs(mesh, obstacle, gap + 1e-4);
    EXPECT_EQ(audit.meeting, 0u);
    EXPECT_GT(audit.minimum, gap);
    // Obstacles that a host writes as floats keep it, too.
    std::vector<Vec3> rounded;
    for (const Vec3& v : obstacle.vertices) rounded.push_back(v.cast<float>().cast<double>());
    const PairAudit audit_of_floats = audit_pairs(mesh, {rounded, obstacle.triangles}, gap + 1e-4);
    EXPECT_EQ(audit_of_floats.meeting, 0u);
    EXPECT_GE(audit_of_floats.minimum, gap);
  }
}

}  // namespace oilskin::test
