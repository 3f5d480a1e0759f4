#include "oilskin/report.h"

#include <algorithm>

namespace oilskin {

StageSeconds& StageSeconds::operator+=(const StageSeconds& o) {
  gather += o.gather;
  neighbours += o.neighbours;
  pressure += o.pressure;
  other_fluid += o.other_fluid;
  proximity += o.proximity;
  impulses += o.impulses;
  ccd += o.ccd;
  zones += o.zones;
  effects += o.effects;
  verify += o.verify;
  return *this;
}

void ContactReport::add(const ContactReport& o) {
  candidates += o.candidates;
  contacts += o.contacts;
  meetings += o.meetings;
  rounds += o.rounds;
  zone_rounds += o.zone_rounds;
  zone_points += o.zone_points;
  held += o.held;
  nudged += o.nudged;
  stalled += o.stalled;
  followed += o.followed;
  removed += o.removed;
  allowed += o.allowed;
  reseeded += o.reseeded;
  least_distance = std::min(least_distance, o.least_distance);
  crossings_found_by_verify += o.crossings_found_by_verify;
  verified_pairs += o.verified_pairs;
  impulse_on_free_nodes += o.impulse_on_free_nodes;
  impulse_on_prescribed += o.impulse_on_prescribed;
  momentum_removed += o.momentum_removed;
  kinetic_energy_change += o.kinetic_energy_change;
}

Vec3 StepReport::momentum_residual() const {
  return momentum_after - momentum_before - momentum_emitted + momentum_removed - momentum_gravity +
         contact.impulse_on_free_nodes + contact.impulse_on_prescribed;
}

}  // namespace oilskin
