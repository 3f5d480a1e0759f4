#include <algorithm>

#include "convert.h"
#include "oilskin/bullet_force.h"
#include "oilskin/bullet_sink.h"
#include "shape_region.h"

namespace oilskin::bullet {

btFluidForce::~btFluidForce() {
  if (m_fluid) m_fluid->removeForce(this);
}

ForceFields* btFluidForce::fields() const {
  return m_fluid ? m_fluid->m_fields.get() : nullptr;
}

/// A restored world may have changed it.
Force btFluidForce::current() const {
  const std::optional<ForceState> now = fields() ? fields()->find(m_id) : std::nullopt;
  return now && now->force.index() == m_force.index() ? now->force : m_force;
}

Status btFluidForce::change(const Force& force) {
  Status status = fields() ? fields()->set(m_id, force) : validate(force);
  if (status.ok()) m_force = force;
  return status;
}

Status btFluidForce::setRegion(const btConvexShape* shape, const btTransform& transform) {
  Region region;
  if (shape)
    if (Status s = read_region(shape, &region); !s.ok()) return s;
  if (Status s = read_pose(transform, &region.pose); !s.ok()) return s;
  Force force = current();
  std::visit([&](auto& field) { field.region = region; }, force);
  return change(force);
}

Status btFluidForce::setEnabled(bool enabled) {
  Status status;
  if (fields()) status = fields()->set_enabled(m_id, enabled);
  if (status.ok()) m_enabled = enabled;
  return status;
}

bool btFluidForce::isEnabled() const {
  const std::optional<ForceState> now = fields() ? fields()->find(m_id) : std::nullopt;
  return now ? now->enabled : m_enabled;
}

Status btFluidForce::attach(btFluid* fluid) {
  ForceId id;
  Status status = fluid->m_fields->add(m_force, &id);
  if (status.ok()) status = fluid->m_fields->set_enabled(id, m_enabled);
  if (!status.ok()) return status;
  m_fluid = fluid;
  m_id = id;
  return status;
}

void btFluidForce::detach() {
  m_enabled = isEnabled();
  m_force = current();
  fields()->remove(m_id);
  m_fluid = nullptr;
  m_id = ForceId();
}

Status btFluid::addForce(btFluidForce* force) {
  if (!force) return Status::refused("force is null");
  if (force->m_fluid == this) return Status::refused("this force is in this fluid already");
  if (force->m_fluid) return Status::refused("this force is in another fluid: remove it there first");
  m_forces.reserve(m_forces.size() + 1);
  if (!m_fields) {
    auto fields = std::make_unique<ForceFields>();
    if (Status s = m_world->add_effect(*fields); !s.ok()) return s;
    m_fields = std::move(fields);
  }
  Status status = force->attach(this);
  if (status.ok()) m_forces.push_back(force);
  forgetFields();
  return status;
}

void btFluid::removeForce(btFluidForce* force) {
  const auto it = std::find(m_forces.begin(), m_forces.end(), force);
  if (it == m_forces.end()) return;
  force->detach();
  m_forces.erase(it);
  forgetFields();
}

/// Without forces the world has no effect for them.
void btFluid::forgetFields() {
  if (!m_fields || !m_forces.empty()) return;
  m_world->remove_effect(*m_fields);
  m_fields.reset();
}

void btFluid::releaseSinksAndForces() {
  for (btFluidSink* sink : m_sinks) sink->detach();
  m_sinks.clear();
  for (btFluidForce* force : m_forces) force->detach();
  m_forces.clear();
  forgetFields();
}

btFluidUniformForce::btFluidUniformForce(const btVector3& acceleration)
    : btFluidForce(UniformForce{{}, to_vec3(acceleration)}) {}

Status btFluidUniformForce::setAcceleration(const btVector3& acceleration) {
  UniformForce changed = field<UniformForce>();
  changed.acceleration = to_vec3(acceleration);
  return change(changed);
}

btVector3 btFluidUniformForce::getAcceleration() const {
  return to_bt(field<UniformForce>().acceleration);
}

btFluidVortex::btFluidVortex(const btVector3& center, const btVector3& axis, btScalar radius,
                             btScalar strength)
    : btFluidForce(VortexForce{
          {}, to_vec3(center), to_vec3(axis), static_cast<double>(radius), static_cast<double>(strength)}) {}

Status btFluidVortex::setAxis(const btVector3& center, const btVector3& axis) {
  VortexForce changed = field<VortexForce>();
  changed.center = to_vec3(center);
  changed.axis = to_vec3(axis);
  return change(changed);
}

Status btFluidVortex::setStrength(btScalar strength) {
  VortexForce changed = field<VortexForce>();
  changed.strength = static_cast<double>(strength);
  return change(changed);
}

btScalar btFluidVortex::getStrength() const {
  return static_cast<btScalar>(field<VortexForce>().strength);
}

namespace {

WindForce wind_of(const btVector3& velocity) {
  WindForce wind;
  wind.velocity = to_vec3(velocity);
  return wind;
}

}  // namespace

btFluidWind::btFluidWind(const btVector3& velocity) : btFluidForce(wind_of(velocity)) {}

Status btFluidWind::setVelocity(const btVector3& velocity) {
  WindForce changed = field<WindForce>();
  changed.velocity = to_vec3(velocity);
  return change(changed);
}

btVector3 btFluidWind::getVelocity() const {
  return to_bt(field<WindForce>().velocity);
}

Status btFluidWind::setAir(btScalar density, btScalar dragCoefficient, btScalar frictionCoefficient) {
  WindForce changed = field<WindForce>();
  changed.air_density = static_cast<double>(density);
  changed.drag_coefficient = static_cast<double>(dragCoefficient);
  changed.friction_coefficient = static_cast<double>(frictionCoefficient);
  return change(changed);
}

}  // namespace oilskin::bullet
