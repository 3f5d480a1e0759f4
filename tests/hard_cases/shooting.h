/// Shots at a mesh, judged by exact arithmetic.
#pragma once

#include "hard_cases/hard_case.h"
#include "support/random.h"

namespace oilskin::test {

/// A particle on each side of every target, aimed so that it would be as far on the other side after dt.
void aim(ContactScene& scene, const std::vector<Vec3>& targets, double speed, Random& random,
         bool straight = false);

/// Whether the straight paths of a particle and of some triangle touch, in exact arithmetic.
bool exactly_intersects(const ContactScene& scene, std::size_t particle = 0);

/// Shots through the plane with the normal `up` through the origin: those that would hit the mesh must end
/// on the side where they began if the mesh stands still.
struct Shooting {
  Found found;
  std::uint64_t true_hits = 0;

  void shoot(ContactScene scene, const Vec3& up, bool still);
  void expect_in(HardCase& row) const;
};

}  // namespace oilskin::test
