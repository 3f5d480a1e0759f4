/// A tilted sheet of mock cloth above a floor, for tests of whole worlds.
#pragma once

#include <gtest/gtest.h>

#include "audit/trace_auditor.h"
#include "support/mock_cloth.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin::test {

template <class Scalar>
struct ClothOverFloor {
  static constexpr std::uint32_t side = 17;  ///< nodes along an edge of the cloth
  MockCloth<Scalar> cloth;
  StaticMesh floor;
  SurfaceId cloth_id, floor_id;

  ClothOverFloor() : cloth(shape()) {
    cloth.gravity = Vec3(0, -9.81, 0);
    floor.add_rectangle(Vec3(-0.4, -0.1, -0.4), Vec3(0.8, 0, 0), Vec3(0, 0, 0.8), 3, 3);
  }
  /// Holds the first and the last row of nodes.
  void pin_two_borders() {
    for (std::size_t i = 0; i < side; ++i) {
      cloth.pin(i);
      cloth.pin((side - 1) * side + i);
    }
  }
  void attach_to(World& world) {
    EXPECT_TRUE(world.attach(cloth, sheet_settings(), &cloth_id).ok());
    EXPECT_TRUE(world.attach(floor, sheet_settings(0.002), &floor_id).ok());
  }
  /// δ of both, for the auditor.
  audit::Limits limits(const World& world) const {
    audit::Limits limits;
    for (SurfaceId id : {cloth_id, floor_id})
      limits.delta_of[world.surface(id)->id] = world.surface(id)->delta;
    return limits;
  }

 private:
  static GridShape shape() {
    GridShape g;
    g.nu = g.nv = side;
    g.origin = Vec3(-0.1, 0, -0.1);
    g.u = Vec3(0.2, 0.02, 0);
    g.v = Vec3(0, 0, 0.2);
    return g;
  }
};

}  // namespace oilskin::test
