/// A btSoftBody as a surface.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include "oilskin/surface_motion.h"

namespace oilskin::bullet {

/// Reads and writes a soft body at the end of a Bullet sub-step (or after stepSimulation). Its pointers are
/// looked up at every call, never kept: soft bodies are cut, refined and re-ordered while they live.
///
/// Nodes of mass 0 are prescribed: their velocity is their motion since the last coupling.
class SoftBodyHost : public SurfaceHost {
 public:
  struct Options {
    bool may_hold_pins = true;  ///< contact may stop a pin for an interval when it closes on a particle
    /// Nodes at bit-equal positions at attach are one contact node of their common mass, and stay together:
    /// Bullet does not hold copies together, so every scatter puts them where the contact node is, with their
    /// common velocity (momentum is kept). Off: a seam that Bullet opens is a hole.
    bool weld = true;
  };

  SoftBodyHost(btSoftBody* body, Options options) : body_(body), options_(options) {}

  /// Refuses bodies without faces, faces with foreign nodes, non-finite nodes (naming the first one).
  Gathered gather(double dt, SurfaceMotion& motion) override;
  void scatter(SurfaceMotion& motion) override;

  /// The motion up to the next gather is a teleport: pins get no velocity from it.
  void forget_motion() { forget_motion_ = true; }
  /// Whether scatter renews the normals where it moved nodes. Off where Bullet does so right after us.
  void set_update_normals(bool on) { update_normals_ = on; }
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
  std::vector<Vec3> common_velocities() const;
  bool scatter_node(std::size_t node, const Vec3& velocity, const SurfaceMotion& motion);

  btSoftBody* body_;
  Options options_;
  bool forget_motion_ = true;
  bool update_normals_ = true;
  std::vector<Triangle> faces_;              // in Bullet's node numbers, as last seen
  std::vector<std::uint32_t> contact_node_;  // of each Bullet node
  std::size_t contact_nodes_ = 0;
  std::vector<std::uint32_t> copies_;      // of each contact node
  std::vector<std::uint32_t> first_copy_;  // of each contact node, a pinned one if there is one
  std::vector<Vec3> node_impulse_;
};

}  // namespace oilskin::bullet
