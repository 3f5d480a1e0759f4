/// Runs that the tests of reconstruction share.
#pragma once

#include <gtest/gtest.h>

#include "oilskin/reconstruction.h"

namespace oilskin::test {

inline WaterMesh reconstruct(const ReconstructionInput& input, const ReconstructionOptions& options,
                             ReconstructionReport* report = nullptr) {
  WaterMesh mesh;
  const Status status = reconstruct_surface(input, options, &mesh, report);
  EXPECT_TRUE(status.ok()) << status.message;
  return mesh;
}

inline void expect_closed(const MeshCheck& c) {
  EXPECT_EQ(c.open_edges, 0u);
  EXPECT_EQ(c.crowded_edges, 0u);
  EXPECT_EQ(c.misoriented_edges, 0u);
  EXPECT_EQ(c.pinched_vertices, 0u);
}

inline void expect_clean(const MeshCheck& c, double gap) {
  expect_closed(c);
  EXPECT_EQ(c.intersecting_pairs, 0u);
  EXPECT_EQ(c.too_close_pairs, 0u);
  EXPECT_EQ(c.submerged_components, 0u);
  EXPECT_TRUE(c.min_distance > gap) << c.min_distance;
  EXPECT_TRUE(c.clean());
}

}  // namespace oilskin::test
