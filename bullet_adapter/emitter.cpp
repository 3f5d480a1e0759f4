#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "convert.h"
#include "oilskin/bullet_emitter.h"
#include "shape_mesh.h"
#include "shape_region.h"

namespace oilskin::bullet {

namespace {

Status check_speed(btScalar speed) {
  if (std::isfinite(speed) && speed >= 0) return {};
  std::ostringstream text;
  text << "emitter: speed is " << speed << "; it must be finite and ≥ 0 m/s";
  return Status::refused(text.str());
}

Status check_duration(double duration) {
  if (std::isfinite(duration) && duration >= 0) return {};
  std::ostringstream text;
  text << "emitter: duration is " << duration << "; it must be finite and ≥ 0 s";
  return Status::refused(text.str());
}

const Vec3 down(0, -1, 0);

}  // namespace

btFluidEmitter::~btFluidEmitter() {
  if (m_fluid) m_fluid->removeEmitter(this);
}

World* btFluidEmitter::world() const {
  return m_fluid ? &m_fluid->getWorld() : nullptr;
}

EmitterPose btFluidEmitter::pose(const btTransform& transform) const {
  EmitterPose pose;
  pose.rotation = Rotation(basis_of(transform));
  pose.position = to_vec3(transform.getOrigin()) + pose.rotation.normalized() * center();
  return pose;
}

Status btFluidEmitter::place(const btTransform& transform, double duration, bool jumps) {
  Status status = check_rigid(transform, "the transform of the emitter");
  if (status.ok()) status = check_duration(duration);
  if (!status.ok()) return status;
  const bool is_first = world() && !m_isPlaced && world()->time() == m_addedAt;
  if (world())
    status = jumps || is_first ? world()->place_emitter(m_id, pose(transform))
                               : world()->move_emitter(m_id, pose(transform), duration);
  if (!status.ok()) return status;
  m_transform = transform;
  m_isPlaced = true;
  return status;
}

Status btFluidEmitter::setWorldTransform(const btTransform& transform, btScalar duration) {
  return place(transform, static_cast<double>(duration), false);
}

Status btFluidEmitter::teleport(const btTransform& transform) {
  return place(transform, 0, true);
}

Status btFluidEmitter::setSpeed(btScalar speed) {
  Status status = check_speed(speed);
  if (status.ok() && world()) status = world()->set_emitter_speed(m_id, static_cast<double>(speed));
  if (status.ok()) m_speed = speed;
  return status;
}

Status btFluidEmitter::setEnabled(bool enabled) {
  Status status;
  if (world()) status = world()->set_emitter_enabled(m_id, enabled);
  if (status.ok()) m_enabled = enabled;
  return status;
}

Status btFluidEmitter::setInheritedVelocity(const btVector3& velocity) {
  Status status;
  if (!to_vec3(velocity).allFinite())
    status = Status::refused("emitter: the inherited velocity is not finite");
  if (status.ok() && world()) status = world()->set_inherited_velocity(m_id, to_vec3(velocity));
  if (status.ok()) m_inheritedVelocity = velocity;
  return status;
}

btScalar btFluidEmitter::getEmittedVolume() const {
  const std::optional<EmitterState> state = world() ? world()->emitter(m_id) : std::nullopt;
  return static_cast<btScalar>(m_volumeBefore + (state ? state->volume : 0));
}

bool btFluidEmitter::hasEnded() const {
  const std::optional<EmitterState> state = world() ? world()->emitter(m_id) : std::nullopt;
  return state && state->ended;
}

Status btFluidEmitter::attach(btFluid* fluid) {
  World& world = fluid->getWorld();
  EmitterId id;
  Status status = check_speed(m_speed);
  if (status.ok()) status = addTo(world, pose(m_transform), &id);
  if (!status.ok()) return status;
  status = world.set_emitter_speed(id, static_cast<double>(m_speed));
  if (status.ok()) status = world.set_emitter_enabled(id, m_enabled);
  if (status.ok()) status = world.set_inherited_velocity(id, to_vec3(m_inheritedVelocity));
  if (!status.ok()) {
    world.remove_emitter(id);
    return status;
  }
  m_fluid = fluid;
  m_id = id;
  m_addedAt = world.time();
  return status;
}

void btFluidEmitter::detach() {
  if (const std::optional<EmitterState> state = world()->emitter(m_id)) m_volumeBefore += state->volume;
  world()->remove_emitter(m_id);
  m_fluid = nullptr;
  m_id = EmitterId();
}

Status btFluid::addEmitter(btFluidEmitter* emitter) {
  if (!emitter) return Status::refused("emitter is null");
  if (emitter->m_fluid == this) return Status::refused("this emitter is in this fluid already");
  if (emitter->m_fluid) return Status::refused("this emitter is in another fluid: remove it there first");
  m_emitters.reserve(m_emitters.size() + 1);
  Status status = emitter->attach(this);
  if (status.ok()) m_emitters.push_back(emitter);
  return status;
}

void btFluid::removeEmitter(btFluidEmitter* emitter) {
  const auto it = std::find(m_emitters.begin(), m_emitters.end(), emitter);
  if (it == m_emitters.end()) return;
  emitter->detach();
  m_emitters.erase(it);
}

void btFluid::releaseEmitters() {
  for (btFluidEmitter* emitter : m_emitters) emitter->detach();
  m_emitters.clear();
}

Status btFluidDiscEmitter::addTo(World& world, const EmitterPose& pose, EmitterId* id) const {
  DiscEmitter disc;
  disc.direction = down;
  disc.radius = static_cast<double>(m_radius);
  disc.start = world.time();
  return world.add_emitter(disc, id, &pose);
}

Status btFluidBoxEmitter::addTo(World& world, const EmitterPose& pose, EmitterId* id) const {
  BoxEmitter box;
  box.box = {-to_vec3(m_halfExtents), to_vec3(m_halfExtents)};
  box.velocity = down;
  box.start = world.time();
  return world.add_emitter(box, id, &pose);
}

btFluidMeshEmitter::btFluidMeshEmitter(const btCollisionShape* shape) : btFluidEmitter(0) {
  if (shape)
    read(*shape);
  else
    m_status = Status::refused("mesh emitter: the shape is null");
}

btFluidMeshEmitter::btFluidMeshEmitter(const btStridingMeshInterface* mesh) : btFluidEmitter(0) {
  btVector3 low(1, 1, 1), high(0, 0, 0);
  // Bullet's functions that only read a mesh are not const.
  auto* source = const_cast<btStridingMeshInterface*>(mesh);
  if (source && source->getNumSubParts() > 0) source->calculateAabbBruteForce(low, high);
  if (!to_vec3(low).allFinite() || !to_vec3(high).allFinite() || low.x() > high.x()) {
    m_status =
        Status::refused("mesh emitter: the mesh is null or has no triangles, or a vertex is not finite");
    return;
  }
  read(btBvhTriangleMeshShape(source, true, low, high));
}

void btFluidMeshEmitter::read(const btCollisionShape& shape) {
  ShapeMesh mesh;
  m_status = read_shape(shape, &mesh);
  if (!m_status.ok()) return;
  for (int i = 0; i < static_cast<int>(mesh.vertices.size()); ++i)
    m_mesh.vertices.push_back(to_vec3(mesh.vertices[static_cast<std::size_t>(i)]));
  m_mesh.triangles = mesh.triangles;
}

Vec3 btFluidMeshEmitter::center() const {
  Box box;
  for (const Vec3& x : m_mesh.vertices) box.add(x);
  return m_mesh.vertices.empty() ? Vec3(Vec3::Zero()) : Vec3(0.5 * (box.min + box.max));
}

Status btFluidMeshEmitter::addTo(World& world, const EmitterPose& pose, EmitterId* id) const {
  if (!m_status.ok()) return m_status;
  MeshEmitter mesh = m_mesh;
  mesh.velocity = down;
  mesh.start = world.time();
  return world.add_emitter(mesh, id, &pose);
}

btFluidRainEmitter::btFluidRainEmitter(btScalar halfX, btScalar halfZ, btScalar dropsPerSecond,
                                       btScalar dropRadius, btScalar speed)
    : btFluidEmitter(speed),
      m_halfX(halfX),
      m_halfZ(halfZ),
      m_dropsPerSecond(dropsPerSecond),
      m_dropRadius(dropRadius) {}

Status btFluidRainEmitter::addTo(World& world, const EmitterPose& pose, EmitterId* id) const {
  const double x = static_cast<double>(m_halfX), z = static_cast<double>(m_halfZ);
  if (!(x >= 0 && z >= 0)) return Status::refused("rain emitter: halfX and halfZ must be at least 0 m");
  RainEmitter rain;
  rain.corner = Vec3(-x, 0, -z);
  rain.edge_u = Vec3(2 * x, 0, 0);
  rain.edge_v = Vec3(0, 0, 2 * z);
  rain.drops_per_second = static_cast<double>(m_dropsPerSecond);
  rain.drop_radius = static_cast<double>(m_dropRadius);
  rain.velocity = down;
  rain.start = world.time();
  return world.add_emitter(rain, id, &pose);
}

Status btFluidRainEmitter::setDropsPerSecond(btScalar rate) {
  Status status;
  if (!(std::isfinite(rate) && rate > 0))
    status = Status::refused("emitter: drops per second must be finite and > 0");
  if (status.ok() && world())
    status = world()->set_drops_per_second(getEmitterId(), static_cast<double>(rate));
  if (status.ok()) m_dropsPerSecond = rate;
  return status;
}

}  // namespace oilskin::bullet
