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

  /// J^carried: impulse of the fluid's load on a node of a sheet that the host, and other fluids, are
  /// expected to carry within dt [N s] (B.28).
  Vec3 carried_impulse(std::uint64_t surface_id, std::uint32_t node, double dt) const;

  /// At the centre of mass [N s], and about it [N m s].
  struct OfBody {
    Vec3 impulse, moment;
    double firmness;  ///< share of changes of the load along gravity that the host takes up at once (B.45)
  };
  /// The same of a body (B.44): what the host carries within the time that has `passed` since the step began,
  /// with the interval of dt that ends then, and other fluids within dt.
  OfBody carried_of_body(const SurfaceMotion& surface, double passed, double dt) const;

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
    double weight = 0;                  // of the steps that a body's mean is of; 1 = of very many
    // Of a body, along gravity: load and weight in the last step [N]; mean squares of that, and of what was
    // left of it to move the body [N²].
    double pushed = 0, pushed2 = 0, moved2 = 0;

    /// What the host carries of the load within dt [N s], with χ_c (B.27), beside a force that is constant.
    Vec3 carried(double dt, const Vec3& constant = Vec3::Zero()) const;
    /// Of a body, with its weight, a force [N] (B.44).
    Vec3 carried_with_weight(double dt, const Vec3& gravity_force) const;
    /// `carried` [N s], less what other fluids do within dt, which this one cannot count on the host for.
    Vec3 without_others(Vec3 carried, double dt) const;
    void respond(double fresh, const Vec3& force) { response += fresh * (force - response); }
    /// That of a body is known from the first step on: what stands does not fall before it is known to stand.
    double fresh_of_body(double fresh) const { return fresh / weight; }
    /// `along` gravity: of the response to the last step [N].
    void respond_to_push(double fresh, double along) {
      const double moved = pushed + along;
      pushed2 += fresh * (pushed * pushed - pushed2);
      moved2 += fresh * (moved * moved - moved2);
    }
    double firmness() const;
    void record_body(double fresh, const Vec3& velocity, const Vec3& force, const Vec3& force_of_others) {
      weight += fresh * (1 - weight);
      record(fresh_of_body(fresh), velocity, force, force_of_others);
    }
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
