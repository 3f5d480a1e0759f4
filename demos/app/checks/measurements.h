/// What acceptance checks need to see while a scene runs. Only what the scene asks for is measured.
#pragma once

#include <unordered_map>
#include <unordered_set>

#include "checks/dam_break.h"
#include "hosts/simulation.h"

namespace oilskin::demo {

struct Measurements {
  Vec3 impulse_on_cloth = Vec3::Zero();        ///< Σ of the impulses on the nodes of every surface [N s]
  double largest_stretch = 1;                  ///< edge over rest length
  std::unordered_set<std::uint64_t> over_rim;  ///< ids seen outside and below cloth 0
  std::uint64_t in_shadow = 0;                 ///< particles seen below the cloth, summed over looks
  std::array<double, 2> slip_way{};   ///< Σ speed × time next to the free and the no-slip sheet [m]
  std::array<double, 2> slip_time{};  ///< Σ over particles and looks [s]
  double reaction_impulse = 0;        ///< of the pins, upwards, in the window [N s]
  double weight_impulse = 0;          ///< of free cloth and water over the window [N s]
  double above_pool_sum = 0;          ///< fraction of the water above the pool × time [s]
  double pool_energy_sum = 0;         ///< kinetic energy over one layer's energy × time [s]
  double above_pool_time = 0, pool_energy_time = 0;  ///< [s]
  std::vector<double> rest_speed;  ///< per check of rest, the largest seen [m/s]; < 0 before a look
  std::vector<DamMoment> dam;
  std::uint64_t inside = 0;          ///< particles inside the closed cloth at the first look
  std::uint64_t inside_changed = 0;  ///< that came, went or changed sides since, summed over looks
  std::uint64_t inside_looks = 0;
  double least_volume = never, largest_volume = 0;  ///< enclosed, over that of the water
  std::array<double, 2>
      energy_sum{};  ///< kinetic energy per mass × time in the first and last window [J s/kg]
  std::array<double, 2> energy_time{};  ///< [s]
  std::uint64_t close_nodes = 0;        ///< nodes next to another layer, the most seen at a time
  std::uint64_t resident_at_fifth = 0,
                resident_at_end = 0;  ///< memory after 20 % of the run, at its end [bytes]
  std::uint64_t not_finite = 0;       ///< coordinates of particles and nodes
  Vec3 centre_node = Vec3::Zero();    ///< of cloth 0, now [m]
};

class Measurer {
 public:
  explicit Measurer(const Scene& scene) : scene_(scene) {}

  /// Once after every step. Means are over time: steps may differ in length.
  void after_step(Simulation& simulation, const StepReport& report);
  /// Once after the last step.
  void finish(Simulation& simulation);
  const Measurements& result() const { return result_; }

 private:
  void measure_impulses(Simulation& simulation);
  void measure_reaction(Simulation& simulation, const StepReport& report, double t);
  void measure_stretch(Simulation& simulation);
  void measure_rim(Simulation& simulation);
  void measure_shadow(Simulation& simulation);
  void measure_slip(Simulation& simulation, double t);
  void measure_pool_level(Simulation& simulation, double dt);
  void measure_pool_calm(Simulation& simulation, double dt);
  void measure_rest(Simulation& simulation, double t);
  void measure_dam(Simulation& simulation, double t);
  void measure_inside(Simulation& simulation);
  void measure_volume(Simulation& simulation);
  void measure_energy(Simulation& simulation, double t);
  void measure_layers(Simulation& simulation);
  double water_volume(Simulation& simulation) const;
  Vec3 up() const;

  const Scene& scene_;
  Measurements result_;
  double since_look_ = 0;                           ///< at what changes slowly [s]
  std::vector<std::vector<Vec3>> velocity_before_;  ///< per cloth, as the last step left them
  std::unordered_map<std::uint64_t, int> winding_;  ///< by id, at the first look
};

/// Index of the node in the middle of a cloth.
std::size_t centre_node(const ClothModel& model);

}  // namespace oilskin::demo
