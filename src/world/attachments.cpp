#include "world/attachments.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "contact/predicates.h"
#include "core/assert.h"
#include "core/inverse_mass.h"
#include "world/numeric_range.h"

namespace oilskin::world {

namespace {

template <class... Parts>
Status refuse(const Parts&... parts) {
  std::ostringstream s;
  (s << ... << parts);
  return Status::refused(s.str());
}

double max_coordinate(const Box& kill_box) {
  return std::max(kill_box.min.cwiseAbs().maxCoeff(), kill_box.max.cwiseAbs().maxCoeff());
}

Status check_mesh(const SurfaceMotion& m) {
  if (m.triangles.empty())
    return refuse("the surface has no triangles (faces); contact needs a triangle mesh");
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    for (std::uint32_t v : m.triangles[t])
      if (v >= m.x_t1.size())
        return refuse("triangle ", t, " names node ", v, "; the surface has ", m.x_t1.size(), " nodes (0 … ",
                      m.x_t1.size() - 1, ")");
  return {};
}

Status check_state(const SurfaceMotion& m) {
  const std::size_t n = m.x_t1.size();
  if (m.velocity.size() != n || m.inverse_mass.size() != n || (!m.holdable.empty() && m.holdable.size() != n))
    return refuse("the host gave ", n, " positions, ", m.velocity.size(), " velocities, ",
                  m.inverse_mass.size(), " inverse masses; they must be as many");
  for (std::size_t i = 0; i < n; ++i) {
    if (!m.x_t1[i].allFinite()) return refuse("the position of node ", i, " is not finite");
    if (!m.velocity[i].allFinite()) return refuse("the velocity of node ", i, " is not finite");
    if (!is_in_range(m.x_t1[i]) || !is_in_range(m.velocity[i]))
      return refuse("node ", i, " is farther or faster than 1e15; the host's simulation has exploded");
    if (!is_inverse_mass(m.inverse_mass[i]))
      return refuse("the inverse mass of node ", i, " is ", m.inverse_mass[i], "; it must be ",
                    inverse_mass_range);
    if (stored(m.x_t1[i], m.storage) != m.x_t1[i])
      return refuse("the position of node ", i, " is no number that its storage can hold");
  }
  return {};
}

Status set_delta(SurfaceMotion& m, const SurfaceSettings& settings, double r) {
  m.thickness = settings.thickness;
  m.slip = settings.slip;
  m.slip_back = settings.slip_back;
  m.delta = minimum_separation(settings.thickness, r, m.storage);
  if (settings.thickness >= 4 * m.delta) return {};
  const double per_metre = 4 * minimum_separation(0, 1, m.storage);
  return refuse("thickness is ", settings.thickness, " m, below 4 δ = ", 4 * m.delta,
                " m; with a kill box that reaches ", r, " m and ",
                m.storage == Storage::float32 ? "single" : "double", "-precision positions it must be ≥ ",
                per_metre * r, " m, or the kill box must reach no farther than ",
                settings.thickness / per_metre, " m");
}

}  // namespace

bool can_collide(const FluidSettings& fluid, const SurfaceSettings& surface) {
  return (fluid.collision_mask & surface.collision_group) != 0 &&
         (surface.collision_mask & fluid.collision_group) != 0;
}

Status Attachments::attach(SurfaceHost& host, const SurfaceSettings& settings, const WorldSettings& world,
                           std::uint64_t* handle) {
  // Of a thickness of zero the host's storage decides what would do: set_delta() says so.
  if (Status s = settings.validate(); !s.ok() && settings.thickness != 0) return s;
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
  a->motion.id = next_id_++;
  a->motion.x_t0 = a->motion.x_t1;
  a->handle = next_handle_++;
  OILSKIN_ASSERT(list_.empty() || list_.back()->handle < a->handle);
  OILSKIN_ASSERT(a->motion.delta > 0 && a->motion.thickness >= 4 * a->motion.delta);
  if (handle) *handle = a->handle;
  list_.push_back(std::move(a));
  return {};
}

std::uint64_t Attachments::detach(std::uint64_t handle) {
  for (auto it = list_.begin(); it != list_.end(); ++it) {
    if ((*it)->handle != handle) continue;
    const std::uint64_t id = (*it)->motion.id;
    list_.erase(it);
    return id;
  }
  return 0;
}

Attachment* Attachments::find(std::uint64_t handle) {
  for (auto& a : list_)
    if (a->handle == handle) return a.get();
  return nullptr;
}
const Attachment* Attachments::find(std::uint64_t handle) const {
  return const_cast<Attachments*>(this)->find(handle);
}

void Attachments::gather(double dt, const WorldSettings& world, const FluidSettings& fluid,
                         StepReport& report, std::vector<SurfaceMotion*>& active,
                         std::vector<std::uint64_t>& stale) {
  active.clear();
  for (auto& a : list_) {
    if (a->refused && !a->teleported) {
      report.flags |= flag_surface_refused;
      continue;
    }
    SurfaceMotion& m = a->motion;
    std::swap(m.x_t0, m.x_t1);
    const Gathered gathered = a->host->gather(dt, m);
    Status status = gathered.status;
    const bool is_new = gathered.new_surface || a->teleported || m.x_t1.size() != m.x_t0.size();
    if (status.ok() && is_new) status = check_mesh(m);
    if (status.ok()) status = check_state(m);
    if (status.ok() && is_new) status = set_delta(m, a->settings, max_coordinate(world.kill_box));
    a->refused = !status.ok();
    if (a->refused) {
      a->teleported = false;
      report.flags |= flag_surface_refused;
      report.messages.push_back("surface " + std::to_string(a->handle) + " is left out: " + status.message);
      continue;
    }
    if (is_new) {
      stale.push_back(m.id);
      m.id = next_id_++;
      m.x_t0 = m.x_t1;
      a->is_new = true;
      a->teleported = false;
    }
    OILSKIN_ASSERT(m.id != 0 && m.delta > 0 && m.x_t0.size() == m.x_t1.size());
    m.slip = a->settings.slip;
    m.slip_back = a->settings.slip_back;
    // Where prescribed nodes stand costs nothing: they are not rounded again (a floor may be larger than the
    // box).
    for (std::size_t i = 0; i < m.x_t1.size(); ++i)
      if (m.inverse_mass[i] > 0 && m.x_t1[i].cwiseAbs().maxCoeff() > max_coordinate(world.kill_box)) {
        report.flags |= flag_surface_out_of_range;
        break;
      }
    if (can_collide(fluid, a->settings)) active.push_back(&m);
  }
}

void Attachments::scatter(Span<SurfaceMotion* const> active, StepReport& report) {
  for (auto& a : list_) {
    SurfaceMotion& m = a->motion;
    if (std::find(active.begin(), active.end(), &m) == active.end()) continue;
    OILSKIN_ASSERT(m.impulse.size() == m.x_t1.size() && m.moved.size() == m.x_t1.size());
    a->certified = m.x_t1;
    a->host->scatter(m);
    OILSKIN_ASSERT(m.x_t1.size() == a->certified.size());
    if (m.x_t1 != a->certified) {
      // The certificate is about numbers that the host does not keep: what it does keep is a new beginning.
      report.flags |= flag_scatter_mismatch;
      a->teleported = true;
    }
  }
}

void Attachments::relocate_particles(Span<SurfaceMotion* const> active, fluid::Particles& particles,
                                     double particle_mass, std::uint64_t& next_id, const Workers& workers,
                                     StepReport& report) {
  OILSKIN_ASSERT(particle_mass > 0);
  std::vector<SurfaceMotion*> is_new;
  for (auto& a : list_) {
    if (!a->is_new || std::find(active.begin(), active.end(), &a->motion) == active.end()) continue;
    a->is_new = false;
    is_new.push_back(&a->motion);
  }
  if (is_new.empty() || particles.size() == 0) return;
  std::vector<std::uint8_t> too_near;
  ClearanceTest(is_new, workers).run(particles.position, too_near);
  const ClearanceTest clearance(active, workers);
  std::vector<std::uint8_t> keep(particles.size(), 1);
  for (std::size_t p = 0; p < particles.size(); ++p) {
    if (!too_near[p]) continue;
    ++report.contact.relocated;
    const Vec3& x = particles.position[p];
    ClosestPoint nearest;
    nearest.distance = std::numeric_limits<double>::infinity();
    double thickness = 0;
    for (const SurfaceMotion* s : is_new)
      for (const Triangle& t : s->triangles) {
        const ClosestPoint c = closest_point(x, s->x_t0[t[0]], s->x_t0[t[1]], s->x_t0[t[2]]);
        if (c.distance >= nearest.distance) continue;
        nearest = c;
        thickness = s->thickness;
      }
    bool clear = nearest.distance > 0;
    const Vec3 place = clear ? Vec3(x + nearest.offset / nearest.distance * thickness) : x;
    if (clear) {
      std::vector<std::uint8_t> blocked;
      clearance.run(Span<const Vec3>(&place, 1), blocked);
      clear = !blocked[0];
    }
    for (const SurfaceMotion* s : active) {
      if (!clear) break;
      for (const Triangle& t : s->triangles) {
        const Vec3 &a = s->x_t0[t[0]], &b = s->x_t0[t[1]], &c = s->x_t0[t[2]];
        if (contact::paths_intersect({x, a, b, c}, {place, a, b, c}).hit) {
          clear = false;
          break;
        }
      }
    }
    if (clear) {
      // The jump is no motion: a new id says so to whoever reads the trace.
      particles.position[p] = place;
      particles.id[p] = next_id++;
    } else {
      keep[p] = 0;
      ++report.removed;
      report.mass_removed += particle_mass;
      report.momentum_before += particle_mass * particles.velocity[p];
      report.momentum_removed += particle_mass * particles.velocity[p];
    }
  }
  particles.compress(keep);
}

void ClearanceTest::run(Span<const Vec3> points, std::vector<std::uint8_t>& blocked) const {
  blocked.assign(points.size(), 0);
  for (const SurfaceMotion* s : surfaces_) {
    OILSKIN_ASSERT(s->delta > 0 && !s->triangles.empty());
    const double reach = 2 * s->delta;
    Box bounds;
    for (const Vec3& x : s->x_t0) bounds.add(x);
    bounds = bounds.inflated(reach);
    std::vector<Box> boxes;
    std::vector<std::uint32_t> index;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      if (blocked[i] || !bounds.contains(points[i])) continue;
      boxes.push_back(Box{points[i], points[i]}.inflated(reach));
      index.push_back(i);
    }
    if (boxes.empty()) continue;
    proximity::SurfaceTree tree;
    tree.update(s->triangles, s->x_t0, s->x_t0);
    proximity::Candidates candidates;
    tree.query(boxes, workers_, candidates);
    OILSKIN_ASSERT(candidates.begin.size() == boxes.size() + 1);
    for (std::size_t k = 0; k < boxes.size(); ++k)
      for (std::uint32_t t : candidates.of(k)) {
        const Triangle& nodes = s->triangles[t];
        const contact::PointTriangle q{points[index[k]], s->x_t0[nodes[0]], s->x_t0[nodes[1]],
                                       s->x_t0[nodes[2]]};
        if (contact::end_distance(q, reach).too_close) blocked[index[k]] = 1;
      }
  }
}

}  // namespace oilskin::world
