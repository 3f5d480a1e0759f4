#include "world/attachments.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/inverse_mass.h"
#include "core/refuse.h"
#include "world/absorption.h"
#include "world/carried_mass.h"
#include "world/numeric_range.h"

namespace oilskin::world {

namespace {

double max_coordinate(const Box& kill_box) {
  return std::max(kill_box.min.cwiseAbs().maxCoeff(), kill_box.max.cwiseAbs().maxCoeff());
}

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
  return {};
}

Status set_delta(SurfaceMotion& m, const SurfaceSettings& settings, double r) {
  OILSKIN_ASSERT(settings.thickness);
  m.thickness = *settings.thickness;
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

}  // namespace

bool can_collide(const FluidSettings& fluid, const SurfaceSettings& surface) {
  return (fluid.collision_mask & surface.collision_group) != 0 &&
         (surface.collision_mask & fluid.collision_group) != 0;
}

Status Attachments::attach(SurfaceHost& host, const SurfaceSettings& settings, const WorldSettings& world,
                           std::uint64_t* handle) {
  // The smallest thickness depends on the host's storage: of a thickness of zero set_delta() says it.
  if (Status s = settings.validate(); !s.ok() && settings.thickness != 0.0) return s;
  auto a = std::make_unique<Attachment>();
  a->host = &host;
  a->settings = settings;
  const Gathered gathered = host.gather(0, a->motion);
  if (!gathered.status.ok()) return gathered.status;
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
  for (auto& a : list_)
    if (a->handle == handle) return a.get();
  return nullptr;
}
const Attachment* Attachments::find(std::uint64_t handle) const {
  return const_cast<Attachments*>(this)->find(handle);
}

namespace {

bool is_out_of_range(const SurfaceMotion& m, double max_coordinate) {
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
  std::swap(m.x_t0, m.x_t1);
  const std::size_t nodes_before = m.x_t0.size();
  if (a.settings.smooth) m.velocity_t0 = m.velocity;
  m.added_mass.clear();
  const Gathered gathered = a.host->gather(dt, m);
  if (!gathered.status.ok()) return gathered.status;
  const bool is_new = gathered.new_surface || a.teleported || m.x_t1.size() != m.x_t0.size();
  if (is_new)
    if (Status s = check_mesh(m); !s.ok()) return s;
  if (Status s = check_state(m); !s.ok()) return s;
  if (is_new) {
    if (Status s = set_delta(m, a.settings, max_coordinate(kill_box)); !s.ok()) return s;
    m.id = next_id_++;
    m.x_t0 = m.x_t1;
    m.velocity_t0.clear();
    a.is_new = true;
    forget_load(a);
    // A teleport keeps them. A mesh that was refused may have had another number of nodes.
    const bool fits = m.absorbed_mass.empty() || m.absorbed_mass.size() == m.x_t1.size();
    if (gathered.new_surface || m.x_t1.size() != nodes_before || !fits) {
      a.values.clear();
      report.mass_lost += absorbed_mass(a);
      m.absorbed_mass.clear();
    }
  }
  OILSKIN_ASSERT(m.id != 0 && m.delta > 0 && m.x_t0.size() == m.x_t1.size());
  m.slip = a.settings.slip;
  m.slip_back = a.settings.slip_back;
  m.smooth = a.settings.smooth;
  return {};
}

void Attachments::scatter(const ActiveSurfaces& active, StepReport& report) {
  std::vector<Vec3> certified;
  for (Attachment* a : active.attachment) {
    SurfaceMotion& m = a->motion;
    OILSKIN_ASSERT(m.impulse.size() == m.x_t1.size() && m.moved.size() == m.x_t1.size());
    certified = m.x_t1;
    a->host->scatter(m);
    OILSKIN_ASSERT(m.x_t1.size() == certified.size());
    if (m.x_t1 != certified) {
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
  return {a.motion.triangles, x, a.motion.delta, &a.geometry.tree};
}

}  // namespace

std::vector<StandingSurface> Attachments::between_steps(const FluidSettings& fluid) const {
  std::vector<StandingSurface> standing;
  for (const auto& a : list_)
    if (!a->refused && can_collide(fluid, a->settings)) standing.push_back(standing_at(a->motion.x_t1, *a));
  return standing;
}

void Attachments::checkpoint() {
  saved_next_id_ = next_id_;
  saved_.resize(list_.size());
  for (std::size_t k = 0; k < list_.size(); ++k) {
    const Attachment& a = *list_[k];
    saved_[k].motion = a.motion;
    saved_[k].mean_load = a.mean_load;
    saved_[k].values = a.values;
    saved_[k].is_new = a.is_new;
    saved_[k].teleported = a.teleported;
    saved_[k].refused = a.refused;
  }
}

void Attachments::roll_back() noexcept {
  OILSKIN_ASSERT(saved_.size() == list_.size());
  next_id_ = saved_next_id_;
  for (std::size_t k = 0; k < list_.size(); ++k) {
    Attachment& a = *list_[k];
    std::swap(a.motion, saved_[k].motion);
    a.mean_load.swap(saved_[k].mean_load);
    a.values.swap(saved_[k].values);
    a.is_new = saved_[k].is_new;
    a.teleported = saved_[k].teleported;
    a.refused = saved_[k].refused;
    // Another mesh may get the id that the step gave to this one.
    if (a.geometry.id != a.motion.id) a.geometry.id = 0;
  }
}

const SurfaceMotion& Attachments::before(const Attachment& a) const {
  OILSKIN_ASSERT(saved_.size() == list_.size());
  std::size_t k = 0;
  while (list_[k].get() != &a) ++k;
  // A refused motion holds what its host gave: its lists may differ in length, its masses make no sense.
  return saved_[k].refused ? a.motion : saved_[k].motion;
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
