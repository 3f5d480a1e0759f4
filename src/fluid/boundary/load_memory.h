/// What each node remembers of the loads of earlier steps, and how much of a load its host will carry.
///
/// A host such as a cloth solver responds to the load of a step in the next one. Without a memory of loads
/// and responses every sheet would seem to yield freely (docs/theory/boundary.md, section 8).
#pragma once

#include <map>
#include <utility>

#include "core/archive.h"
#include "oilskin/surface_motion.h"

namespace oilskin::fluid {

class LoadMemory {
 public:
  /// Starts with an empty memory for surfaces that are new or have another number of nodes. Still ones have
  /// none: it is of free nodes.
  void prepare(Span<SurfaceMotion* const> surfaces);

  /// Once per step, after the hosts were gathered: the forces with which they reacted to the last load
  /// (B.26). dt of the step [s], gravity [m/s²]. Surfaces that are not in the list are forgotten.
  void record_host_response(double dt, const Vec3& gravity, Span<SurfaceMotion* const> surfaces);
  /// Once per step, before the hosts are scattered: the impulses of this step. `of_others`: those of other
  /// fluids among them, per surface and node [N s]; empty lists = none.
  void record_load(double dt, Span<SurfaceMotion* const> surfaces,
                   Span<const std::vector<Vec3>> of_others = {});

  /// J^carried: impulse of the fluid's load that the host, and other fluids, are expected to carry within dt
  /// [N s] (B.28). Of a body, "node" 0 is the impulse at its centre of mass and 1 the angular impulse [N m
  /// s].
  Vec3 carried_impulse(std::uint64_t surface_id, std::uint32_t node, double dt) const;

  /// Per node of a sheet, and of the velocity [m/s] and the angular velocity [1/s] of a body: the change by
  /// the load of all fluids that the host, with gravity, is expected to undo within dt. An empty list where
  /// nothing is known.
  void find_carried(const SurfaceMotion& surface, double dt, std::vector<Vec3>& change) const;

  void visit(Archive& archive);
  void swap(LoadMemory& other) noexcept { of_surface_.swap(other.of_surface_); }

 private:
  /// Forces are exponential means over the last steps.
  struct NodeMemory {
    Vec3 velocity_left = Vec3::Zero();  // at the end of the last step [m/s]
    Vec3 load = Vec3::Zero();           // of fluids and contact [N]
    Vec3 of_others = Vec3::Zero();      // the part of it by other fluids [N]
    Vec3 response = Vec3::Zero();       // of the host, without gravity [N]

    /// What the host carries of the load within dt [N s], with χ_c (B.27), beside a force that is constant.
    Vec3 carried(double dt, const Vec3& constant = Vec3::Zero()) const;
    void respond(double fresh, const Vec3& force) { response += fresh * (force - response); }
    void record(double fresh, const Vec3& velocity, const Vec3& force, const Vec3& force_of_others) {
      velocity_left = velocity;
      load += fresh * (force - load);
      of_others += fresh * (force_of_others - of_others);
    }
  };

  void forget_others(Span<SurfaceMotion* const> surfaces);
  const std::vector<NodeMemory>* find(const SurfaceMotion& surface) const;
  std::vector<NodeMemory>* find(const SurfaceMotion& surface) {
    return const_cast<std::vector<NodeMemory>*>(std::as_const(*this).find(surface));
  }

  std::map<std::uint64_t, std::vector<NodeMemory>> of_surface_;  // by surface id
};

}  // namespace oilskin::fluid
