#include "contact/contacts.h"

#include <algorithm>
#include <cmath>

#include "contact/features.h"
#include "contact/friction.h"
#include "contact/reach.h"
#include "core/assert.h"
#include "core/chunks.h"

namespace oilskin::contact {

namespace {

constexpr std::size_t chunk = 256, node_chunk = 1024;

Contact make_contact(const Context& context, std::uint32_t p, std::uint32_t surface, std::uint32_t triangle,
                     const PointTriangle& q, const ClosestPoint& c) {
  const SurfaceMotion& motion = *context.surfaces[surface];
  Contact contact;
  contact.particle = p;
  contact.surface = surface;
  contact.triangle = triangle;
  contact.nodes = motion.triangles[triangle];
  contact.weights = c.weights;
  contact.distance = c.distance;
  contact.normal = c.distance > 0 ? Vec3(c.offset / c.distance) : geometric_normal(q.a, q.b, q.c);
  const MeshTopology& topology = context.geometry[surface]->topology;
  contact.feature = feature_key(topology, triangle, contact.nodes, c.feature);
  const SurfaceSide side =
      side_of(topology, motion.triangles, motion.x_t0, triangle, c.feature, contact.normal);
  OILSKIN_ASSERT(std::abs(contact.weights[0] + contact.weights[1] + contact.weights[2] - 1) < 1e-12);
  OILSKIN_ASSERT(std::abs(contact.normal.squaredNorm() - 1) < 1e-9);
  OILSKIN_ASSERT(side.normal_alignment >= 0 && side.normal_alignment < 1 + 1e-9);
  contact.back = side.back;
  contact.normal_alignment = side.normal_alignment;
  return contact;
}

// The largest displacement of a node, per surface [m].
std::vector<double> max_displacements(const Context& context) {
  std::vector<double> result;
  for (const SurfaceMotion* s : context.surfaces) {
    const auto largest_of = [&](std::size_t begin, std::size_t end) {
      Largest largest;
      for (std::size_t i = begin; i < end; ++i) largest += {(s->x_t1[i] - s->x_t0[i]).squaredNorm()};
      return largest;
    };
    const std::size_t moved = s->still == 0 ? s->x_t0.size() : 0;
    result.push_back(std::sqrt(context.workers->ordered_sum(moved, node_chunk, Largest(), largest_of).value));
  }
  return result;
}

void find_for_particle(const Context& context, const CandidateSet& candidates,
                       const std::vector<double>& max_displacement, std::uint32_t p,
                       std::vector<Contact>& out) {
  const ParticleMotion& particles = *context.particles;
  const Liquid& liquid = context.liquid(p);
  const double displacement =
      (particles.x_t1[p] - particles.x_t0[p]).norm() + 2 * CandidateSet::prediction_margin(liquid);
  // Vertices of the surface that have been tested; thousands of triangles may share one.
  std::vector<std::uint64_t> vertices;
  for (const std::uint32_t s : candidates.surfaces_near(p)) {
    const SurfaceMotion& motion = *context.surfaces[s];
    // (C.4): contacts beyond h + dx do not act, nor do those whose gap the motion cannot reduce below h.
    const double radius = motion.thickness + std::min(liquid.spacing, displacement + max_displacement[s]);
    const double reach = std::max(radius, wall_layer(liquid, motion));
    const std::size_t first = out.size();
    vertices.clear();
    for (const CandidatePair& pair : candidates.of(s, p)) {
      const PointTriangle q = context.start(p, s, pair.triangle);
      if (squared_distance_to_box(q) >= reach * reach) continue;
      const ClosestPoint c = closest_point(q.p, q.a, q.b, q.c);
      if (c.distance >= reach) continue;
      const MeshTopology& topology = context.geometry[s]->topology;
      const std::uint64_t feature =
          feature_key(topology, pair.triangle, motion.triangles[pair.triangle], c.feature);
      const bool is_vertex = (c.feature & (c.feature - 1)) == 0;
      if (is_vertex) {
        if (std::find(vertices.begin(), vertices.end(), feature) != vertices.end()) continue;
        vertices.push_back(feature);
      }
      if (!is_local_minimum(topology, motion.triangles, motion.x_t0, pair.triangle, c)) continue;
      const bool duplicate = std::any_of(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(),
                                         [&](const Contact& o) { return o.feature == feature; });
      if (!duplicate) out.push_back(make_contact(context, p, s, pair.triangle, q, c));
    }
  }
}

}  // namespace

Vec3 geometric_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double length = n.norm();
  const double longest_edge = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
  if (length > 1e-12 * longest_edge * longest_edge) return n / length;
  Vec3 along = b - a;
  if ((c - a).squaredNorm() > along.squaredNorm()) along = c - a;
  if (!(along.squaredNorm() > 0)) return Vec3::UnitX();
  along.normalize();
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis = Vec3::Unit(k) - along * along[k];
    if (axis.squaredNorm() > 0.25) return axis.normalized();
  }
  return Vec3::UnitX();  // not reached: some axis is at 45° or more to any direction
}

namespace {

/// Of particle(0) … particle(n − 1), in this order.
template <class Particles>
std::vector<Contact> find_for_particles(const Context& context, const CandidateSet& candidates, std::size_t n,
                                        const Particles& particle) {
  const std::vector<double> max_displacement = max_displacements(context);
  std::vector<std::vector<Contact>> part((n + chunk - 1) / chunk);
  context.workers->for_chunks(n, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    for (std::size_t k = begin; k < end; ++k)
      if (const std::uint32_t p = particle(k); !context.out_of_play[p])
        find_for_particle(context, candidates, max_displacement, p, part[c]);
  });
  std::vector<Contact> contacts;
  for (const auto& found : part) contacts.insert(contacts.end(), found.begin(), found.end());
  return contacts;
}

}  // namespace

