#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "convert.h"
#include "oilskin/bullet.h"
#include "shape_region.h"

namespace oilskin::bullet {

namespace {

FluidSettings with_spacing(btScalar rest_distance) {
  FluidSettings settings;
  settings.spacing = static_cast<double>(rest_distance);
  return settings;
}

btVector3 value_at(Span<const Vec3> values, int i) {
  const bool is_inside = i >= 0 && static_cast<std::size_t>(i) < values.size();
  return is_inside ? to_bt(values[static_cast<std::size_t>(i)]) : btVector3(0, 0, 0);
}

void copy_strided(Span<const Vec3> values, float* out, int stride_bytes) {
  const bool has_room = out && stride_bytes >= static_cast<int>(3 * sizeof(float));
  if (!has_room) return;
  char* to = reinterpret_cast<char*>(out);
  for (const Vec3& v : values) {
    const float xyz[3] = {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
    std::memcpy(to, xyz, sizeof xyz);
    to += stride_bytes;
  }
}

int count_of(std::uint64_t n) {
  return static_cast<int>(std::min<std::uint64_t>(n, std::numeric_limits<int>::max()));
}

}  // namespace

btFluid::btFluid(btScalar restDistance)
    : m_world(std::make_unique<World>(WorldSettings{}, with_spacing(restDistance))) {}

btFluid::btFluid(const FluidSettings& fluid, const WorldSettings& world, const ContactSettings& contact)
    : m_world(std::make_unique<World>(world, fluid, contact)) {}

btFluid::~btFluid() {
  releaseEmitters();
  releaseSinksAndForces();
  if (m_coupling) m_coupling->removeFluid(this);
}

Status btFluid::addJet(const btVector3& position, const btVector3& direction, btScalar speed,
                       btScalar radius) {
  DiscEmitter jet;
  jet.center = to_vec3(position);
  jet.direction = to_vec3(direction);
  jet.radius = static_cast<double>(radius);
  jet.speed = static_cast<double>(speed);
  jet.start = m_world->time();
  return m_world->add_emitter(jet);
}

Status btFluid::addBox(const btVector3& boxMin, const btVector3& boxMax, const btVector3& velocity) {
  BoxEmitter box;
  box.box = {to_vec3(boxMin), to_vec3(boxMax)};
  box.velocity = to_vec3(velocity);
  box.start = m_world->time();
  return m_world->add_emitter(box);
}

int btFluid::removeParticles(const btVector3& aabbMin, const btVector3& aabbMax) {
  std::uint64_t removed = 0;
  const Status status = m_world->remove_particles(Box{to_vec3(aabbMin), to_vec3(aabbMax)}, &removed);
  return status.ok() ? count_of(removed) : -1;
}

int btFluid::removeParticles(const btConvexShape* shape, const btTransform& transform) {
  if (!shape) return -1;
  const std::optional<Eigen::Affine3d> to_local = inverse_of(transform);
  const std::optional<ConvexRegion> region = ConvexRegion::of(*shape);
  if (!to_local || !region) return -1;
  const Span<const Vec3> x = m_world->positions();
  std::vector<std::uint64_t> inside;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (region->contains(*to_local * x[i])) inside.push_back(m_world->ids()[i]);
  return count_of(m_world->remove_particles(inside));
}

void btFluid::clear() {
  m_world->clear();
}

void btFluid::setMaxParticles(int n) {
  m_world->set_max_particles(static_cast<std::uint64_t>(std::max(n, 0)));
}

int btFluid::getMaxParticles() const {
  return count_of(m_world->settings().max_particles);
}

Status btFluid::setStepBudget(btScalar seconds) {
  return m_world->set_step_budget(static_cast<double>(seconds));
}

btScalar btFluid::getStepBudget() const {
  return static_cast<btScalar>(m_world->settings().step_budget);
}

Status btFluid::setGravity(const btVector3& gravity) {
  if (m_coupling && m_coupling->followsClothGravity())
    return Status::refused(
        "the gravity is that of the attached cloth: set its btSoftBodyWorldInfo::m_gravity, or call "
        "setUseClothGravity(false) first");
  return m_world->set_gravity(to_vec3(gravity));
}

btVector3 btFluid::getGravity() const {
  return to_bt(m_world->settings().gravity);
}

std::uint64_t btFluid::getId(int i) const {
  const bool is_inside = i >= 0 && i < getNumParticles();
  return is_inside ? m_world->ids()[static_cast<std::size_t>(i)] : std::numeric_limits<std::uint64_t>::max();
}

btScalar btFluid::getMass() const {
  return static_cast<btScalar>(m_world->fluid_mass());
}

btScalar btFluid::getVolume() const {
  return static_cast<btScalar>(m_world->fluid_mass() / m_world->fluid_settings().rest_density);
}

int btFluid::getNumParticles() const {
  return static_cast<int>(m_world->particle_count());
}

btVector3 btFluid::getPosition(int i) const {
  return value_at(m_world->positions(), i);
}

btVector3 btFluid::getVelocity(int i) const {
  return value_at(m_world->motions(), i);
}

void btFluid::copyPositions(float* out, int strideBytes) const {
  copy_strided(m_world->positions(), out, strideBytes);
}

void btFluid::copyVelocities(float* out, int strideBytes) const {
  copy_strided(m_world->motions(), out, strideBytes);
}

}  // namespace oilskin::bullet
