#include <algorithm>

#include "convert.h"
#include "oilskin/bullet_sink.h"
#include "shape_region.h"

namespace oilskin::bullet {

btFluidSink::btFluidSink(const btConvexShape* shape) {
  m_status = read_region(shape, &m_region);
}

btFluidSink::~btFluidSink() {
  if (m_fluid) m_fluid->removeSink(this);
}

std::optional<SinkState> btFluidSink::state() const {
  return m_fluid ? m_fluid->getWorld().sink(m_id) : std::nullopt;
}

Status btFluidSink::setWorldTransform(const btTransform& transform) {
  EmitterPose pose;
  Status status = read_pose(transform, &pose);
  if (status.ok() && m_fluid) status = m_fluid->getWorld().move_sink(m_id, pose);
  if (status.ok()) m_transform = transform;
  return status;
}

btTransform btFluidSink::getWorldTransform() const {
  const std::optional<SinkState> now = state();
  if (!now) return m_transform;
  const Rotation& turn = now->region.pose.rotation;
  const btQuaternion rotation(static_cast<btScalar>(turn.x()), static_cast<btScalar>(turn.y()),
                              static_cast<btScalar>(turn.z()), static_cast<btScalar>(turn.w()));
  return btTransform(rotation, to_bt(now->region.pose.position));
}

Status btFluidSink::setEnabled(bool enabled) {
  Status status;
  if (m_fluid) status = m_fluid->getWorld().set_sink_enabled(m_id, enabled);
  if (status.ok()) m_enabled = enabled;
  return status;
}

bool btFluidSink::isEnabled() const {
  const std::optional<SinkState> now = state();
  return now ? now->enabled : m_enabled;
}

std::uint64_t btFluidSink::getTakenParticles() const {
  const std::optional<SinkState> now = state();
  return m_takenBefore + (now ? now->particles : 0);
}

btScalar btFluidSink::getTakenVolume() const {
  const std::optional<SinkState> now = state();
  return static_cast<btScalar>(m_volumeBefore + (now ? now->volume : 0));
}

Status btFluidSink::attach(btFluid* fluid) {
  if (!m_status.ok()) return m_status;
  Region region = m_region;
  Status status = read_pose(m_transform, &region.pose);
  SinkId id;
  if (status.ok()) status = fluid->getWorld().add_sink(region, &id);
  if (status.ok()) status = fluid->getWorld().set_sink_enabled(id, m_enabled);
  if (!status.ok()) return status;
  m_fluid = fluid;
  m_id = id;
  return status;
}

void btFluidSink::detach() {
  m_transform = getWorldTransform();
  m_enabled = isEnabled();
  m_takenBefore = getTakenParticles();
  if (const std::optional<SinkState> now = state()) m_volumeBefore += now->volume;
  m_fluid->getWorld().remove_sink(m_id);
  m_fluid = nullptr;
  m_id = SinkId();
}

Status btFluid::addSink(btFluidSink* sink) {
  if (!sink) return Status::refused("sink is null");
  if (sink->m_fluid == this) return Status::refused("this sink is in this fluid already");
  if (sink->m_fluid) return Status::refused("this sink is in another fluid: remove it there first");
  m_sinks.reserve(m_sinks.size() + 1);
  Status status = sink->attach(this);
  if (status.ok()) m_sinks.push_back(sink);
  return status;
}

void btFluid::removeSink(btFluidSink* sink) {
  const auto it = std::find(m_sinks.begin(), m_sinks.end(), sink);
  if (it == m_sinks.end()) return;
  sink->detach();
  m_sinks.erase(it);
}

Status btFluid::setMaxAge(btScalar seconds) {
  return m_world->set_max_age(static_cast<double>(seconds));
}

}  // namespace oilskin::bullet
