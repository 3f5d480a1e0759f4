/// What takes hold of cloth or a body at one place and pulls it to another, as a hand or a mouse does.
#pragma once

#include <optional>
#include <vector>

#include "scene/cloth_model.h"

namespace oilskin::demo {

/// The held place follows its goal like a strong damped spring: 95 % of the way in 0.15 s, at 3 m/s at most.
/// What is held follows the place without yielding.
struct Grip {
  bool is_body = false;
  std::size_t index = 0;           ///< of the cloth or body in the scene
  std::vector<std::size_t> nodes;  ///< of the cloth; empty for a body
  std::vector<Vec3> offsets;       ///< of the nodes from `place` [m]
  Vec3 start = Vec3::Zero();       ///< where it was taken [m]
  Vec3 place = Vec3::Zero();       ///< where it is [m]
  Vec3 goal = Vec3::Zero();        ///< where it is to be [m]
  Vec3 velocity = Vec3::Zero();    ///< of `place` in the last sub-step [m/s]

  /// Moves `place` for dt [s] > 0.
  void advance(double dt);
};

/// Of the node nearest to `point`, and those that share a triangle with it. `x`: the nodes' positions.
/// `follows[k]`: node k moves as the scene prescribes and cannot be held. Empty where the nearest node is one
/// of those.
std::optional<Grip> grip_of_cloth(std::size_t index, const ClothModel& model, const std::vector<Vec3>& x,
                                  const std::vector<bool>& follows, const Vec3& point);

/// Why there is none.
constexpr const char* grip_refused = "these nodes move as the scene prescribes, and cannot be held";

Grip grip_of_body(std::size_t index, const Vec3& point);

}  // namespace oilskin::demo