void ContactSet::find(const Context& context, const CandidateSet& candidates) {
  contacts_ = find_for_particles(context, candidates, context.particle_count(),
                                 [](std::size_t k) { return static_cast<std::uint32_t>(k); });
  OILSKIN_ASSERT(std::is_sorted(contacts_.begin(), contacts_.end(),
                                [](const Contact& a, const Contact& b) { return a.particle < b.particle; }));
}

void ContactSet::update(const Context& context, const CandidateSet& candidates,
                        const std::vector<std::uint32_t>& particles) {
  if (particles.empty()) return;
  const std::vector<Contact> updated =
      find_for_particles(context, candidates, particles.size(), [&](std::size_t k) { return particles[k]; });
  OILSKIN_ASSERT(std::is_sorted(particles.begin(), particles.end()));
  std::vector<Contact> merged;
  merged.reserve(contacts_.size() + updated.size());
  const auto is_stale = [&](const Contact& c) {
    return std::binary_search(particles.begin(), particles.end(), c.particle);
  };
  contacts_.erase(std::remove_if(contacts_.begin(), contacts_.end(), is_stale), contacts_.end());
  std::merge(contacts_.begin(), contacts_.end(), updated.begin(), updated.end(), std::back_inserter(merged),
             [](const Contact& a, const Contact& b) { return a.particle < b.particle; });
  OILSKIN_ASSERT(merged.size() == contacts_.size() + updated.size());
  contacts_.swap(merged);
}

double end_gap(const Context& context, const Contact& contact) {
  OILSKIN_ASSERT(contact.surface < context.surfaces.size() && contact.particle < context.particle_count());
  const SurfaceMotion& s = *context.surfaces[contact.surface];
  Vec3 foot = Vec3::Zero();
  for (int k = 0; k < 3; ++k) foot += contact.weights[k] * s.x_t1[contact.nodes[k]];
  return contact.normal.dot(context.particles->x_t1[contact.particle] - foot);
}

namespace {

// Does the path `from` + t `displacement`, t in [0, 1], come closer than h to the triangle? The distance to a
// convex set is convex along a line, so a ternary search finds its minimum. It changes by at most the length
// of the path, so distant triangles take one iteration.
bool comes_within(const Vec3& from, const Vec3& displacement, const Vec3& a, const Vec3& b, const Vec3& c,
                  double h) {
  double low = 0, high = 1;
  const double length = displacement.norm();
  for (int k = 0; k < 40; ++k) {
    const double third = (high - low) / 3, s = low + third, t = high - third;
    const double at_s = closest_point(from + s * displacement, a, b, c).distance;
    const double at_t = closest_point(from + t * displacement, a, b, c).distance;
    if (std::min(at_s, at_t) < h) return true;
    if (std::min(at_s, at_t) - third * length > h) return false;
    (at_s < at_t ? high : low) = at_s < at_t ? t : s;
  }
  return false;
}

// At a border and outside a fold the plane through the closest point is not a sheet: a particle that passes
// beside the triangles at the feature is not stopped.
bool passes_beside(const Context& context, const Contact& contact, double h) {
  constexpr double flat = 0.999;
  if (contact.normal_alignment > flat) return false;
  const SurfaceMotion& s = *context.surfaces[contact.surface];
  const ParticleMotion& particles = *context.particles;
  Vec3 displacement = particles.x_t1[contact.particle] - particles.x_t0[contact.particle];
  std::uint32_t u = UINT32_MAX, v = UINT32_MAX;  // nodes of the feature
  for (int k = 0; k < 3; ++k) {
    if (contact.weights[k] == 0) continue;
    displacement -= contact.weights[k] * (s.x_t1[contact.nodes[k]] - s.x_t0[contact.nodes[k]]);
    (u == UINT32_MAX ? u : v) = contact.nodes[k];
  }
  if (v == UINT32_MAX) v = u;
  for (std::uint32_t t : context.geometry[contact.surface]->topology.triangles_of(u)) {
    const Triangle& nodes = s.triangles[t];
    if (std::find(nodes.begin(), nodes.end(), v) == nodes.end()) continue;
    if (comes_within(particles.x_t0[contact.particle], displacement, s.x_t0[nodes[0]], s.x_t0[nodes[1]],
                     s.x_t0[nodes[2]], h))
      return false;
  }
  return true;
}

}  // namespace

bool comes_within_thickness(const Context& context, const Contact& contact) {
  // (C.5), (C.6).
  const double h = context.surfaces[contact.surface]->thickness;
  if (contact.distance < h) return true;
  return context.settings->ccd && end_gap(context, contact) < h && !passes_beside(context, contact, h);
}

bool friction_may_act(const Context& context, const Contact& contact) {
  const SurfaceMotion& s = *context.surfaces[contact.surface];
  const SlipSettings& slip = s.slip_on(contact.back);
  const double reach = friction_distance(context.liquid(contact.particle), s, slip);
  return slip.model == SlipModel::viscous_wall ? contact.distance < reach
                                               : (reach > 0 && contact.distance <= reach);
}

void ContactSet::select_active(const Context& context, std::vector<Contact>& active) const {
  active.clear();
  for (const Contact& contact : contacts_)
    if (!context.out_of_play[contact.particle] &&
        (comes_within_thickness(context, contact) || friction_may_act(context, contact)))
      active.push_back(contact);
}

}  // namespace oilskin::contact
