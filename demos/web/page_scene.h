/// A scene that a page shows: steps it, and counts what its steps report.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hosts/simulation.h"

namespace oilskin::demo {

/// Sums over the steps since the scene began.
struct PageCounts {
  std::uint64_t steps = 0;
  std::uint64_t certified = 0;       ///< steps that end with the certificate
  std::uint64_t crossings = 0;       ///< found by contact.verify
  std::uint64_t verified_pairs = 0;  ///< tested by contact.verify
  std::uint64_t emitted = 0, removed = 0;
};

class PageScene {
 public:
  /// `text` is a scene file in JSON, `settings` are assignments KEY=VALUE as those of `oilskin run --set`.
  /// Throws SceneError for what is refused.
  PageScene(const std::string& text, const std::vector<std::string>& settings);

  /// One step of the scene's dt. Throws SceneError if it is refused.
  void step();

  /// Switches the continuous test and impact zones, contact.ccd and contact.zones, from the next step on.
  void set_contact(bool on);

  /// Takes hold of the first cloth where it is nearest to `point` [m], as in `oilskin view`. Throws
  /// SceneError for nodes that move as the scene prescribes.
  void grab(const Vec3& point);
  /// Where the held place is to be [m]; nothing while nothing is held. Throws SceneError for what is not
  /// finite.
  void pull(const Vec3& goal);
  void release();
  /// Turns the first nozzle to a direction. Throws SceneError without a nozzle or a direction.
  void aim(const Vec3& direction);

  /// Four numbers per particle: position [m] and speed [m/s].
  const std::vector<float>& particles();
  /// Three numbers per node of the first cloth: position [m].
  const std::vector<float>& nodes();
  /// Three nodes per triangle of the first cloth.
  const std::vector<std::uint32_t>& triangles();
  /// The counts, the first nozzle, the last step's times and contact numbers, and the flags in words, as a
  /// JSON object.
  std::string report() const;
  std::uint64_t state_hash() const { return simulation_->world().state_hash(); }
  /// Describes the scene as a JSON object: name, description, dt, spacing, precision, instruction set.
  std::string description() const;
  const PageCounts& counts() const { return counts_; }

 private:
  Scene scene_;
  std::unique_ptr<Simulation> simulation_;
  PageCounts counts_;
  StepReport last_;
  double host_seconds_ = 0;  ///< of the last step
  std::vector<float> particles_, nodes_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace oilskin::demo
