// Listeners, and what a coupling sums for its owner.
#include <algorithm>
#include <utility>

#include "convert.h"
#include "coupling_impl.h"

namespace oilskin::bullet {

namespace {

/// Of each surface of the last step: the number of particles with a contact there.
std::vector<std::size_t> count_touching_particles(const World& world) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const Contact& c : world.contacts()) pairs.emplace_back(c.surface, c.particle);
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<std::size_t> count(world.contact_surfaces().size(), 0);
  for (const auto& pair : pairs) ++count[pair.first];
  return count;
}

/// Which of the surfaces of a step it is; they are in the order of their handles.
std::optional<std::size_t> place_of(SurfaceId id, const std::vector<SurfaceId>& surfaces) {
  const auto by_value = [](SurfaceId a, SurfaceId b) { return a.value < b.value; };
  const auto it = std::lower_bound(surfaces.begin(), surfaces.end(), id, by_value);
  if (it == surfaces.end() || !(*it == id)) return {};
  return static_cast<std::size_t>(it - surfaces.begin());
}

/// Sets a flag for as long as it lives.
class Raised {
 public:
  explicit Raised(bool& flag) : flag_(flag) { flag_ = true; }
  ~Raised() { flag_ = false; }
  Raised(const Raised&) = delete;
  Raised& operator=(const Raised&) = delete;

 private:
  bool& flag_;
};

}  // namespace

btFluidListener::~btFluidListener() {
  if (m_coupling) m_coupling->removeListener(this);
}

Status btFluidListener::setSplashThreshold(btScalar impulse) {
  if (!(impulse >= 0)) return Status::refused("the splash threshold must be at least 0 N s");
  m_splashThreshold = impulse;
  return Status::accepted();
}

/// Null for one that is not attached any more, or that a listener took out of its world and deleted.
const btCollisionObject* btFluidCoupling::Impl::object_of(std::uint64_t number) const {
  const auto it = std::find_if(attachments.begin(), attachments.end(),
                               [number](const Attachment& a) { return a.number == number; });
  if (it == attachments.end()) return nullptr;
  if (!collision_world) return it->object;
  const btCollisionObjectArray& present = collision_world->getCollisionObjectArray();
  for (int i = 0; i < present.size(); ++i)
    if (present[i] == it->object) return it->mark->is_on(*it->object) ? it->object : nullptr;
  return nullptr;
}

/// What the fluids did to each surface. They agree on the motion of one that several of them touch.
void btFluidCoupling::Impl::hear_surfaces(double dt) {
  const std::vector<World*> all = worlds();
  std::vector<std::vector<std::size_t>> particles(all.size());
  if (!listening.listeners.empty())
    for (std::size_t k = 0; k < all.size(); ++k) particles[k] = count_touching_particles(*all[k]);
  const std::vector<ParticlesBefore> before = std::exchange(particles_before, {});
  std::vector<std::vector<const Vec3*>> starts;
  for (std::size_t k = 0; k < before.size(); ++k) starts.push_back(before[k].positions_of(*all[k]));
  for (Attachment& a : attachments) {
    if (a.sensor) {
      if (!before.empty() && a.measures) listening.add_flow(a.sensor->end(all, starts), a.number);
      continue;
    }
    const SurfaceMotion* motion = nullptr;
    double area = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const std::optional<std::size_t> surface = place_of(a.ids[k], all[k]->contact_surfaces());
      if (!surface) continue;
      motion = all[k]->surface(a.ids[k]);
      const double spacing = all[k]->fluid_settings().spacing;
      if (!particles[k].empty()) area += static_cast<double>(particles[k][*surface]) * spacing * spacing;
    }
    if (motion)
      listening.add_load(*motion, area, dt, a.number, a.touched);
    else
      listening.add_no_load(dt, a.number, a.touched);
  }
}

/// Objects become sensors, and walls again, by their flag.
void btFluidCoupling::Impl::prepare_sensors() {
  particles_before.clear();
  const std::vector<World*> all = worlds();
  for (Attachment& a : attachments) {
    if (!a.rigid) continue;
    const bool is_sensor = Sensor::is_sensor(*a.object);
    if (is_sensor && !a.sensor) {
      detach(a);
      a.sensor = std::make_unique<Sensor>(a.object);
    }
    if (!is_sensor) become_wall(a);
    if (!a.sensor) continue;
    const Status status = a.sensor->read();
    a.measures = status.ok();
    if (!status.ok()) note(status.message);
    if (!a.measures) continue;
    a.sensor->begin(all);
    if (!particles_before.empty()) continue;
    for (const World* w : all) particles_before.emplace_back(*w);
  }
}

void btFluidCoupling::Impl::become_wall(Attachment& a) {
  a.sensor.reset();
  if (a.id()) return;
  if (!a.takes_impulses && !a.object->isStaticOrKinematicObject())
    return note("a dynamic body is a sensor no longer, and no wall: remove it from the coupling");
  a.rigid->forget_motion();
  const Status status = attach(a);
  if (!status.ok()) note("a sensor that became a wall was left out: " + status.message);
}

