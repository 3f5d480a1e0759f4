#include "contact/detection.h"

#include <algorithm>
#include <tuple>

#include "core/assert.h"

namespace oilskin::contact {

namespace {

constexpr std::size_t chunk = 256;

// Are the boxes of the whole paths disjoint? Comparisons of stored numbers alone, so the answer is exact, and
// disjoint boxes cannot meet.
bool swept_boxes_apart(const Quad& x0, const Quad& x1) {
  for (int k = 0; k < 3; ++k) {
    const double low = std::min({x0.a[k], x0.b[k], x0.c[k], x1.a[k], x1.b[k], x1.c[k]});
    const double high = std::max({x0.a[k], x0.b[k], x0.c[k], x1.a[k], x1.b[k], x1.c[k]});
    if (std::max(x0.p[k], x1.p[k]) < low || high < std::min(x0.p[k], x1.p[k])) return true;
  }
  return false;
}

// Tests one pair; true = bad. The end distance is judged at δ; beyond it is measured only where it can be the
// particle's least (for the report).
bool test_pair(const Context& context, const SurfaceMotion& s, const Quad& x0, const Quad& x1,
               CandidatePair& pair, double& least, BadPair& bad) {
  pair.end_distance = std::numeric_limits<double>::infinity();
  const double worth = std::max(near_reach(s.delta), std::min(s.thickness, least));
  if (squared_distance_to_box(x1) <= worth * worth) {
    const EndDistance d = end_distance(x1, s.delta);
    pair.end_distance = d.distance;
    least = std::min(least, d.distance);
    bad.near = d.near;
  }
  if (context.settings->ccd && !swept_boxes_apart(x0, x1)) {
    const ccd::Meeting m = meets(x0, x1);
    bad.meets = m.hit;
    OILSKIN_ASSERT(!m.hit || (m.time >= 0 && m.time <= 1));
    if (m.hit) bad.time = m.time;
  }
  return bad.near || bad.meets;
}

void detect_for_particle(const Context& context, CandidateSet& candidates, std::uint32_t p,
                         std::vector<BadPair>& out) {
  const std::uint32_t stamp = context.particle_stamp[p];
  double least = std::numeric_limits<double>::infinity();
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
      BadPair bad;
      bad.particle = p;
      bad.surface = s;
      OILSKIN_ASSERT(pair.triangle < motion.triangles.size() && pair.tested <= context.epoch);
      bad.triangle = pair.triangle;
      const bool is_bad = test_pair(context, motion, context.start(p, s, pair.triangle),
                                    context.end(p, s, pair.triangle), pair, least, bad);
      pair.tested = is_bad ? 0 : context.epoch;
      if (is_bad) out.push_back(bad);
    }
  }
}

}  // namespace

std::vector<BadPair> detect(Context& context, CandidateSet& candidates) {
  candidates.refresh(context);
  const std::size_t n = context.particle_count();
  std::vector<std::vector<BadPair>> part((n + chunk - 1) / chunk);
  context.workers->for_chunks(n, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    for (std::size_t p = begin; p < end; ++p)
      if (!context.out_of_play[p])
        detect_for_particle(context, candidates, static_cast<std::uint32_t>(p), part[c]);
  });
  std::vector<BadPair> bad;
  for (const auto& pairs : part) bad.insert(bad.end(), pairs.begin(), pairs.end());
  const Span<const std::uint64_t> id = context.particles->id;
  std::sort(bad.begin(), bad.end(), [&](const BadPair& a, const BadPair& b) {
    return std::make_tuple(a.time, id[a.particle], a.surface, a.triangle) <
           std::make_tuple(b.time, id[b.particle], b.surface, b.triangle);
  });
  OILSKIN_ASSERT(std::none_of(bad.begin(), bad.end(),
                              [&](const BadPair& b) { return context.out_of_play[b.particle] != 0; }));
  ++context.epoch;
  return bad;
}

}  // namespace oilskin::contact
