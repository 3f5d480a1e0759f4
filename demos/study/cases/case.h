/// Validation cases: scenes whose outcome is known from theory or experiment.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "checks/check.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// A measured number beside its reference.
struct Quantity {
  std::string name;
  double value = 0, reference = 0;
  /// What a difference is divided by; 0 = |reference|.
  double scale = 0;
  /// Of the reference, as a fraction of the scale: an error below it says nothing.
  double uncertainty = 0;
  /// The largest error that passes at the finest of the case's spacings; infinite: reported only.
  double tolerance = never;
  /// On coarser grids the tolerance grows as spacing^order; 0: it is the same on all.
  double order = 0;

  /// |value − reference| over the scale; infinite where the value is not finite.
  double error() const;
};

/// What is looked at while a case runs.
class Probe {
 public:
  virtual ~Probe() = default;

  virtual void after_step(const Moment& now) = 0;
  /// Once, after the last step.
  virtual std::vector<Quantity> quantities(const Moment& end) = 0;
};

struct ValidationCase {
  std::string name;       ///< one word
  std::string title;      ///< what is computed
  std::string reference;  ///< where the reference is from
  /// [m], from coarse to fine.
  std::vector<double> spacings;
  std::function<Scene(double spacing)> scene;
  std::function<std::unique_ptr<Probe>(const Scene& scene)> probe;
};

/// All cases, in the order of the documentation.
const std::vector<ValidationCase>& validation_cases();
/// Throws SceneError that names the nearest case.
const ValidationCase& validation_case(const std::string& name);

}  // namespace oilskin::demo
