/// What the parts of one fluid step hand to each other.
#pragma once

#include "core/parallel.h"
#include "fluid/boundary/boundary.h"
#include "fluid/neighbours.h"
#include "fluid/pressure/prediction_contact.h"

namespace oilskin::fluid {

struct StepState {
  StepState(const Workers& w, double support_ratio) : boundary(support_ratio), workers(w) {}

  // Input
  Boundary boundary;  ///< empty where no surface is near, or none is asked for
  const Workers& workers;
  double dt = 0;           ///< [s]
  double previous_dt = 0;  ///< of the step that left the pressures [s]; 0 = there was none
  Vec3 gravity = Vec3::Zero();
  Span<const PredictionContact> contacts;  ///< sorted by particle

  // State of the step. Positions in units of H relative to neighbours.origin(), velocities in m/s.
  Neighbours neighbours;
  std::uint64_t hidden_pairs = 0;
  std::vector<Record> velocity;  ///< one more than there are particles: the padding's
  std::vector<std::vector<float>>
      slope;  ///< per chunk and pair: w'(q)/q of the pressure's kernel at the start

  // Output
  std::vector<float> relative_density;  ///< ρ/ρ0 at the start
  std::vector<Vec3> dv;                 ///< change of velocity by everything, gravity included [m/s]

  std::size_t size() const { return neighbours.size(); }
  std::vector<Record>& position() {
    return neighbours.records();
  }  ///< w: the pressure's share of a pair force
  float* slopes(std::size_t i) { return slope[i / Neighbours::chunk_size].data() + neighbours.pair_begin(i); }

  /// f(i) for every particle; the tasks are the chunks of the neighbour lists.
  template <class F>
  void for_each(const F& f) const {
    workers.for_each(size(), Neighbours::chunk_size, f);
  }
};

}  // namespace oilskin::fluid
