/// Water and cloth come to rest: their kinetic energy per mass, at the end against earlier.
#include "checks/check.h"
#include "checks/node_mass.h"

namespace oilskin::demo {
namespace {

/// Kinetic energy of water and free nodes over their mass [J/kg].
double specific_energy(const Moment& now) {
  const World& world = now.simulation.world();
  double mass = world.fluid_mass();
  double energy = kinetic_energy(world);
  for (std::size_t c = 0; c < now.scene.cloth.size(); ++c) {
    const SurfaceMotion* motion = now.simulation.cloth(c);
    if (motion == nullptr) continue;
    for (std::size_t i = 0; i < motion->velocity.size(); ++i) {
      if (motion->inverse_mass[i] == 0) continue;
      energy += 0.5 * node_mass(*motion, i) * motion->velocity[i].squaredNorm();
      mass += node_mass(*motion, i);
    }
  }
  return mass > 0 ? energy / mass : never;
}

class EnergyDecay : public Check {
 public:
  void describe(Fields& f) override {
    f.object("energy_decay", [this](Fields& g) {
      g.number("from", from_, not_negative());
      g.number("fraction", fraction_, not_negative());
      g.number("window", window_, positive());
    });
  }

  void after_step(const Moment& now) override {
    if (!now.look) return;
    const bool in_first = now.t > from_ && now.t <= from_ + window_;
    const bool at_end = in_last(window_, now);
    if (!in_first && !at_end) return;
    const double energy = specific_energy(now);
    if (in_first) first_.add(energy, now.since_look);
    if (at_end) last_.add(energy, now.since_look);
  }

  /// Windows that overlap or were never reached show no decay.
  std::vector<CheckResult> results(const RunEnd& end) override {
    const bool apart = from_ + window_ <= end.scene.duration - window_;
    const bool seen = apart && !first_.empty() && !last_.empty() && first_.sum() > 0;
    return {at_most("energy_decay", seen ? last_.value() / first_.value() : never, fraction_)};
  }

 private:
  double from_ = 0;        // begin of the first window [s]
  double fraction_ = 0.5;  // mean over the last window over that of the first, at most
  double window_ = 0.1;    // [s]
  TimeMean first_, last_;  // [J/kg]
};

}  // namespace

std::unique_ptr<Check> make_energy_decay() {
  return std::make_unique<EnergyDecay>();
}

}  // namespace oilskin::demo
