// A coupling that is moved as a whole, without a motion.
#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>

#include "convert.h"
#include "coupling_impl.h"
#include "object_state.h"
#include "oilskin/bullet_emitter.h"

namespace oilskin::bullet {

namespace {

void move_tree(btDbvt& tree, const btVector3& offset) {
  for (btDbvtNode* node : nodes_of(tree))
    node->volume = btDbvtVolume::FromMM(node->volume.Mins() + offset, node->volume.Maxs() + offset);
}

/// btSoftBody::translate() would measure the rest lengths again.
void move(btSoftBody& body, const btVector3& offset) {
  for (int i = 0; i < body.m_nodes.size(); ++i) {
    body.m_nodes[i].m_x += offset;
    body.m_nodes[i].m_q += offset;
  }
  for (btVector3& bound : body.m_bounds) bound += offset;
  body.m_pose.m_com += offset;
  move_tree(body.m_ndbvt, offset);
  move_tree(body.m_fdbvt, offset);
  if (body.getBroadphaseHandle())
    body.m_worldInfo->m_broadphase->setAabb(body.getBroadphaseHandle(), body.m_bounds[0], body.m_bounds[1],
                                            body.m_worldInfo->m_dispatcher);
}

void move(btTransform& transform, const btVector3& offset) {
  transform.setOrigin(transform.getOrigin() + offset);
}

void move(btCollisionObject& object, const btVector3& offset) {
  move(object.getWorldTransform(), offset);
  btTransform interpolation = object.getInterpolationWorldTransform();
  move(interpolation, offset);
  object.setInterpolationWorldTransform(interpolation);
  btRigidBody* body = btRigidBody::upcast(&object);
  if (!body || !body->getMotionState()) return;
  btTransform shown;
  body->getMotionState()->getWorldTransform(shown);
  move(shown, offset);
  body->getMotionState()->setWorldTransform(shown);
}

/// What the host and the sums remember. A moment is about the origin.
void move_memory(Attachment& a, const btVector3& offset) {
  SurfaceLoad& total = a.touched.total;
  total.angular_impulse += to_vec3(offset).cross(total.impulse);
  if (a.cloth) return;
  CollisionObjectHost::State host = a.rigid->state();
  move(host.start, offset);
  a.rigid->set_state(host);
  if (!a.sensor) return;
  Sensor::State sensor = a.sensor->state();
  if (sensor.to_local) sensor.to_local->translation() -= sensor.to_local->linear() * to_vec3(offset);
  a.sensor->set_state(std::move(sensor));
}

Box moved(const Box& box, const btVector3& offset) {
  return {box.min + to_vec3(offset), box.max + to_vec3(offset)};
}

}  // namespace

void btFluidCoupling::Impl::set_planes(const Box& kill_box) {
  for (Attachment& a : attachments)
    if (a.rigid) a.rigid->set_kill_box(kill_box);
}

/// Asking hosts where they are makes them forget that their next motion is a teleport.
Status btFluidCoupling::Impl::translate_worlds(const btVector3& offset) {
  std::vector<SoftBodyHost::State> soft;
  std::vector<CollisionObjectHost::State> rigid;
  for (const Attachment& a : attachments) {
    soft.push_back(a.soft ? a.soft->state() : SoftBodyHost::State());
    rigid.push_back(a.rigid ? a.rigid->state() : CollisionObjectHost::State());
  }
  Status status;
  for (World* w : worlds())
    if (status.ok()) status = w->translate(to_vec3(offset));
  for (std::size_t i = 0; i < attachments.size(); ++i) {
    Attachment& a = attachments[i];
    if (a.soft && soft[i].forget_motion) a.soft->forget_motion();
    if (a.rigid && rigid[i].forget_motion) a.rigid->forget_motion();
  }
  return status;
}

Status btFluidCoupling::translate(const btVector3& offset) {
  Impl& c = *m_impl;
  if (!to_vec3(offset).allFinite()) return Status::refused("the offset of a translation must be finite");
  if (offset.fuzzyZero() && offset.length2() == 0) return Status::accepted();
  std::vector<std::uint8_t> before;
  if (Status s = saveState(&before); !s.ok()) return s;
  for (Attachment& a : c.attachments) {
    if (a.cloth)
      move(*a.cloth, offset);
    else
      move(*a.object, offset);
    move_memory(a, offset);
  }
  if (c.fluids.empty()) return Status::accepted();
  const Box kill_box = c.kill_box();
  c.set_planes(moved(kill_box, offset));
  Status status = c.translate_worlds(offset);
  if (status.ok()) {
    for (const btFluid* fluid : c.fluids)
      for (btFluidEmitter* emitter : fluid->m_emitters) move(emitter->m_transform, offset);
    return status;
  }
  c.set_planes(kill_box);
  const Status back = restoreState(before);
  return back.ok() ? status : Status::refused(status.message + "; and then: " + back.message);
}

}  // namespace oilskin::bullet
