#include <LinearMath/btQuickprof.h>

#include <algorithm>
#include <limits>
#include <sstream>
#include <utility>

#include "convert.h"
#include "core/assert.h"
#include "coupling_impl.h"
#include "shape_region.h"

namespace oilskin::bullet {

namespace {

constexpr std::size_t most_fluids = 255;  // World::step_together()

/// Of round shapes, relative to the spacing of the finest fluid: half of the default thickness.
constexpr double shape_tolerance = 0.1;

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

std::vector<World*> btFluidCoupling::Impl::worlds() const {
  std::vector<World*> worlds;
  for (btFluid* fluid : fluids) worlds.push_back(&fluid->getWorld());
  return worlds;
}

std::optional<std::size_t> btFluidCoupling::Impl::index_of(const btFluid* fluid) const {
  if (!fluid && !fluids.empty()) return 0;
  const auto it = std::find(fluids.begin(), fluids.end(), fluid);
  return it == fluids.end() ? std::optional<std::size_t>() : static_cast<std::size_t>(it - fluids.begin());
}

/// That has those of all fluids.
Box btFluidCoupling::Impl::kill_box() const {
  Box box;
  for (const btFluid* fluid : fluids) box.add(fluid->getWorld().settings().kill_box);
  return box;
}

double btFluidCoupling::Impl::finest_spacing() const {
  double spacing = std::numeric_limits<double>::infinity();
  for (const btFluid* fluid : fluids) spacing = std::min(spacing, fluid->getWorld().fluid_settings().spacing);
  return spacing;
}

void btFluidCoupling::Impl::refine(Attachment& a) {
  if (a.rigid) a.rigid->set_tolerance(shape_tolerance * finest_spacing());
}

/// Asking a host where it is makes it forget that its next motion is a teleport, and where that began: the
/// fluids that have it already need that.
Status btFluidCoupling::Impl::attach(Attachment& a, std::size_t fluid) {
  OILSKIN_ASSERT(a.ids.size() == fluids.size());
  if (a.sensor) return Status::accepted();
  const bool is_known = fluid > 0 && a.id();
  if (a.rigid) {
    const CollisionObjectHost::State state = a.rigid->state();
    Status status = fluids[fluid]->getWorld().attach(a.host(), a.settings, &a.ids[fluid]);
    if (is_known) a.rigid->set_state(state);
    return status;
  }
  const bool forgets = a.soft->state().forget_motion;
  Status status = fluids[fluid]->getWorld().attach(a.host(), a.settings, &a.ids[fluid]);
  if (is_known && forgets) a.soft->forget_motion();
  return status;
}

Status btFluidCoupling::Impl::attach(Attachment& a) {
  a.ids.assign(fluids.size(), SurfaceId());
  if (a.rigid) a.rigid->set_kill_box(kill_box());
  refine(a);
  Status status;
  try {
    for (std::size_t k = 0; k < fluids.size() && status.ok(); ++k) status = attach(a, k);
  } catch (...) {
    detach(a);
    throw;
  }
  if (!status.ok()) detach(a);
  return status;
}

void btFluidCoupling::Impl::detach(Attachment& a, std::size_t fluid) {
  if (a.ids[fluid]) fluids[fluid]->getWorld().detach(a.ids[fluid]);
  a.ids.erase(a.ids.begin() + static_cast<std::ptrdiff_t>(fluid));
  if (a.sensor) a.sensor->forget_fluid(fluid, fluids.size() == 1);
}

void btFluidCoupling::Impl::detach(Attachment& a) {
  for (std::size_t k = 0; k < a.ids.size(); ++k)
    if (a.ids[k]) fluids[k]->getWorld().detach(a.ids[k]);
  a.ids.assign(fluids.size(), SurfaceId());
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
  if (status.ok() && a.rigid)
    status = check_rigid(a.object->getWorldTransform(), "the transform of the body");
  SurfaceMotion trial;
  if (status.ok()) status = a.host().gather(0, trial).status;
  if (status.ok()) status = check_size(trial, a.settings);
  if (!status.ok()) return status;
  // What may throw comes before the fluids know the host.
  attachments.reserve(attachments.size() + 1);
  a.mark = std::make_unique<ObjectMark>();
  if (!fluids.empty()) status = attach(a);
  if (!status.ok()) return status;
  try {
    a.mark->put_on(*a.object);
  } catch (...) {
    detach(a);
    throw;
  }
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
  for (std::size_t k = 0; k < a->ids.size(); ++k)
    if (a->ids[k]) fluids[k]->getWorld().reset_motion(a->ids[k]);
}

/// Planes end at the kill box: where it is another one, their corners do not move there.
void btFluidCoupling::Impl::follow_kill_box() {
  const Box box = kill_box();
  for (const Attachment& a : attachments)
    if (a.rigid && a.rigid->set_kill_box(box)) forget_motion(a.object);
}

const SurfaceMotion* btFluidCoupling::Impl::surface(const btCollisionObject* object) {
  const Attachment* a = find(object);
  return a && a->id() ? world()->surface(a->id()) : nullptr;
}

/// btSoftRigidDynamicsWorld::setGravity() does not affect soft bodies: their gravity is that of their world
/// info.
Status btFluidCoupling::Impl::follow_gravity() {
  const std::optional<Vec3> before = std::exchange(followed_gravity, gravity_of_cloth());
  if (!followed_gravity) {
    note_gravity();
    return Status::accepted();
  }
  for (World* w : worlds()) {
    const Vec3 present = w->settings().gravity;
    if (before && present != *before)
      note(
          "the gravity given to World::set_gravity() was replaced by that of the cloth's "
          "btSoftBodyWorldInfo: "
          "call setUseClothGravity(false) first");
    if (*followed_gravity == present) continue;
    if (Status s = w->set_gravity(*followed_gravity); !s.ok()) return s;
  }
  return Status::accepted();
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
  while (!m_impl->fluids.empty()) removeFluid(m_impl->fluids.back());
}

Status btFluidCoupling::addFluid(btFluid* fluid) {
  if (!fluid) return Status::refused("fluid is null");
  if (fluid->m_coupling == this) return Status::refused("this fluid is in this coupling already");
  if (fluid->m_coupling) return Status::refused("this fluid is in another coupling: remove it there first");
  Status status = fluid->getWorld().status();
  if (!status.ok()) return status;
  Impl& c = *m_impl;
  if (c.fluids.size() == most_fluids)
    return Status::refused("a coupling takes at most " + std::to_string(most_fluids) + " fluids");
  if (!c.fluids.empty() &&
      fluid->getWorld().fluid_settings().boundary != c.world()->fluid_settings().boundary)
    return Status::refused("the fluids of a coupling must have the same FluidSettings::boundary");
  c.fluids.push_back(fluid);
  c.followed_gravity.reset();
  fluid->m_coupling = this;
  for (Attachment& a : c.attachments) {
    a.ids.emplace_back();
    c.refine(a);
  }
  c.follow_kill_box();
  for (std::size_t i = 0; i < c.attachments.size() && status.ok(); ++i)
    status = c.attach(c.attachments[i], c.fluids.size() - 1);
  if (!status.ok()) removeFluid(fluid);
  return status;
}

void btFluidCoupling::removeFluid(btFluid* fluid) {
  Impl& c = *m_impl;
  const std::optional<std::size_t> k = fluid ? c.index_of(fluid) : std::nullopt;
  if (!k) return;
  for (Attachment& a : c.attachments) c.detach(a, *k);
  c.fluids.erase(c.fluids.begin() + static_cast<std::ptrdiff_t>(*k));
  fluid->m_coupling = nullptr;
  if (!c.fluids.empty()) c.follow_kill_box();
}

btFluid* btFluidCoupling::getFluid() const {
  return getFluid(0);
}

btFluid* btFluidCoupling::getFluid(int i) const {
  return i >= 0 && i < getNumFluids() ? m_impl->fluids[static_cast<std::size_t>(i)] : nullptr;
}

int btFluidCoupling::getNumFluids() const {
  return static_cast<int>(m_impl->fluids.size());
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
        object->getInternalType() == btCollisionObject::CO_FEATHERSTONE_LINK
            ? "a link of a btMultiBody cannot be moved by the water: attach a kinematic btCollisionObject "
              "with its shape and let that follow the link"
        : btRigidBody::upcast(object)
            ? "this rigid body is dynamic: use addRigidBody(), or give it mass 0, or set "
              "btCollisionObject::CF_KINEMATIC_OBJECT and move it yourself"
            : "this object is neither static nor kinematic: set "
              "btCollisionObject::CF_KINEMATIC_OBJECT, beside CF_CHARACTER_OBJECT if it is "
              "that of a character controller");
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
  if (m_impl->fluids.empty())
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
  const std::vector<World*> worlds = m_impl->worlds();
  m_impl->joint.reset();
  if (worlds.size() > 1) m_impl->joint = World::step_together(worlds, dt);
  const StepReport& report = m_impl->joint ? *m_impl->joint : worlds[0]->step(dt);
  m_impl->note_report(report);
  m_impl->note_bodies();
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
  if (m_impl->fluids.empty() || !m_impl->refused.status.ok()) return m_impl->refused;
  return m_impl->joint ? *m_impl->joint : m_impl->world()->report();
}

const std::vector<Vec3>* btFluidCoupling::getNodeImpulses(const btSoftBody* cloth) const {
  const Attachment* a = m_impl->find(cloth);
  return a && a->id() ? &a->soft->node_impulses() : nullptr;
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
  return getSurfaceId(object, nullptr);
}

SurfaceId btFluidCoupling::getSurfaceId(const btCollisionObject* object, const btFluid* fluid) const {
  const Attachment* a = m_impl->find(object);
  const std::optional<std::size_t> k = m_impl->index_of(fluid);
  return a && k ? a->ids[*k] : SurfaceId();
}

}  // namespace oilskin::bullet
