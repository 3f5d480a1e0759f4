#include <LinearMath/btQuickprof.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "convert.h"
#include "coupling_impl.h"

namespace oilskin::bullet {

namespace {

/// Finds lengths in millimetres where metres are meant.
Status check_size(const SurfaceMotion& surface, const SurfaceSettings& settings) {
  Box extent;
  for (const Vec3& x : surface.x_t1) extent.add(x);
  const double across = (extent.max - extent.min).norm();
  if (!settings.thickness || *settings.thickness <= 2 * across) return Status::accepted();
  std::ostringstream text;
  text << "thickness is " << *settings.thickness << " m, but the body measures only " << across
       << " m from corner to corner; it must be at most twice that: are both in metres?";
  return Status::refused(text.str());
}

}  // namespace

Attachment* btFluidCoupling::Impl::find(const btCollisionObject* object) {
  const auto it = std::find_if(attachments.begin(), attachments.end(),
                               [object](const Attachment& a) { return a.object == object; });
  return it == attachments.end() ? nullptr : &*it;
}

Status btFluidCoupling::Impl::attach(Attachment& a) {
  if (a.sensor) return Status::accepted();
  if (a.rigid) a.rigid->set_kill_box(world()->settings().kill_box);
  return world()->attach(a.host(), a.settings, &a.id);
}

void btFluidCoupling::Impl::detach(Attachment& a) {
  if (a.id) world()->detach(a.id);
  a.id = SurfaceId();
  if (a.sensor) a.sensor = std::make_unique<Sensor>(a.object);  // another fluid has other particles
}

Status btFluidCoupling::Impl::add(Attachment a) {
  const Attachment* same = find(a.object);
  if (same && same->mark->is_on(*a.object))
    return Status::refused("this body is attached already: remove it first");
  if (same) detach_deleted(static_cast<std::size_t>(same - attachments.data()));
  // Two couplings would both move a cloth or a body. They may share a wall.
  if ((a.cloth || a.takes_impulses) && ObjectMark::is_used(*a.object))
    return Status::refused(std::string("this ") + (a.cloth ? "cloth" : "body") +
                           " is in another coupling: remove it there first");
  Status status = a.settings.validate();
  SurfaceMotion trial;
  if (status.ok()) status = a.host().gather(0, trial).status;
  if (status.ok()) status = check_size(trial, a.settings);
  if (status.ok() && fluid) status = attach(a);
  if (!status.ok()) return status;
  a.mark = std::make_unique<ObjectMark>();
  a.mark->put_on(*a.object);
  a.number = next_number++;
  attachments.push_back(std::move(a));
  return status;
}

void btFluidCoupling::Impl::remove(const btCollisionObject* object) {
  Attachment* a = find(object);
  if (!a) return;
  detach(*a);
  if (a->soft) a->soft->give_back_absorbed_mass();
  a->mark->take_off(*a->object);
  attachments.erase(attachments.begin() + (a - attachments.data()));
}

void btFluidCoupling::Impl::forget_motion(const btCollisionObject* object) {
  Attachment* a = find(object);
  if (!a) return;
  if (a->soft) a->soft->forget_motion();
  if (a->rigid) a->rigid->forget_motion();
  if (a->sensor) a->sensor->forget_motion();
  if (a->id) world()->reset_motion(a->id);
}

const SurfaceMotion* btFluidCoupling::Impl::surface(const btCollisionObject* object) {
  const Attachment* a = find(object);
  return a && a->id ? world()->surface(a->id) : nullptr;
}

/// btSoftRigidDynamicsWorld::setGravity() does not affect soft bodies: their gravity is that of their world
/// info.
Status btFluidCoupling::Impl::follow_gravity() {
  const std::optional<Vec3> before = std::exchange(followed_gravity, gravity_of_cloth());
  if (!followed_gravity) return Status::accepted();
  const Vec3 present = world()->settings().gravity;
  if (before && present != *before)
    note(
        "the gravity given to World::set_gravity() was replaced by that of the cloth's btSoftBodyWorldInfo: "
        "call setUseClothGravity(false) first");
  return *followed_gravity == present ? Status::accepted() : world()->set_gravity(*followed_gravity);
}

/// That of the first cloth that has one; nothing where the fluid keeps its own.
std::optional<Vec3> btFluidCoupling::Impl::gravity_of_cloth() const {
  if (!use_cloth_gravity) return {};
  for (const Attachment& a : attachments)
    if (a.cloth && a.cloth->getWorldInfo()) return to_vec3(a.cloth->getWorldInfo()->m_gravity);
  return {};
}

const StepReport& btFluidCoupling::Impl::refuse(std::string why) {
  note(why);
  refused = StepReport();
  refused.status = Status::refused(std::move(why));
  return refused;
}

btFluidCoupling::btFluidCoupling(btFluid* fluid) : m_impl(std::make_unique<Impl>()) {
  // A constructor cannot refuse; step() returns the reason.
  if (!fluid) return;
  const Status status = addFluid(fluid);
  if (!status.ok()) m_impl->refuse(status.message);
}

btFluidCoupling::~btFluidCoupling() {
  forgetListeners();
  if (m_impl->fluid) removeFluid(m_impl->fluid);
}

Status btFluidCoupling::addFluid(btFluid* fluid) {
  if (!fluid) return Status::refused("fluid is null");
  if (m_impl->fluid) return Status::refused("a coupling takes one fluid: remove the first one");
  if (fluid->m_coupling) return Status::refused("this fluid is in another coupling: remove it there first");
  Status status = fluid->getWorld().status();
  if (!status.ok()) return status;
  m_impl->fluid = fluid;
  m_impl->followed_gravity.reset();
  fluid->m_coupling = this;
  for (std::size_t i = 0; i < m_impl->attachments.size() && status.ok(); ++i)
    status = m_impl->attach(m_impl->attachments[i]);
  if (!status.ok()) removeFluid(fluid);
  return status;
}

void btFluidCoupling::removeFluid(btFluid* fluid) {
  if (!fluid || fluid != m_impl->fluid) return;
  for (Attachment& a : m_impl->attachments) m_impl->detach(a);
  fluid->m_coupling = nullptr;
  m_impl->fluid = nullptr;
}

btFluid* btFluidCoupling::getFluid() const {
  return m_impl->fluid;
}

Status btFluidCoupling::addCloth(btSoftBody* cloth, btScalar thickness, const SlipSettings& slip) {
  SurfaceSettings settings;
  settings.thickness = static_cast<double>(thickness);
  settings.slip = slip;
  return addCloth(cloth, settings);
}

Status btFluidCoupling::addCloth(btSoftBody* cloth, const SurfaceSettings& settings, bool mayHoldPins,
                                 bool weldNodes) {
  if (!cloth) return Status::refused("cloth is null");
  SoftBodyHost::Options options;
  options.may_hold_pins = mayHoldPins;
  options.weld = weldNodes;
  Attachment a;
  a.object = a.cloth = cloth;
  a.settings = settings;
  a.soft = std::make_unique<SoftBodyHost>(cloth, options);
  return m_impl->add(std::move(a));
}

void btFluidCoupling::removeCloth(btSoftBody* cloth) {
  m_impl->remove(cloth);
}

Status btFluidCoupling::addCollisionObject(btCollisionObject* object, btScalar thickness,
                                           const SlipSettings& slip) {
  SurfaceSettings settings;
  settings.thickness = static_cast<double>(thickness);
  settings.slip = slip;
  return addCollisionObject(object, settings);
}

Status btFluidCoupling::addCollisionObject(btCollisionObject* object, const SurfaceSettings& settings) {
  if (!object) return Status::refused("collision object is null");
  if (object->getInternalType() == btCollisionObject::CO_SOFT_BODY)
    return Status::refused("a soft body is a cloth: use addCloth()");
  const bool is_sensor = Sensor::is_sensor(*object);
  if (!object->isStaticOrKinematicObject() && !is_sensor)
    return Status::refused(
        "this rigid body is dynamic: use addRigidBody(), or give it mass 0, or set "
        "btCollisionObject::CF_KINEMATIC_OBJECT and move it yourself");
  Attachment a;
  a.object = object;
  a.settings = settings;
  a.rigid = std::make_unique<CollisionObjectHost>(object, WorldSettings().kill_box);
  if (is_sensor) {
    a.sensor = std::make_unique<Sensor>(object);
    if (Status status = a.sensor->read(); !status.ok()) return status;
  }
  return m_impl->add(std::move(a));
}

Status btFluidCoupling::addRigidBody(btRigidBody* body, btScalar thickness, const SlipSettings& slip) {
  SurfaceSettings settings;
  settings.thickness = static_cast<double>(thickness);
  settings.slip = slip;
  return addRigidBody(body, settings);
}

Status btFluidCoupling::addRigidBody(btRigidBody* body, const SurfaceSettings& settings) {
  if (!body) return Status::refused("rigid body is null");
  Attachment a;
  a.object = body;
  a.settings = settings;
  a.rigid = std::make_unique<RigidBodyHost>(body, WorldSettings().kill_box);
  a.takes_impulses = !body->isStaticOrKinematicObject();
  return m_impl->add(std::move(a));
}

void btFluidCoupling::removeRigidBody(btRigidBody* body) {
  m_impl->remove(body);
}

void btFluidCoupling::removeCollisionObject(btCollisionObject* object) {
  m_impl->remove(object);
}

void btFluidCoupling::resetMotion(btSoftBody* cloth) {
  m_impl->forget_motion(cloth);
}
void btFluidCoupling::resetMotion(btCollisionObject* object) {
  m_impl->forget_motion(object);
}

void btFluidCoupling::setUseClothGravity(bool use) {
  m_impl->use_cloth_gravity = use;
}

bool btFluidCoupling::followsClothGravity() const {
  return m_impl->gravity_of_cloth().has_value();
}

void btFluidCoupling::setCarriesWater(bool carries) {
  m_impl->carries_water = carries;
}

bool btFluidCoupling::getCarriesWater() const {
  return m_impl->carries_water;
}

const StepReport& btFluidCoupling::couple(double dt, bool updateNormals) {
  BT_PROFILE("oilskin::step");
  if (m_impl->listening.is_telling) return m_impl->refuse_within_call();
  if (!m_impl->fluid)
    return m_impl->refused.status.ok() ? m_impl->refuse("there is no fluid: call addFluid() first")
                                       : m_impl->refused;
  if (dt == 0) return getReport();
  m_impl->detach_absent();
  m_impl->note_drivers(!updateNormals);
  const Status gravity = m_impl->follow_gravity();
  if (!gravity.ok()) return m_impl->refuse(gravity.message);
  m_impl->refused = StepReport();
  m_impl->prepare_sensors();
  for (Attachment& a : m_impl->attachments) {
    if (!a.soft) continue;
    a.soft->set_update_normals(updateNormals);
    a.soft->set_carries_water(m_impl->carries_water);
  }
  const StepReport& report = m_impl->world()->step(dt);
  m_impl->note_report(report);
  m_impl->hear(report);
  return report;
}

const StepReport& btFluidCoupling::step(btScalar dt) {
  if (m_impl->listening.is_telling) return m_impl->refuse_within_call();
  const StepReport& report = couple(static_cast<double>(dt), true);
  if (m_impl->listening.due.empty()) return report;
  tellListeners();
  return m_impl->listening.report;  // the fluid may be gone
}

const StepReport& btFluidCoupling::getReport() const {
  return m_impl->fluid && m_impl->refused.status.ok() ? m_impl->world()->report() : m_impl->refused;
}

const std::vector<Vec3>* btFluidCoupling::getNodeImpulses(const btSoftBody* cloth) const {
  const Attachment* a = m_impl->find(cloth);
  return a && a->id ? &a->soft->node_impulses() : nullptr;
}

const SurfaceMotion* btFluidCoupling::getSurface(const btSoftBody* cloth) const {
  return m_impl->surface(cloth);
}

const SurfaceMotion* btFluidCoupling::getSurface(const btCollisionObject* object) const {
  return m_impl->surface(object);
}

SurfaceId btFluidCoupling::getSurfaceId(const btSoftBody* cloth) const {
  return getSurfaceId(static_cast<const btCollisionObject*>(cloth));
}

SurfaceId btFluidCoupling::getSurfaceId(const btCollisionObject* object) const {
  const Attachment* a = m_impl->find(object);
  return a ? a->id : SurfaceId();
}

}  // namespace oilskin::bullet
