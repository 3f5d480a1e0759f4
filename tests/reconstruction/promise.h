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

/// Two threads give the bits of one.
inline void expect_same_on_any_number_of_threads(const WaterScene& s, ReconstructionOptions options) {
  options.threads = 2;
  const WaterMesh two = reconstruct(s.input(), options);
  options.threads = 1;
  const WaterMesh one = reconstruct(s.input(), options);
  EXPECT_EQ(one.positions, two.positions);
  EXPECT_EQ(one.triangles, two.triangles);
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

/// The mesh keeps the promise, and its volume over that of the water is 1 within `tolerance`.
inline void expect_promise_and_volume(const WaterScene& s, const ReconstructionOptions& options,
                                      double tolerance) {
  ReconstructionReport report;
  const WaterMesh mesh = reconstruct(s.input(), options, &report);
  expect_promise(s, mesh, options.gap);
  EXPECT_NEAR(share_of(report, s), 1, tolerance) << int(options.contact);
}

}  // namespace oilskin::test
