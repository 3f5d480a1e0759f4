/// A tank that a vertical sheet of cloth divides, with water at rest on both sides.
#pragma once

#include "study/cases/case.h"

namespace oilskin::demo {

struct TwoSides {
  double left = 0.06, right = 0.03;  ///< depths of the water [m]
  bool free_inside = false;          ///< only the sheet's border is pinned; else all of it
};

Scene two_sides_scene(const TwoSides& sides, double spacing);

/// The mean force on the sheet, over the last half of the run.
class SheetForce : public Probe {
 public:
  void after_step(const Moment& now) override;

 protected:
  /// The mean force along x, towards the right [N].
  double force() const { return force_.value(); }
  /// ½ ρ g b h² of the water on the side of x < 0 (side −1) or x > 0 (side 1) [N].
  static double one_sided(const Moment& end, int side);

 private:
  TimeMean force_;
};

}  // namespace oilskin::demo
