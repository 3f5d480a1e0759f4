#include "contact/contacts.h"

#include <algorithm>
#include <cmath>

#include "contact/features.h"
#include "contact/friction.h"
#include "contact/reach.h"
#include "core/assert.h"

namespace oilskin::contact {

namespace {

constexpr std::size_t chunk = 256;

Contact make_contact(const Context& context, std::uint32_t p, std::uint32_t surface, std::uint32_t triangle,
                     const PointTriangle& q, const ClosestPoint& c) {
  const SurfaceMotion& motion = *context.surfaces[surface];
  Contact r;
  r.particle = p;
  r.surface = surface;
  r.triangle = triangle;
  r.nodes = motion.triangles[triangle];
  r.weights = c.weights;
  r.distance = c.distance;
  r.normal = c.distance > 0 ? Vec3(c.offset / c.distance) : geometric_normal(q.a, q.b, q.c);
  const MeshTopology& topology = context.geometry[surface]->topology;
  r.feature = feature_key(topology, triangle, r.nodes, c.feature);
  const SurfaceSide f = side_of(topology, motion.triangles, motion.x_t0, triangle, c.feature, r.normal);
  OILSKIN_ASSERT(std::abs(r.weights[0] + r.weights[1] + r.weights[2] - 1) < 1e-12);
  OILSKIN_ASSERT(std::abs(r.normal.squaredNorm() - 1) < 1e-9);
  OILSKIN_ASSERT(f.share >= 0 && f.share < 1 + 1e-9);
  r.back = f.back;
  r.normal_alignment = f.share;
  return r;
}

// The largest way of a node of each surface.
std::vector<double> max_displacements(const Context& context) {
  std::vector<double> longest;
  for (const SurfaceMotion* s : context.surfaces) {
    double way2 = 0;
    for (std::size_t i = 0; i < s->x_t0.size(); ++i)
      way2 = std::max(way2, (s->x_t1[i] - s->x_t0[i]).squaredNorm());
    longest.push_back(std::sqrt(way2));
  }
  return longest;
}

void find_for_particle(const Context& context, const CandidateSet& candidates,
                       const std::vector<double>& longest, std::uint32_t p, std::vector<Contact>& out) {
  const ParticleMotion& particles = *context.particles;
  const double displacement =
      (particles.x_t1[p] - particles.x_t0[p]).norm() + 2 * CandidateSet::prediction_margin(particles);
  std::vector<std::uint64_t>
      vertices;  // of the surface, each judged once: thousands of triangles may share it
  for (std::uint32_t s = 0; s < context.surfaces.size(); ++s) {
    const SurfaceMotion& motion = *context.surfaces[s];
    // (C.4): beyond h + dx no contact acts, and none whose gap the motion cannot bring below h.
    const double acts = motion.thickness + std::min(particles.spacing, displacement + longest[s]);
    const double reach = std::max(acts, wall_layer(particles, motion));
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
  const double longest = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
  if (length > 1e-12 * longest * longest) return n / length;
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

void ContactSet::find(const Context& context, const CandidateSet& candidates) {
  const std::size_t n = context.particle_count();
  const std::vector<double> longest = max_displacements(context);
  std::vector<std::vector<Contact>> part((n + chunk - 1) / chunk);
  context.workers->for_chunks(n, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    for (std::size_t p = begin; p < end; ++p)
      if (!context.out_of_play[p])
        find_for_particle(context, candidates, longest, static_cast<std::uint32_t>(p), part[c]);
  });
  near_.clear();
  for (const auto& contacts : part) near_.insert(near_.end(), contacts.begin(), contacts.end());
  OILSKIN_ASSERT(std::is_sorted(near_.begin(), near_.end(),
                                [](const Contact& a, const Contact& b) { return a.particle < b.particle; }));
}

void ContactSet::update(const Context& context, const CandidateSet& candidates,
                        const std::vector<std::uint32_t>& particles) {
  if (particles.empty()) return;
  const std::vector<double> longest = max_displacements(context);
  std::vector<Contact> fresh;
  for (std::uint32_t p : particles)
    if (!context.out_of_play[p]) find_for_particle(context, candidates, longest, p, fresh);
  OILSKIN_ASSERT(std::is_sorted(particles.begin(), particles.end()));
  std::vector<Contact> merged;
  merged.reserve(near_.size() + fresh.size());
  const auto is_stale = [&](const Contact& r) {
    return std::binary_search(particles.begin(), particles.end(), r.particle);
  };
  near_.erase(std::remove_if(near_.begin(), near_.end(), is_stale), near_.end());
  std::merge(near_.begin(), near_.end(), fresh.begin(), fresh.end(), std::back_inserter(merged),
             [](const Contact& a, const Contact& b) { return a.particle < b.particle; });
  OILSKIN_ASSERT(merged.size() == near_.size() + fresh.size());
  near_.swap(merged);
}

double end_gap(const Context& context, const Contact& r) {
  OILSKIN_ASSERT(r.surface < context.surfaces.size() && r.particle < context.particle_count());
  const SurfaceMotion& s = *context.surfaces[r.surface];
  Vec3 foot = Vec3::Zero();
  for (int k = 0; k < 3; ++k) foot += r.weights[k] * s.x_t1[r.nodes[k]];
  return r.normal.dot(context.particles->x_t1[r.particle] - foot);
}

namespace {

// Does the way from a point come nearer than h to the triangle? The distance from a convex set is convex
// along a line, and grows by no more than the way does: far triangles of a hub take one look.
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

// At a border, and outside a fold, the plane through the foot is no sheet: what passes beside the triangles
// that share the feature is not stopped.
bool passes_beside(const Context& context, const Contact& r, double h) {
  constexpr double flat = 0.999;
  if (r.normal_alignment > flat) return false;
  const SurfaceMotion& s = *context.surfaces[r.surface];
  const ParticleMotion& particles = *context.particles;
  Vec3 displacement = particles.x_t1[r.particle] - particles.x_t0[r.particle];
  std::uint32_t u = UINT32_MAX, v = UINT32_MAX;  // of the feature
  for (int k = 0; k < 3; ++k) {
    if (r.weights[k] == 0) continue;
    displacement -= r.weights[k] * (s.x_t1[r.nodes[k]] - s.x_t0[r.nodes[k]]);
    (u == UINT32_MAX ? u : v) = r.nodes[k];
  }
  if (v == UINT32_MAX) v = u;
  for (std::uint32_t t : context.geometry[r.surface]->topology.triangles_of(u)) {
    const Triangle& nodes = s.triangles[t];
    if (std::find(nodes.begin(), nodes.end(), v) == nodes.end()) continue;
    if (comes_within(particles.x_t0[r.particle], displacement, s.x_t0[nodes[0]], s.x_t0[nodes[1]],
                     s.x_t0[nodes[2]], h))
      return false;
  }
  return true;
}

}  // namespace

bool comes_within_thickness(const Context& context, const Contact& r) {
  // (C.5), (C.6).
  const double h = context.surfaces[r.surface]->thickness;
  if (r.distance < h) return true;
  return context.settings->ccd && end_gap(context, r) < h && !passes_beside(context, r, h);
}

bool friction_may_act(const Context& context, const Contact& r) {
  const SurfaceMotion& s = *context.surfaces[r.surface];
  const SlipSettings& slip = s.slip_on(r.back);
  const double reach = friction_distance(*context.particles, s, slip);
  return slip.model == SlipModel::viscous_wall ? r.distance < reach : (reach > 0 && r.distance <= reach);
}

void ContactSet::select_active(const Context& context, std::vector<Contact>& active) const {
  active.clear();
  for (const Contact& r : near_)
    if (!context.out_of_play[r.particle] &&
        (comes_within_thickness(context, r) || friction_may_act(context, r)))
      active.push_back(r);
}

}  // namespace oilskin::contact
