// Compiled with -mavx2: what both sides of the link must agree on.
#include <fcl/math/bv/AABB.h>
#include <fcl/narrowphase/collision_object.h>
#include <gtest/gtest.h>

#ifndef __AVX2__
#error "this file shows something only when it is compiled with -mavx2"
#endif

namespace {

TEST(Alignment, fcl_types_are_laid_out_as_in_a_baseline_build) {
  static_assert(alignof(fcl::Transform3<double>) == 16, "libfcl was compiled with 16");
  static_assert(sizeof(fcl::CollisionObject<double>) == 224, "libfcl was compiled with 224");
  SUCCEED();
}

}  // namespace
