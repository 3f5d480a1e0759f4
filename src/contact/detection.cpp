#include "contact/detection.h"

#include <algorithm>
#include <tuple>

#include "core/assert.h"

namespace oilskin::contact {

namespace {

constexpr std::size_t chunk = 256;

// Are the boxes of the whole paths disjoint? Comparisons of stored numbers alone, so the answer is exact, and
// disjoint boxes cannot meet.
bool swept_boxes_apart(const PointTriangle& x0, const PointTriangle& x1) {
  for (int k = 0; k < 3; ++k) {
    const double low = std::min({x0.a[k], x0.b[k], x0.c[k], x1.a[k], x1.b[k], x1.c[k]});
    const double high = std::max({x0.a[k], x0.b[k], x0.c[k], x1.a[k], x1.b[k], x1.c[k]});
    if (std::max(x0.p[k], x1.p[k]) < low || high < std::min(x0.p[k], x1.p[k])) return true;
  }
  return false;
}

// Tests one pair; true = bad. The end distance is judged at δ; beyond it is measured only where it can be the
// particle's least (for the report).
bool test_pair(const Context& context, const SurfaceMotion& s, const PointTriangle& x0,
               const PointTriangle& x1, CandidatePair& pair, double& minimum, Violation& violation) {
  pair.end_distance = std::numeric_limits<double>::infinity();
  const double relevant_distance = std::max(too_close_cutoff(s.delta), std::min(s.thickness, minimum));
  if (squared_distance_to_box(x1) <= relevant_distance * relevant_distance) {
    const EndDistance d = end_distance(x1, s.delta);
    pair.end_distance = d.distance;
    minimum = std::min(minimum, d.distance);
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
  double minimum = std::numeric_limits<double>::infinity();
  for (std::uint32_t s = 0; s < context.surfaces.size(); ++s) {
    const SurfaceMotion& motion = *context.surfaces[s];
    for (CandidatePair& pair : candidates.of(s, p)) {
      const Triangle& t = motion.triangles[pair.triangle];
      if (pair.tested > 0) {
        std::uint32_t youngest = stamp;
        if (context.surface_stamp[s] > pair.tested)
          for (std::uint32_t v : t) youngest = std::max(youngest, context.node_stamp[s][v]);
        if (youngest <= pair.tested) continue;
      }
      Violation violation;
      violation.particle = p;
      violation.surface = s;
      OILSKIN_ASSERT(pair.triangle < motion.triangles.size() && pair.tested <= context.epoch);
      violation.triangle = pair.triangle;
      const bool is_violation = test_pair(context, motion, context.start(p, s, pair.triangle),
                                          context.end(p, s, pair.triangle), pair, minimum, violation);
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
                              [&](const Violation& b) { return context.out_of_play[b.particle] != 0; }));
  ++context.epoch;
  return violations;
}

}  // namespace oilskin::contact
