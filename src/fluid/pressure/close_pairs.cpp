#include "fluid/pressure/close_pairs.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "fluid/pressure/pair_sums.h"
#include "fluid/random.h"
#include "fluid/stability.h"

namespace oilskin::fluid {

namespace {

/// Below it a pair has no direction of its own [H].
constexpr double coincident = 1e-6;

/// From j to i, of length 1. Coincident particles part in a direction that their places in the order give, so
/// that many in one point do not line up.
Vec3 direction(const Vec3& delta, double distance, std::uint32_t i, std::uint32_t j) {
  if (distance > coincident) return delta / distance;
  const std::uint64_t pair = (std::uint64_t{std::min(i, j)} << 32) | std::max(i, j);
  Vec3 n;
  for (int k = 0; k < 3; ++k) n[k] = random_unit(pair, static_cast<std::uint64_t>(k)) - 0.5;
  if (!(n.norm() > 0)) n = Vec3::UnitX();
  return (i < j ? 1 : -1) / n.norm() * n;
}

class ClosePairs {
 public:
  ClosePairs(StepState& state, double spacing, double h)
      : state_(state),
        reach_(closest_spacing * spacing / h),
        rate_(h / std::max(state.dt, recovery_time(spacing, state.gravity.norm()))) {
    for (std::uint32_t i = 0; i < state.size(); ++i)
      if (state.is_close[i] != 0) particles_.push_back(i);
  }

  void part() {
    for (const std::uint32_t i : particles_) {
      std::uint32_t n = 0;
      for_each_of(i, [&](std::uint32_t, const Vec3&, double) { ++n; });
      count_.push_back(n);
    }
    for (std::size_t k = 0; k < particles_.size(); ++k) push(particles_[k], count_[k]);
  }

 private:
  /// f(j, Δ, |Δ|) for each close neighbour, lengths in H.
  template <class F>
  void for_each_of(std::uint32_t i, const F& f) const {
    const std::vector<Record>& x = state_.position();
    const std::uint32_t* list = state_.neighbours.list(i);
    for (std::uint32_t k = 0; k < state_.neighbours.count(i); ++k) {
      const Vec3 delta = to_vector(x[i]) - to_vector(x[list[k]]);
      const double distance = delta.norm();
      if (distance < reach_) f(list[k], delta, distance);
    }
  }
  /// The pushes of all neighbours together have the size of one.
  void push(std::uint32_t i, std::uint32_t count) {
    for_each_of(i, [&](std::uint32_t j, const Vec3& delta, double distance) {
      const Vec3 n = direction(delta, distance, i, j);
      const double parting = (to_vector(state_.velocity[i]) - to_vector(state_.velocity[j])).dot(n);
      const double wanted = rate_ * (reach_ - distance);
      if (!(std::abs(parting) < wanted)) return;  // they part, or pass each other
      const double share = state_.relative_mass(j) / (state_.relative_mass(i) + state_.relative_mass(j));
      state_.dv[i] += share * (wanted - parting) / std::max(count, count_of(j)) * n;
    });
  }
  std::uint32_t count_of(std::uint32_t j) const {
    const auto at = std::lower_bound(particles_.begin(), particles_.end(), j);
    return at != particles_.end() && *at == j ? count_[static_cast<std::size_t>(at - particles_.begin())] : 1;
  }

  StepState& state_;
  const double reach_;                            // r₀ [H]
  const double rate_;                             // H/t [m/s]
  std::vector<std::uint32_t> particles_, count_;  // those with close neighbours, ascending; how many
};

}  // namespace

void part_close_pairs(StepState& state, double spacing, double support_radius) {
  OILSKIN_ASSERT(state.is_close.size() == state.size() && state.dt > 0);
  ClosePairs(state, spacing, support_radius).part();
}

}  // namespace oilskin::fluid
