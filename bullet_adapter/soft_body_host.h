/// A btSoftBody as a surface.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include "oilskin/surface_motion.h"

namespace oilskin::bullet {

/// Reads and writes a soft body at the end of a Bullet sub-step (or after stepSimulation). Keeps no pointers
/// into the body between calls, since soft bodies may be cut, refined and re-ordered.
///
/// Nodes of mass 0 are prescribed: their velocity is their motion since the last coupling.
class SoftBodyHost : public SurfaceHost {
 public:
  struct Options {
    /// Contact may hold a pin for an interval if it closes on a particle.
    bool may_hold_pins = true;
    /// Nodes at bit-equal positions at attach are copies of one contact node with their common mass. Bullet
    /// does not keep copies together, so each scatter sets them to the contact node's position and their
    /// common velocity (momentum is kept). Off: copies that Bullet separates leave a hole.
    bool weld = true;
  };

  SoftBodyHost(btSoftBody* body, Options options) : body_(body), options_(options) {}

  /// Refuses bodies without faces, faces with nodes of other bodies, and nodes that are not finite (names the
  /// first).
  Gathered gather(double dt, SurfaceMotion& motion) override;
  void scatter(SurfaceMotion& motion) override;

  /// The motion up to the next gather is a teleport: pins get no velocity from it.
  void forget_motion() { forget_motion_ = true; }
  /// Should scatter update the normals if it moved nodes? Off if Bullet updates them directly afterwards.
  void set_update_normals(bool on) { update_normals_ = on; }
  /// Should loaded nodes weigh the water that they carry, too (SurfaceMotion::carried_mass)? They do where a
  /// support holds the body and Bullet's position solver moves it: that one stops a node whatever its mass
  /// is. Without a support the momentum of the water must become the cloth's.
  void set_carries_water(bool on) { carries_water_ = on; }
  /// Takes what nodes have absorbed out of their masses, as when the body is removed from the coupling.
  void give_back_absorbed_mass();
  /// Which nodes, in Bullet's order, have liquid; empty = none. `absorbed` has one value per contact node
  /// [kg].
  std::vector<bool> wet_nodes(Span<const double> absorbed) const;
  /// What the host remembers from step to step.
  struct State {
    bool forget_motion = true;
    std::vector<std::uint32_t> contact_node;
    std::uint64_t contact_nodes = 0;
    std::vector<Vec3> node_impulse;
    std::vector<double> dry_mass;
    std::vector<btScalar> weighed;
  };
  State state() const;
  /// Refuses a state of another body.
  Status check(const State& state) const;
  /// Of a body with the elements that it had then.
  void set_state(State state);
  /// Impulse of the last scatter on each node in Bullet's order [N s].
  const std::vector<Vec3>& node_impulses() const { return node_impulse_; }

 private:
  Status check() const;
  bool read_faces();
  void weld_all();
  void count_copies();
  btSoftBody::Node& node(std::size_t i) const { return body_->m_nodes[static_cast<int>(i)]; }
  bool split_pins(SurfaceMotion& motion);
  bool is_prescribed(std::size_t node) const;
  void fill(double dt, SurfaceMotion& motion);
  bool may_add_mass() const;
  void weigh_nodes(const std::vector<double>& absorbed);
  bool weigh_node(std::size_t node, double absorbed);
  void add_carried_mass(SurfaceMotion& motion) const;
  std::vector<Vec3> common_velocities() const;
  bool scatter_node(std::size_t node, const Vec3& velocity, const SurfaceMotion& motion);

  btSoftBody* body_;
  Options options_;
  bool forget_motion_ = true;
  bool update_normals_ = true;
  bool carries_water_ = true;
  std::vector<Triangle> faces_;              // of the last gather, in Bullet's node numbers
  std::vector<std::uint32_t> contact_node_;  // per Bullet node
  std::size_t contact_nodes_ = 0;
  std::vector<std::uint32_t> copies_;      // number of copies per contact node
  std::vector<std::uint32_t> first_copy_;  // per contact node; a pinned copy if there is one
  std::vector<Vec3> node_impulse_;
  // Per Bullet node, empty while nothing was absorbed: its mass without liquid [kg], and the inverse mass
  // that was set for it with liquid. The owner may set another one.
  std::vector<double> dry_mass_;
  std::vector<btScalar> weighed_;
};

}  // namespace oilskin::bullet
