/// The state of Bullet's objects that determines their next step, as values that can be saved, compared with
/// an object, and given back to it. What the game sets and Bullet does not change (masses of rigid bodies,
/// friction, damping, stiffness, gravity, flags) is no state.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletSoftBody/btSoftBody.h>

#include <optional>

#include "tree_state.h"

namespace oilskin::bullet {

/// Of any collision object.
struct ObjectState {
  btTransform transform, interpolation;
  btVector3 interpolation_velocity, interpolation_angular_velocity;
  int activation = 0;
  btScalar deactivation_time = 0;  ///< [s]

  void capture(const btCollisionObject& object);
  void visit(Archive& archive);
  void apply(btCollisionObject& object) const;
};

/// Of a rigid body, beside.
struct RigidState {
  btVector3 velocity, angular_velocity, force, torque;
  btScalar inverse_mass = 0;
  btVector3 inverse_inertia;                ///< about its own axes
  std::optional<btTransform> motion_state;  ///< what its btMotionState gives

  void capture(const btRigidBody& body);
  void visit(Archive& archive);
  /// Refuses another mass.
  Status check(const btRigidBody& body) const;
  void apply(btRigidBody& body) const;
};

/// Of a soft body, beside.
struct SoftState {
  /// What its elements connect, in numbers of nodes.
  struct Mesh {
    std::vector<int> nodes, links, faces, anchors;  ///< nodes: one number, how many there are
  };
  Mesh mesh;
  std::vector<btSoftBody::Node> nodes;  ///< without pointers
  std::vector<btSoftBody::Link> links;
  std::vector<btSoftBody::Face> faces;
  btSoftBody::SolverState solver;
  bool has_volume = false, has_frame = false;
  btScalar volume = 0;
  btVector3 center;
  btMatrix3x3 rotation, scale, base_scale;
  std::vector<btVector3> positions;
  std::vector<btScalar> weights;
  btScalar time = 0, rest_length_scale = 1;
  btVector3 bounds[2];
  bool updates_constants = false;
  TreeState node_tree, face_tree;

  /// Refuses bodies whose state cannot be given back: clusters, joints, deformable and reduced bodies.
  Status capture(const btSoftBody& body);
  void visit(Archive& archive);
  /// Refuses a body with other elements.
  Status check(const btSoftBody& body) const;
  /// Changes no number or connection of elements.
  void apply(btSoftBody& body) const;

 private:
  void visit_elements(Archive& archive);
  void visit_pose(Archive& archive);
  void capture_pose(const btSoftBody::Pose& pose);
  void apply_pose(btSoftBody::Pose& pose) const;
};

/// Whether a soft body is of a kind whose state can be saved.
Status is_restorable(const btSoftBody& body);

}  // namespace oilskin::bullet
