/// Three channels of an effect's numbers, as vectors.
#pragma once

#include "oilskin/effect.h"

namespace oilskin::effects {

class ChannelVectors {
 public:
  static ChannelVectors of_nodes(EffectForces& f, std::size_t surface, std::size_t first) {
    return {f.of_nodes(surface, first), f.of_nodes(surface, first + 1), f.of_nodes(surface, first + 2)};
  }
  static ChannelVectors of_particles(EffectForces& f, std::size_t first) {
    return {f.of_particles(first), f.of_particles(first + 1), f.of_particles(first + 2)};
  }

  std::size_t size() const { return component_[0].size(); }
  Vec3 get(std::size_t i) const { return {component_[0][i], component_[1][i], component_[2][i]}; }
  /// Zero where `v` is not finite: the world saves the numbers.
  void set(std::size_t i, const Vec3& v) const {
    const bool finite = v.allFinite();
    for (std::size_t c = 0; c < 3; ++c) component_[c][i] = finite ? v[static_cast<Eigen::Index>(c)] : 0;
  }

 private:
  ChannelVectors(Span<double> x, Span<double> y, Span<double> z) : component_{x, y, z} {}

  std::array<Span<double>, 3> component_;
};

}  // namespace oilskin::effects
