#include "contact/records.h"

#include <algorithm>
#include <cmath>

#include "contact/slip.h"

namespace oilskin::contact {

namespace {

constexpr std::size_t chunk = 256;

ContactRecord make_record(const Context& context, std::uint32_t p, std::uint32_t surface,
                          std::uint32_t triangle, const Quad& q, const ClosestPoint& c) {
  const SurfaceMotion& motion = *context.surfaces[surface];
  ContactRecord r;
  r.particle = p;
  r.surface = surface;
  r.triangle = triangle;
  r.nodes = motion.triangles[triangle];
  r.weights = c.weights;
  r.distance = c.distance;
  r.normal = c.distance > 0 ? Vec3(c.offset / c.distance) : geometric_normal(q.a, q.b, q.c);
  const Topology& topology = context.caches[surface]->topology;
  r.feature = topology.feature_key(triangle, r.nodes, c.feature);
  const Facing f = facing(topology, motion.triangles, motion.x_t0, triangle, c.feature, r.normal);
  r.back = f.back;
  r.facing = f.share;
  return r;
}

// The largest way of a node of each surface.
std::vector<double> longest_ways(const Context& context) {
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
                       const std::vector<double>& longest, std::uint32_t p, std::vector<ContactRecord>& out) {
  const ParticleMotion& particles = *context.particles;
  const double way = (particles.x_t1[p] - particles.x_t0[p]).norm() + 2 * CandidateSet::slack(particles);
  for (std::uint32_t s = 0; s < context.surfaces.size(); ++s) {
    const SurfaceMotion& motion = *context.surfaces[s];
    // Beyond h + dx no record acts, and none whose gap the ways of both sides cannot bring below h.
    const double acts = motion.thickness + std::min(particles.spacing, way + longest[s]);
    const double reach = std::max(acts, wall_layer(particles, motion));
    const std::size_t first = out.size();
    for (const CandidatePair& pair : candidates.of(s, p)) {
      const Quad q = context.start(p, s, pair.triangle);
      if (squared_distance_to_box(q) >= reach * reach) continue;
      const ClosestPoint c = closest_point(q.p, q.a, q.b, q.c);
      if (c.distance >= reach) continue;
      const Topology& topology = context.caches[s]->topology;
      if (!topology.is_local_minimum(motion.triangles, motion.x_t0, motion.triangles[pair.triangle], c))
        continue;
      ContactRecord r = make_record(context, p, s, pair.triangle, q, c);
      const bool duplicate = std::any_of(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(),
                                         [&](const ContactRecord& o) { return o.feature == r.feature; });
      if (!duplicate) out.push_back(r);
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

void RecordSet::find(const Context& context, const CandidateSet& candidates) {
  const std::size_t n = context.particle_count();
  const std::vector<double> longest = longest_ways(context);
  std::vector<std::vector<ContactRecord>> part((n + chunk - 1) / chunk);
  context.workers->for_chunks(n, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    for (std::size_t p = begin; p < end; ++p)
      if (!context.out_of_play[p])
        find_for_particle(context, candidates, longest, static_cast<std::uint32_t>(p), part[c]);
  });
  near_.clear();
  for (const auto& records : part) near_.insert(near_.end(), records.begin(), records.end());
}

void RecordSet::update(const Context& context, const CandidateSet& candidates,
                       const std::vector<std::uint32_t>& particles) {
  if (particles.empty()) return;
  const std::vector<double> longest = longest_ways(context);
  std::vector<ContactRecord> fresh;
  for (std::uint32_t p : particles)
    if (!context.out_of_play[p]) find_for_particle(context, candidates, longest, p, fresh);
  std::vector<ContactRecord> merged;
  merged.reserve(near_.size() + fresh.size());
  const auto is_stale = [&](const ContactRecord& r) {
    return std::binary_search(particles.begin(), particles.end(), r.particle);
  };
  near_.erase(std::remove_if(near_.begin(), near_.end(), is_stale), near_.end());
  std::merge(near_.begin(), near_.end(), fresh.begin(), fresh.end(), std::back_inserter(merged),
             [](const ContactRecord& a, const ContactRecord& b) { return a.particle < b.particle; });
  near_.swap(merged);
}

double end_gap(const Context& context, const ContactRecord& r) {
  const SurfaceMotion& s = *context.surfaces[r.surface];
  Vec3 foot = Vec3::Zero();
  for (int k = 0; k < 3; ++k) foot += r.weights[k] * s.x_t1[r.nodes[k]];
  return r.normal.dot(context.particles->x_t1[r.particle] - foot);
}

bool undercuts_thickness(const Context& context, const ContactRecord& r) {
  // d0 + n·(D_p − Σ w_i D_i) is the end gap along n, because d0 = n·(x0_p − Σ w_i x0_i).
  const double h = context.surfaces[r.surface]->thickness;
  return r.distance < h || (context.settings->ccd && end_gap(context, r) < h);
}

bool may_slip(const Context& context, const ContactRecord& r) {
  const SurfaceMotion& s = *context.surfaces[r.surface];
  const SlipSettings& slip = s.slip_on(r.back);
  const double reach = slip_reach(*context.particles, s, slip);
  return slip.model == SlipModel::viscous_wall ? r.distance < reach : (reach > 0 && r.distance <= reach);
}

void RecordSet::select_active(const Context& context, std::vector<ContactRecord>& active) const {
  active.clear();
  for (const ContactRecord& r : near_)
    if (!context.out_of_play[r.particle] && (undercuts_thickness(context, r) || may_slip(context, r)))
      active.push_back(r);
}

}  // namespace oilskin::contact
