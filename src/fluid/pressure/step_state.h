/// The data of one fluid step that its stages share.
#pragma once

#include "core/parallel.h"
#include "fluid/boundary/boundary.h"
#include "fluid/neighbours.h"
#include "fluid/pressure/prediction_contact.h"

namespace oilskin::fluid {

struct StepState {
  StepState(const Workers& w, double support_ratio) : boundary(support_ratio), workers(w) {}

  // Input
  Boundary boundary;  ///< empty if no surface is near, or without boundary terms
  const Workers& workers;
  double dt = 0;           ///< [s]
  double previous_dt = 0;  ///< of the step that wrote the pressures [s]; 0 = none
  Vec3 gravity = Vec3::Zero();
  Span<const PredictionContact> contacts;  ///< sorted by particle

  // State of the step. Positions in units of H relative to neighbours.origin(), velocities in m/s.
  Neighbours neighbours;
  std::uint64_t hidden_pairs = 0;
  std::vector<Record> velocity;  ///< with one more for the padding
  /// Mass over that of a new particle, with one more for the padding; empty = all are 1.
  std::vector<float> mass_ratio;
  /// Per chunk and pair: w'(q)/q of the pressure's kernel at the start. Empty: loops compute them.
  std::vector<std::vector<float>> slope;
  /// Slopes take 4 bytes a pair, 160 a particle. They are stored for so many particles, and at walls, where
  /// images change them (B.32). Computed ones have the same bits, but loops take up to 1.2 times as long.
  std::size_t most_with_slopes = 250000;

  std::vector<std::uint8_t> is_close;  ///< per particle: a neighbour is nearer than close pairs are (F.86)

  // Output
  std::vector<float> relative_density;  ///< ρ/ρ0 at the start
  std::vector<Vec3> dv;                 ///< change of velocity, gravity included [m/s]

  std::size_t size() const { return neighbours.size(); }
  const std::vector<Record>& position() const { return neighbours.records(); }
  double relative_mass(std::size_t i) const {
    return mass_ratio.empty() ? 1 : static_cast<double>(mass_ratio[i]);
  }
  /// Point of the boundary of particle i, or Boundary::none.
  std::uint32_t wall_point_of(std::size_t i) const {
    return boundary.empty() ? Boundary::none : boundary.point_of(i);
  }
  /// f(i) for every particle; the tasks are the chunks of the neighbour lists.
  template <class F>
  void for_each(const F& f) const {
    workers.for_each(size(), Neighbours::chunk_size, f);
  }
  /// f(begin, end) for every chunk.
  template <class F>
  void for_chunks(const F& f) const {
    workers.for_chunks(size(), Neighbours::chunk_size,
                       [&](std::size_t begin, std::size_t end, std::size_t) { f(begin, end); });
  }
  /// Σ f(begin, end) in the order of the chunks.
  template <class T, class F>
  T ordered_sum(T zero, const F& f) const {
    return workers.ordered_sum(size(), Neighbours::chunk_size, zero, f);
  }
};

}  // namespace oilskin::fluid