void btFluidCoupling::Impl::hear(const StepReport& report) {
  listening.due.clear();
  listening.sum.add(report);
  if (report.status.ok()) hear_surfaces(report.dt);
  if (listening.listeners.empty()) return;
  listening.report = report;
  listening.due.emplace_back();
}

const StepReport& btFluidCoupling::Impl::refuse_within_call() {
  listening.refused = StepReport();
  listening.refused.status =
      Status::refused("a listener may not step: leave that until the call has returned");
  note(listening.refused.status.message);
  return listening.refused;
}

void btFluidCoupling::Impl::tell(const FluidEvent& event, btFluidListener& listener) {
  if (event.kind == FluidEvent::Kind::stepped) return listener.stepped(listening.report);
  const btCollisionObject* object = object_of(event.attachment);
  if (!object) return;
  if (event.kind == FluidEvent::Kind::touch_began) return listener.touchBegan(object, event.touch);
  if (event.kind == FluidEvent::Kind::touch_ended) return listener.touchEnded(object);
  if (event.kind == FluidEvent::Kind::water_entered) return listener.waterEntered(object, event.flow);
  if (event.kind == FluidEvent::Kind::water_left) return listener.waterLeft(object, event.flow);
  if (event.touch.m_impulse.length() > listener.getSplashThreshold()) listener.splash(object, event.touch);
}

/// A call may change the listeners and the attachments.
void btFluidCoupling::tellListeners() {
  Listening& listening = m_impl->listening;
  if (listening.due.empty() || listening.is_telling) return;
  const Raised telling(listening.is_telling);
  std::vector<FluidEvent> due;
  due.swap(listening.due);
  for (const FluidEvent& event : due) {
    const std::vector<btFluidListener*> listeners = listening.listeners;
    for (btFluidListener* listener : listeners)
      if (listening.has(listener)) m_impl->tell(event, *listener);
  }
}

Status btFluidCoupling::addListener(btFluidListener* listener) {
  if (!listener) return Status::refused("listener is null");
  if (listener->m_coupling) return Status::refused("this listener is in a coupling already: remove it there");
  m_impl->listening.listeners.push_back(listener);
  listener->m_coupling = this;
  return Status::accepted();
}

void btFluidCoupling::removeListener(btFluidListener* listener) {
  if (!listener || listener->m_coupling != this) return;
  std::vector<btFluidListener*>& all = m_impl->listening.listeners;
  all.erase(std::find(all.begin(), all.end(), listener));
  listener->m_coupling = nullptr;
}

void btFluidCoupling::forgetListeners() {
  for (btFluidListener* listener : m_impl->listening.listeners) listener->m_coupling = nullptr;
  m_impl->listening.listeners.clear();
}

Status btFluidCoupling::setTouchHold(btScalar seconds) {
  if (!(seconds >= 0) || seconds > std::numeric_limits<btScalar>::max())
    return Status::refused("the time that a touch is held must be finite and at least 0 s");
  m_impl->listening.touch_hold = static_cast<double>(seconds);
  return Status::accepted();
}

btScalar btFluidCoupling::getTouchHold() const {
  return static_cast<btScalar>(m_impl->listening.touch_hold);
}

StepReport btFluidCoupling::takeReport() {
  StepReport taken;
  std::swap(taken, m_impl->listening.sum);
  return taken;
}

bool btFluidCoupling::takeImpulse(const btCollisionObject* object, btVector3& linear, btVector3& angular) {
  Attachment* a = m_impl->find(object);
  if (!a) return false;
  linear = to_bt(a->touched.total.impulse);
  angular = to_bt(a->touched.total.angular_impulse);
  a->touched.total = {};
  return true;
}

const btFluidReading* btFluidCoupling::getReading(const btCollisionObject* object) const {
  const Attachment* a = m_impl->find(object);
  return a && a->sensor ? &a->sensor->reading() : nullptr;
}

const btCollisionObject* btFluidCoupling::getObject(SurfaceId surface, const btFluid* fluid) const {
  const std::optional<std::size_t> k = m_impl->index_of(fluid);
  if (!surface || !k) return nullptr;
  for (const Attachment& a : m_impl->attachments)
    if (a.ids[*k] == surface) return a.object;
  return nullptr;
}

const btCollisionObject* btFluidCoupling::getObject(std::uint32_t surface, const btFluid* fluid) const {
  const std::optional<std::size_t> k = m_impl->index_of(fluid);
  if (!k) return nullptr;
  const std::vector<SurfaceId>& all = m_impl->fluids[*k]->getWorld().contact_surfaces();
  return surface < all.size() ? getObject(all[surface], fluid) : nullptr;
}

}  // namespace oilskin::bullet
