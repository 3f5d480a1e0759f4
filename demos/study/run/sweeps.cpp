#include "study/run/sweeps.h"

#include <cstdio>

namespace oilskin::demo {
namespace {

SweepPoint with(const std::string& label, const std::string& assignment) {
  SweepPoint point{label, 0, {}};
  point.variation.set = {assignment};
  return point;
}

Sweep setting(const std::string& name, const std::string& title, const std::string& key,
              const std::vector<std::string>& values) {
  Sweep sweep{name, title, {}};
  for (const std::string& value : values) {
    std::string assignment = key;
    assignment += "=";
    assignment += value;
    sweep.points.push_back(with(value, assignment));
  }
  return sweep;
}

/// The state equation has no boundary terms.
Sweep solver_sweep() {
  Sweep sweep = setting("solver", "pressure solver", "fluid.solver", {"mcg03", "pcisph", "dfsph"});
  sweep.points.front().variation.set.push_back("fluid.boundary=contact_only");
  return sweep;
}

Sweep step_sweep() {
  Sweep sweep{"step", "length of the step, over the case's", {}};
  for (const char* label : {"0.25", "0.5", "1", "2", "4", "8", "16"}) {
    sweep.points.push_back({label, 0, {}});
    sweep.points.back().variation.step = std::stod(label);
  }
  return sweep;
}

Sweep thickness_sweep() {
  Sweep sweep{"thickness", "thickness h of surfaces, in spacings", {}};
  for (const char* label : {"0.1", "0.2", "0.3", "0.5"}) {
    sweep.points.push_back({label, 0, {}});
    sweep.points.back().variation.thickness = std::stod(label);
  }
  return sweep;
}

Sweep preset_sweep() {
  Sweep sweep{"preset", "preset", {}};
  for (const char* label : {"none", "game", "film", "measurement"}) {
    sweep.points.push_back({label, 0, {}});
    sweep.points.back().variation.preset = preset_of(label);
  }
  return sweep;
}

Sweep host_sweep() {
  Sweep sweep{"host", "host of the surfaces", {}};
  for (const char* label : {"mock", "bullet", "bullet64"}) {
    sweep.points.push_back({label, 0, {}});
    sweep.points.back().variation.host = host_of(label);
  }
  return sweep;
}

}  // namespace

const std::vector<StudiedCase>& studied_cases() {
  static const std::vector<StudiedCase> all = {{"weight", "height / depth", 0.005},
                                               {"dam", "front, mean difference", 0.005715},
                                               {"plate_90", "normal force / (mass flow × speed)", 0.005},
                                               {"couette", "largest deviation / largest speed", 0.01}};
  return all;
}

const std::vector<Sweep>& sweeps() {
  static const std::vector<Sweep> all = {
      {"spacing", "spacing of the particles: those of the case", {}},
      step_sweep(),
      setting("tolerance", "fluid.tolerance", "fluid.tolerance", {"0.1", "0.01", "0.001", "0.0001"}),
      solver_sweep(),
      setting("sweeps", "contact.sweeps, the Gauss-Seidel iterations", "contact.sweeps", {"1", "5", "20"}),
      setting("boundary", "boundary terms", "fluid.boundary", {"contact_only", "mirrored"}),
      setting("support", "support radius / spacing", "fluid.support_ratio", {"1.8", "2", "2.2", "2.5"}),
      thickness_sweep(),
      preset_sweep(),
      host_sweep()};
  return all;
}

std::vector<SweepPoint> points_of(const Sweep& sweep, const ValidationCase& of) {
  if (!sweep.points.empty()) return sweep.points;
  std::vector<SweepPoint> points;
  for (const double spacing : of.spacings) {
    char label[40];
    std::snprintf(label, sizeof label, "%.4g mm", 1e3 * spacing);
    points.push_back({label, spacing, {}});
  }
  return points;
}

const Sweep& sweep(const std::string& name) {
  std::vector<std::string> names;
  for (const Sweep& s : sweeps()) {
    if (s.name == name) return s;
    names.push_back(s.name);
  }
  throw SceneError(name + ": there is no such sweep" + suggestion(name, names));
}

}  // namespace oilskin::demo
