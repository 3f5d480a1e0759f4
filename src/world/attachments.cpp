#include "world/attachments.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/assert.h"
#include "core/body_motion.h"
#include "core/inverse_mass.h"
#include "core/refuse.h"
#include "world/absorption.h"
#include "world/carried_mass.h"
#include "world/numeric_range.h"
#include "world/sharing.h"

namespace oilskin::world {

double max_coordinate(const Box& kill_box) {
  return std::max(kill_box.min.cwiseAbs().maxCoeff(), kill_box.max.cwiseAbs().maxCoeff());
}

namespace {

Status check_mesh(const SurfaceMotion& m) {
  if (m.triangles.empty())
    return refuse("the surface has no triangles (faces); contact needs a triangle mesh");
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    for (std::uint32_t v : m.triangles[t])
      if (v >= m.x_t1.size())
        return refuse("triangle ", t, " has the node index ", v, "; the surface has ", m.x_t1.size(),
                      " nodes (0 … ", m.x_t1.size() - 1, ")");
  return {};
}

bool is_added_mass(const SurfaceMotion& m, std::size_t i) {
  return m.added_mass[i] >= 0 && m.added_mass[i] * m.inverse_mass[i] < 1;
}

Status check_state(const SurfaceMotion& m) {
  const std::size_t n = m.x_t1.size();
  if (m.velocity.size() != n || m.inverse_mass.size() != n || (!m.holdable.empty() && m.holdable.size() != n))
    return refuse("the host gave ", n, " positions, ", m.velocity.size(), " velocities, ",
                  m.inverse_mass.size(), " inverse masses; they must be as many");
  if (!m.added_mass.empty() && m.added_mass.size() != n)
    return refuse("the host gave ", n, " positions and ", m.added_mass.size(),
                  " added masses; they must be as many, or none");
  for (std::size_t i = 0; i < n; ++i) {
    if (!m.x_t1[i].allFinite()) return refuse("the position of node ", i, " is not finite");
    if (!m.velocity[i].allFinite()) return refuse("the velocity of node ", i, " is not finite");
    if (!is_in_range(m.x_t1[i]) || !is_in_range(m.velocity[i]))
      return refuse("node ", i, " is farther or faster than 1e15; the host's simulation has exploded");
    if (!is_inverse_mass(m.inverse_mass[i]))
      return refuse("the inverse mass of node ", i, " is ", m.inverse_mass[i], "; it must be ",
                    inverse_mass_range);
    if (!m.added_mass.empty() && !is_added_mass(m, i))
      return refuse("the added mass of node ", i, " is ", m.added_mass[i],
                    "; it must be ≥ 0 and less than 1/inverse mass");
    if (stored(m.x_t1[i], m.storage) != m.x_t1[i])
      return refuse("the position of node ", i, " is not a ",
                    m.storage == Storage::float32 ? "single" : "double", "-precision number");
  }
  return check_body(m);
}

Status set_delta(SurfaceMotion& m, const SurfaceSettings& settings, double r, const Sharing& sharing = {}) {
  OILSKIN_ASSERT(settings.thickness);
  m.thickness = sharing.thickness > 0 ? sharing.thickness : *settings.thickness;
  r = std::max(r, sharing.reach);
  m.slip = settings.slip;
  m.slip_back = settings.slip_back;
  m.smooth = settings.smooth;
  m.delta = minimum_separation(m.thickness, r, m.storage);
  if (m.thickness >= 4 * m.delta) return {};
  const double per_metre = 4 * minimum_separation(0, 1, m.storage);
  return refuse(
      "thickness is ", m.thickness, " m, below 4 δ = ", 4 * m.delta, " m; with a kill box that reaches ", r,
      " m and ", m.storage == Storage::float32 ? "single" : "double", "-precision positions it must be ≥ ",
      per_metre * r, " m, or the kill box must reach no farther than ", m.thickness / per_metre, " m");
}

bool is_zero(const Vec3& v) {
  return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

/// Bits are compared, so that +0 and −0 differ.
bool are_same(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

/// Whether SurfaceMotion::still holds.
bool stands_still(const SurfaceMotion& m) {
  if (m.body || !m.added_mass.empty()) return false;
  if (std::any_of(m.inverse_mass.begin(), m.inverse_mass.end(), [](double u) { return u != 0; }))
    return false;
  return are_same(m.x_t0, m.x_t1) && std::all_of(m.velocity.begin(), m.velocity.end(), is_zero);
}

Status refuse_unchanged() {
  return refuse(
      "the host says that nothing changed, but motion.revision was 0: it must fill in the motion, and may "
      "leave it as it is where it finds its own number there");
}

}  // namespace

void Attachments::note_stillness(SurfaceMotion& m) {
  m.still = m.revision != 0 && stands_still(m) ? next_still_++ : 0;
  if (m.still == 0) return;
  m.velocity_t0.clear();  // as `velocity`
  m.impulse.clear();      // contact makes new ones
  m.moved.clear();
  m.touched.clear();
}

bool stand_alike(const SurfaceMotion& m, const SurfaceMotion& still) {
  return still.still != 0 && stands_still(m) && are_same(m.x_t1, still.x_t1) && m.holdable == still.holdable;
}

bool can_collide(const FluidSettings& fluid, const SurfaceSettings& surface) {
  return (fluid.collision_mask & surface.collision_group) != 0 &&
         (surface.collision_mask & fluid.collision_group) != 0;
}

Status Attachments::attach(SurfaceHost& host, const SurfaceSettings& settings, const WorldSettings& world,
                           std::uint64_t* handle) {
  // The smallest thickness depends on the host's storage: of a thickness of zero set_delta() says it.
  if (Status s = settings.validate(); !s.ok() && settings.thickness != 0.0) return s;
  for (const auto& other : list_)
    if (other->host == &host)
      return refuse("the host is attached already, as surface ", other->handle,
                    "; detach that, or attach a host of its own");
  auto a = std::make_unique<Attachment>();
  a->host = &host;
  a->settings = settings;
  const Gathered gathered = host.gather(0, a->motion);
  if (!gathered.status.ok()) return gathered.status;
  if (gathered.unchanged) return refuse_unchanged();
  if (Status s = check_mesh(a->motion); !s.ok()) return s;
  if (Status s = check_state(a->motion); !s.ok()) return s;
  if (Status s = set_delta(a->motion, settings, max_coordinate(world.kill_box)); !s.ok()) return s;
  const double r = max_coordinate(world.kill_box);
  for (std::size_t i = 0; i < a->motion.x_t1.size(); ++i)
    if (a->motion.inverse_mass[i] > 0 && a->motion.x_t1[i].cwiseAbs().maxCoeff() > r)
      return refuse("node ", i, " stands at (", a->motion.x_t1[i].transpose(),
                    ") m, beyond the largest coordinate ", r,
                    " m of the kill box, for which δ was chosen; enlarge the kill box");
  a->motion.x_t0 = a->motion.x_t1;
  start_body(a->motion, {}, true, 0);
  note_stillness(a->motion);
  OILSKIN_ASSERT(list_.empty() || list_.back()->handle < next_handle_);
  OILSKIN_ASSERT(a->motion.delta > 0 && a->motion.thickness >= 4 * a->motion.delta);
  list_.push_back(std::move(a));
  list_.back()->motion.id = next_id_++;
  list_.back()->handle = next_handle_++;
  if (handle) *handle = list_.back()->handle;
  return {};
}

void Attachments::detach(std::uint64_t handle) {
  const auto has_handle = [handle](const auto& a) { return a->handle == handle; };
  list_.erase(std::remove_if(list_.begin(), list_.end(), has_handle), list_.end());
}

Attachment* Attachments::find(std::uint64_t handle) {
  const auto at = std::lower_bound(list_.begin(), list_.end(), handle,
                                   [](const auto& a, std::uint64_t h) { return a->handle < h; });
  return at != list_.end() && (*at)->handle == handle ? at->get() : nullptr;
}
const Attachment* Attachments::find(std::uint64_t handle) const {
  return const_cast<Attachments*>(this)->find(handle);
}

namespace {

bool is_out_of_range(const SurfaceMotion& m, double max_coordinate) {
  if (m.still != 0) return false;  // all nodes are prescribed
  for (std::size_t i = 0; i < m.x_t1.size(); ++i)
    if (m.inverse_mass[i] > 0 && m.x_t1[i].cwiseAbs().maxCoeff() > max_coordinate) return true;
  return false;
}

}  // namespace

ActiveSurfaces Attachments::gather(double dt, const WorldSettings& world, const FluidSettings& fluid,
                                   StepReport& report) {
  ActiveSurfaces active;
  for (auto& a : list_) {
    const bool stays_out = a->refused && !a->teleported;
    if (!stays_out) {
      const Status status = gather_surface(*a, dt, world.kill_box, report);
      a->refused = !status.ok();
      a->teleported = false;
      if (a->refused)
        report.messages.push_back("surface " + std::to_string(a->handle) + " is left out: " + status.message);
    }
    if (a->refused) {
      report.flags |= flag_surface_refused;
      a->motion.revision = a->motion.still = 0;
      forget_load(*a);
      continue;
    }
    // Prescribed nodes are not rounded again, wherever they stand: a floor may be larger than the kill box.
    if (is_out_of_range(a->motion, max_coordinate(world.kill_box))) report.flags |= flag_surface_out_of_range;
    if (can_collide(fluid, a->settings)) active.add(*a);
  }
  return active;
}

Status Attachments::gather_surface(Attachment& a, double dt, const Box& kill_box, StepReport& report) {
  SurfaceMotion& m = a.motion;
  a.liquid_change = {};
  if (a.teleported) m.still = 0;
  if (m.still == 0) m.revision = 0;
  std::swap(m.x_t0, m.x_t1);
  const std::size_t nodes_before = m.x_t0.size();
  if (a.settings.smooth && m.still == 0) m.velocity_t0 = m.velocity;
  m.added_mass.clear();
  const std::optional<BodyMotion> body = m.body;
  const std::uint64_t id = m.id;
  const Storage storage = m.storage;
  const std::size_t triangles = m.triangles.size();
  // Not of a level that stands still, to save the copy, nor where read_host() compares.
  const bool is_compared = m.still == 0 && !a.sharing.original;
  if (is_compared) triangles_before_ = m.triangles;
  const Gathered gathered = read_host(a, dt);
  if (!gathered.status.ok()) return gathered.status;
  if (gathered.unchanged && (m.still == 0 || gathered.new_surface)) return refuse_unchanged();
  // Also where the host does not say so: contact keeps what it knows of the mesh.
  const bool is_other_mesh = gathered.new_surface || m.storage != storage ||
                             m.triangles.size() != triangles ||
                             (is_compared && m.triangles != triangles_before_);
  if (!gathered.unchanged)
    if (Status s = take_motion(a, is_other_mesh, nodes_before, kill_box, report); !s.ok()) return s;
  start_body(m, body, m.id != id, dt);
  if (a.sharing.original) {
    m.body = a.sharing.original->motion.body;
    m.velocity_t0 = a.sharing.original->motion.velocity_t0;
  }
  OILSKIN_ASSERT(m.id != 0 && m.delta > 0 && m.x_t0.size() == m.x_t1.size());
  OILSKIN_ASSERT(m.still == 0 || stands_still(m));
  m.slip = a.settings.slip;
  m.slip_back = a.settings.slip_back;
  m.smooth = a.settings.smooth;
  return {};
}

/// Checks what the host filled in; gives it a new id where it is a new surface.
Status Attachments::take_motion(Attachment& a, bool new_surface, std::size_t nodes_before,
                                const Box& kill_box, StepReport& report) {
  SurfaceMotion& m = a.motion;
  const bool was_still = m.still != 0;
  m.still = 0;
  const bool is_new = new_surface || a.teleported || m.x_t1.size() != m.x_t0.size();
  if (is_new)
    if (Status s = check_mesh(m); !s.ok()) return s;
  if (Status s = check_state(m); !s.ok()) return s;
  // Hosts take a teleport for a motion if only the world knows of it.
  if (a.teleported && !m.body)
    for (std::size_t i = 0; i < m.velocity.size(); ++i)
      if (m.inverse_mass[i] == 0) m.velocity[i].setZero();
  if (is_new) {
    if (Status s = set_delta(m, a.settings, max_coordinate(kill_box), a.sharing); !s.ok()) return s;
    m.id = next_id_++;
    m.x_t0 = a.sharing.original ? a.sharing.original->motion.x_t0 : m.x_t1;
    m.velocity_t0.clear();
    a.is_new = true;
    forget_load(a);
    a.sharing.teleported = true;
    // A teleport keeps them. A mesh that was refused may have had another number of nodes.
    const bool fits = m.absorbed_mass.empty() || m.absorbed_mass.size() == m.x_t1.size();
    if (new_surface || m.x_t1.size() != nodes_before || !fits) {
      a.sharing.mesh_changed = true;
      a.values.clear();
      report.mass_lost += absorbed_mass(a);
      m.absorbed_mass.clear();
    }
  }
  if (!is_new && was_still && a.settings.smooth) m.velocity_t0.assign(m.x_t1.size(), Vec3::Zero());
  note_stillness(m);
  return {};
}

namespace {

/// Whether the nodes are where the certificate says.
bool is_certified(const SurfaceMotion& m, const std::vector<Vec3>& certified) {
  if (m.still == 0) return m.x_t1 == certified;
  OILSKIN_ASSERT(stands_still(m));
  return std::all_of(m.touched.begin(), m.touched.end(),
                     [&](std::uint32_t node) { return m.x_t1[node] == m.x_t0[node]; });
}

}  // namespace

void Attachments::scatter(const ActiveSurfaces& active, StepReport& report) {
  std::vector<Vec3> certified;
  for (Attachment* a : active.attachment) {
    SurfaceMotion& m = a->motion;
    OILSKIN_ASSERT(m.impulse.size() == m.x_t1.size() && m.moved.size() == m.x_t1.size());
    if (m.still == 0) certified = m.x_t1;
    write_host(*a);
    OILSKIN_ASSERT(m.x_t1.size() == m.x_t0.size());
    if (!is_certified(m, certified)) {
      // The certificate holds for positions that the host does not store: the stored ones begin a new
      // surface.
      report.flags |= flag_scatter_mismatch;
      a->teleported = true;
    }
  }
}

namespace {

/// `x`: x_t0 or x_t1 of its motion.
StandingSurface standing_at(const std::vector<Vec3>& x, Attachment& a) {
  return {a.motion.triangles,
          x,
          a.motion.inverse_mass,
          a.motion.delta,
          &a.geometry,
          a.motion.still,
          a.settings.solid.value_or(a.motion.solid)};
}

}  // namespace

std::vector<StandingSurface> Attachments::between_steps(const FluidSettings& fluid) const {
  std::vector<StandingSurface> standing;
  for (const auto& a : list_)
    if (!a->refused && can_collide(fluid, a->settings)) standing.push_back(standing_at(a->motion.x_t1, *a));
  return standing;
}

namespace {

/// From and to a still surface of one number: what a step may change.
void copy_changes(const SurfaceMotion& from, SurfaceMotion& to) {
  // Names every member: a new one that is forgotten here does not compile.
  const auto& [id, triangles, storage, thickness, delta, slip, slip_back, smooth, nodes_movable, solid, x_t0,
               x_t1, velocity, velocity_t0, inverse_mass, holdable, added_mass, body, impulse,
               angular_impulse, moved, touched, revision, still, carried_mass, absorbed_mass] = from;
  OILSKIN_ASSERT(!body && still != 0 && to.still == still && to.id == id && to.x_t1.size() == x_t1.size());
  OILSKIN_ASSERT(to.storage == storage && to.triangles.size() == triangles.size());
  OILSKIN_ASSERT(to.velocity.size() == velocity.size() && to.inverse_mass.size() == inverse_mass.size());
  OILSKIN_ASSERT(to.x_t0.size() == x_t0.size() && velocity_t0.empty() && added_mass.empty());
  OILSKIN_ASSERT(to.holdable.size() == holdable.size() && to.nodes_movable == nodes_movable);
  OILSKIN_ASSERT(to.solid == solid);
  to.thickness = thickness;
  to.delta = delta;
  to.slip = slip;
  to.slip_back = slip_back;
  to.smooth = smooth;
  to.revision = revision;
  to.carried_mass = carried_mass;
  to.absorbed_mass = absorbed_mass;
  if (to.impulse.size() != impulse.size() || to.moved.size() != moved.size()) {
    to.impulse = impulse;
    to.moved = moved;
  } else {
    for (std::uint32_t node : to.touched) {
      to.impulse[node].setZero();
      to.moved[node] = 0;
    }
    for (std::uint32_t node : touched) {
      to.impulse[node] = impulse[node];
      to.moved[node] = moved[node];
    }
  }
  to.angular_impulse = angular_impulse;
  to.touched = touched;
}

void save_state(Attachment& a) {
  SavedState& saved = a.saved;
  const bool has_arrays = a.motion.still != 0 && saved.still == a.motion.still;
  saved.still = 0;  // until all is copied
  if (has_arrays)
    copy_changes(a.motion, saved.motion);
  else
    saved.motion = a.motion;
  saved.mean_load = a.mean_load;
  saved.values = a.values;
  saved.is_new = a.is_new;
  saved.teleported = a.teleported;
  saved.refused = a.refused;
  saved.still = a.motion.still;
}

}  // namespace

void Attachments::checkpoint() {
  saved_next_id_ = next_id_;
  for (const auto& a : list_) save_state(*a);
}

void Attachments::roll_back() noexcept {
  next_id_ = saved_next_id_;
  for (const auto& attachment : list_) {
    Attachment& a = *attachment;
    std::swap(a.motion, a.saved.motion);
    a.mean_load.swap(a.saved.mean_load);
    a.values.swap(a.saved.values);
    a.is_new = a.saved.is_new;
    a.teleported = a.saved.teleported;
    a.refused = a.saved.refused;
    a.saved.still = 0;
    // Another mesh may get the id that the step gave to this one.
    if (a.geometry.id != a.motion.id) a.geometry.id = 0;
  }
}

const SurfaceMotion& Attachments::before(const Attachment& a) {
  // A refused motion holds what its host gave: its lists may differ in length, its masses make no sense.
  return a.saved.refused ? a.motion : a.saved.motion;
}

void ActiveSurfaces::add(Attachment& a) {
  a.geometry.analyse(a.motion);
  attachment.push_back(&a);
  motion.push_back(&a.motion);
  geometry.push_back(&a.geometry);
  topology.push_back(&a.geometry.topology);
}

std::vector<StandingSurface> ActiveSurfaces::at_start() const {
  std::vector<StandingSurface> standing;
  for (Attachment* a : attachment) standing.push_back(standing_at(a->motion.x_t0, *a));
  return standing;
}

std::vector<StandingSurface> ActiveSurfaces::at_end() const {
  std::vector<StandingSurface> standing;
  for (Attachment* a : attachment) standing.push_back(standing_at(a->motion.x_t1, *a));
  return standing;
}

}  // namespace oilskin::world
