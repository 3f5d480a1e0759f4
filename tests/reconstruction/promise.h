/// The promise of the modes that keep away from obstacles.
#pragma once

#include "reconstruction/runs.h"
#include "reconstruction/scenes.h"
#include "reconstruction/triangle_oracle.h"

namespace oilskin::test {

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
