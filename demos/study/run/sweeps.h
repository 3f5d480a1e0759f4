/// What `oilskin study` varies: one parameter at a time, over cases.
#pragma once

#include "study/run/case_run.h"

namespace oilskin::demo {

/// One value of a parameter.
struct SweepPoint {
  std::string label;
  double spacing = 0;  ///< [m]; 0 = that of all sweeps of the case
  Variation variation;
};

struct Sweep {
  std::string name;
  std::string title;
  std::vector<SweepPoint> points;  ///< one of them is the case as it is; empty: the spacings of the case
};

/// A case of the study, the quantity whose error is plotted, and the spacing of all sweeps but the first [m].
struct StudiedCase {
  std::string name, quantity;
  double spacing = 0;
};

const std::vector<StudiedCase>& studied_cases();
const std::vector<Sweep>& sweeps();
/// The points of a sweep over a case.
std::vector<SweepPoint> points_of(const Sweep& sweep, const ValidationCase& of);
/// Throws SceneError that names the nearest sweep.
const Sweep& sweep(const std::string& name);

}  // namespace oilskin::demo
