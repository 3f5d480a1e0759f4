/// The particles of a fluid, as a structure of arrays. Ids are stable; the storage order may change every
/// step.
#pragma once

#include "core/archive.h"
#include "core/parallel.h"
#include "oilskin/types.h"

namespace oilskin::fluid {

struct Particles {
  std::vector<std::uint64_t> id;
  std::vector<Vec3> position;    ///< [m]
  std::vector<Vec3> velocity;    ///< stored: with momentum that surfaces have not taken yet [m/s]
  std::vector<Vec3> motion;      ///< displacement over time of the last interval [m/s]
  std::vector<double> density;   ///< [kg/m³]
  std::vector<double> pressure;  ///< [Pa] of the last step: warm start of the next

  bool spares_load = false;
  std::vector<Vec3> spare_load;  ///< if so: what friction may still use of the last load (B.35) [N s]

  bool mass_varies = false;
  std::vector<float> mass_ratio;  ///< if mass_varies: mass over that of a new particle, (0, 1]

  bool ends = false;
  std::vector<double> end_time;  ///< if ends: when each ends [s]; infinite = not by age
  double new_end = std::numeric_limits<double>::infinity();  ///< of particles that are added now [s]

  std::vector<std::vector<double>> values;  ///< of effects: per kind of value, one per particle
  std::vector<double> value_start;          ///< per kind, in a new particle

  std::size_t size() const { return id.size(); }
  /// Mass over that of a new particle.
  double relative_mass(std::size_t i) const { return mass_varies ? static_cast<double>(mass_ratio[i]) : 1; }
  /// Of all particles.
  double sum_of_relative_masses() const;
  /// Σ relative mass × stored velocity [m/s].
  Vec3 sum_of_velocities(const Workers& workers) const;
  /// From now on friction at walls keeps what it has not used.
  void let_load_be_spared();
  /// From now on masses may differ.
  void let_mass_vary();
  /// From now on particles may end by age; those that are there do not.
  void let_end();
  void push_back(std::uint64_t new_id, const Vec3& x, const Vec3& v, double rest_density);
  /// The next `count` calls of push_back() do not throw.
  void reserve_more(std::size_t count);
  /// Keeps those with keep[i] != 0, in order.
  void compress(Span<const std::uint8_t> keep);
  /// Memory that permute() writes over: it asks for none itself once this is large enough.
  using Scratch = std::vector<Vec3>;
  /// New storage order: the i-th particle is the one that was at order[i].
  void permute(Span<const std::uint32_t> order, const Workers& workers, Scratch& scratch);
  /// A copy in `to`, whose memory is used again.
  void copy_to(Particles& to, const Workers& workers) const;
  /// All fields in storage order, on which the rounding of sums depends.
  void visit(Archive& archive);

 private:
  void visit_spare_load(Archive& archive);
};

}  // namespace oilskin::fluid
