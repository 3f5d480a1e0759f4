#include "contact/candidates.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "contact/reach.h"
#include "core/assert.h"

namespace oilskin::contact {

namespace {

constexpr std::size_t chunk = 512;

Box swept_box(const ParticleMotion& particles, std::uint32_t p) {
  Box box;
  box.add(particles.x_t0[p]);
  box.add(particles.x_t1[p]);
  return box;
}

}  // namespace

// Covers what pressure and impulses usually add to the predicted displacement.
double CandidateSet::prediction_margin(const Liquid& liquid) {
  return 0.2 * liquid.spacing;
}

void CandidateSet::collect(Context& context) {
  const std::size_t n = context.particle_count();
  OILSKIN_ASSERT(context.geometry.size() == context.surfaces.size());
  surfaces_.resize(context.surfaces.size());
  std::vector<std::uint32_t> all(n);
  std::iota(all.begin(), all.end(), 0u);
  for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
    Surface& set = surfaces_[s];
    set.box.resize(n);  // query() writes all
    set.begin.resize(n);
    set.count.resize(n);
    set.pool.clear();
    context.geometry[s]->use(context.settings->hierarchy);
    context.geometry[s]->fit(*context.surfaces[s]);
    set.tree_epoch = context.epoch;
    query(context, s, all);
  }
}

void CandidateSet::query(Context& context, std::uint32_t surface,
                         const std::vector<std::uint32_t>& particles) {
  Surface& set = surfaces_[surface];
  const SurfaceMotion& motion = *context.surfaces[surface];
  std::vector<double> reach;  // of each liquid; negative = it does not collide with the surface
  for (const Liquid& liquid : context.liquids)
    reach.push_back(liquid.collides_with(surface)
                        ? std::max(std::max(motion.thickness, 2 * motion.delta) + prediction_margin(liquid),
                                   wall_layer(liquid, motion))
                        : -1);
  context.workers->for_each(particles.size(), chunk, [&](std::size_t k) {
    const std::uint32_t p = particles[k];
    const double r = reach[context.liquid_of(p)];
    set.box[p] = context.out_of_play[p] || r < 0 ? Box{} : swept_box(*context.particles, p).inflated(r);
  });
  const bool all = particles.size() == set.box.size();  // in their order
  if (!all) {
    boxes_.resize(particles.size());
    for (std::size_t k = 0; k < particles.size(); ++k) boxes_[k] = set.box[particles[k]];
  }
  context.geometry[surface]->tree.query(all ? set.box : boxes_, *context.workers, set.scratch);
  OILSKIN_ASSERT(std::all_of(reach.begin(), reach.end(), [&](double r) {
    return r == -1 || (r > 2 * motion.delta && std::isfinite(r));
  }));
  OILSKIN_ASSERT(set.pool.size() + set.scratch.triangle.size() <= std::numeric_limits<std::uint32_t>::max());
  const auto base = static_cast<std::uint32_t>(set.pool.size());
  set.pool.resize(base + set.scratch.triangle.size());
  context.workers->for_each(particles.size(), chunk, [&](std::size_t k) {
    const Span<const std::uint32_t> found = set.scratch.of(k);
    std::uint32_t at = base + set.scratch.begin[k];
    set.begin[particles[k]] = at;
    set.count[particles[k]] = static_cast<std::uint32_t>(found.size());
    OILSKIN_ASSERT(found.empty() || found[found.size() - 1] < motion.triangles.size());
    for (std::uint32_t t : found) set.pool[at++] = {t, 0, std::numeric_limits<double>::infinity()};
  });
}

/// The particles in play whose swept box, inflated by `reach`, is not within that of their last query, or all
/// of them. Those out of play have no candidates from now on.
std::vector<std::uint32_t> CandidateSet::find_stale(const Context& context, Surface& set, bool all,
                                                    double reach) {
  const std::size_t n = context.particle_count();
  std::vector<std::vector<std::uint32_t>> part((n + chunk - 1) / chunk);
  context.workers->for_chunks(n, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    for (auto p = static_cast<std::uint32_t>(begin); p < end; ++p) {
      if (context.out_of_play[p])
        set.count[p] = 0;
      else if (all || (context.particle_stamp[p] > 0 &&
                       !set.box[p].contains(swept_box(*context.particles, p).inflated(reach))))
        part[c].push_back(p);
    }
  });
  std::vector<std::uint32_t> stale;
  for (const std::vector<std::uint32_t>& p : part) stale.insert(stale.end(), p.begin(), p.end());
  return stale;
}

std::vector<std::uint32_t> CandidateSet::refresh(Context& context, double margin) {
  OILSKIN_ASSERT(surfaces_.size() == context.surfaces.size() && margin >= 0);
  std::vector<std::uint32_t> queried;
  for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
    Surface& set = surfaces_[s];
    const SurfaceMotion& motion = *context.surfaces[s];
    const bool nodes_moved = context.surface_stamp[s] >= set.tree_epoch && context.surface_stamp[s] > 0;
    if (nodes_moved) {
      OILSKIN_ASSERT(motion.still == 0);
      context.geometry[s]->fit(motion);
      set.tree_epoch = context.epoch + 1;
      set.pool.clear();
    }
    // Pairs farther apart than δ are no violations: for detection a swept box inflated by 2 δ is enough.
    const double reach = std::max(2 * motion.delta, margin * motion.thickness);
    const std::vector<std::uint32_t> stale = find_stale(context, set, nodes_moved, reach);
    if (!stale.empty()) query(context, s, stale);
    queried.insert(queried.end(), stale.begin(), stale.end());
  }
  OILSKIN_ASSERT(std::all_of(queried.begin(), queried.end(),
                             [&](std::uint32_t p) { return context.out_of_play[p] == 0; }));
  std::sort(queried.begin(), queried.end());
  queried.erase(std::unique(queried.begin(), queried.end()), queried.end());
  return queried;
}

double CandidateSet::min_end_distance(const Context& context) const {
  double minimum = std::numeric_limits<double>::infinity();
  for (std::uint32_t s = 0; s < surfaces_.size(); ++s)
    for (std::uint32_t p = 0; p < context.particle_count(); ++p)
      if (!context.out_of_play[p])
        for (const CandidatePair& pair : of(s, p)) minimum = std::min(minimum, pair.end_distance);
  return minimum;
}

std::uint64_t CandidateSet::size() const {
  std::uint64_t n = 0;
  for (const Surface& s : surfaces_)
    for (std::uint32_t c : s.count) n += c;
  return n;
}

}  // namespace oilskin::contact
