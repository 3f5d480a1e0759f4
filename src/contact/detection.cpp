#include "contact/detection.h"

#include <algorithm>
#include <tuple>

#include "core/assert.h"

namespace oilskin::contact {

namespace {

constexpr std::size_t chunk = 256;

// Are the boxes of the paths disjoint? Exact, since it only compares stored numbers.
bool swept_boxes_apart(const PointTriangle& x0, const PointTriangle& x1) {
  for (int k = 0; k < 3; ++k) {
    const double low = std::min({x0.a[k], x0.b[k], x0.c[k], x1.a[k], x1.b[k], x1.c[k]});
    const double high = std::max({x0.a[k], x0.b[k], x0.c[k], x1.a[k], x1.b[k], x1.c[k]});
    if (std::max(x0.p[k], x1.p[k]) < low || high < std::min(x0.p[k], x1.p[k])) return true;
  }
  return false;
}

// Tests one pair; true = violation. Beyond too_close_cutoff(δ) the end distance is computed only where it can
// be the particle's smallest, `min_distance`, which is reported.
bool test_pair(const Context& context, const SurfaceMotion& s, const PointTriangle& x0,
               const PointTriangle& x1, CandidatePair& pair, double& min_distance, Violation& violation) {
  pair.end_distance = std::numeric_limits<double>::infinity();
  const double relevant_distance = std::max(too_close_cutoff(s.delta), std::min(s.thickness, min_distance));
  if (squared_distance_to_box(x1) <= relevant_distance * relevant_distance) {
    const EndDistance d = end_distance(x1, s.delta);
    pair.end_distance = d.distance;
    min_distance = std::min(min_distance, d.distance);
    violation.too_close = d.too_close;
  }
  if (context.settings->ccd && !swept_boxes_apart(x0, x1)) {
    const ccd::Impact m = paths_intersect(x0, x1);
    violation.paths_intersect = m.hit;
    OILSKIN_ASSERT(!m.hit || (m.time >= 0 && m.time <= 1));
    if (m.hit) violation.time = m.time;
  }
  return violation.too_close || violation.paths_intersect;
}

void detect_for_particle(const Context& context, CandidateSet& candidates, std::uint32_t p,
                         std::vector<Violation>& out) {
  const std::uint32_t stamp = context.particle_stamp[p];
  double min_distance = std::numeric_limits<double>::infinity();
  for (const std::uint32_t s : candidates.surfaces_near(p)) {
    const SurfaceMotion& motion = *context.surfaces[s];
    for (CandidatePair& pair : candidates.of(s, p)) {
      const std::uint32_t last_change = std::max(stamp, candidates.last_move(s, pair.triangle));
      if (pair.tested > 0 && last_change <= pair.tested) continue;
      Violation violation;
      violation.particle = p;
      violation.surface = s;
      OILSKIN_ASSERT(pair.triangle < motion.triangles.size() && pair.tested <= context.epoch);
      violation.triangle = pair.triangle;
      const bool is_violation = test_pair(context, motion, context.start(p, s, pair.triangle),
                                          context.end(p, s, pair.triangle), pair, min_distance, violation);
      pair.tested = is_violation ? 0 : context.epoch;
      if (is_violation) out.push_back(violation);
    }
  }
}

}  // namespace

std::vector<Violation> find_violations(Context& context, CandidateSet& candidates) {
  candidates.refresh(context);
  const std::size_t n = context.particle_count();
  std::vector<std::vector<Violation>> part((n + chunk - 1) / chunk);
  context.workers->for_chunks(n, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    for (std::size_t p = begin; p < end; ++p)
      if (!context.out_of_play[p])
        detect_for_particle(context, candidates, static_cast<std::uint32_t>(p), part[c]);
  });
  std::vector<Violation> violations;
  for (const auto& pairs : part) violations.insert(violations.end(), pairs.begin(), pairs.end());
  const Span<const std::uint64_t> id = context.particles->id;
  std::sort(violations.begin(), violations.end(), [&](const Violation& a, const Violation& b) {
    return std::make_tuple(a.time, id[a.particle], a.surface, a.triangle) <
           std::make_tuple(b.time, id[b.particle], b.surface, b.triangle);
  });
  OILSKIN_ASSERT(std::none_of(violations.begin(), violations.end(),
                              [&](const Violation& v) { return context.out_of_play[v.particle] != 0; }));
  ++context.epoch;
  return violations;
}

}  // namespace oilskin::contact
