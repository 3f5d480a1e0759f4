#include <cstring>

#include "convert.h"
#include "oilskin/bullet.h"

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

}  // namespace

btFluid::btFluid(btScalar restDistance)
    : m_world(std::make_unique<World>(WorldSettings{}, with_spacing(restDistance))) {}

btFluid::btFluid(const FluidSettings& fluid, const WorldSettings& world, const ContactSettings& contact)
    : m_world(std::make_unique<World>(world, fluid, contact)) {}

btFluid::~btFluid() {
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
