#include "contact/candidates.h"

#include <algorithm>
#include <cmath>

#include "contact/reach.h"
#include "core/assert.h"

namespace oilskin::contact {

namespace {

constexpr std::size_t chunk = 512;  // a multiple of the size of groups

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

void CandidateSet::measure_groups(const Context& context) {
  const std::size_t n = context.particle_count();
  swept_.resize((n + group_size - 1) / group_size);
  context.workers->for_each(swept_.size(), chunk / group_size, [&](std::size_t g) {
    Box box;
    for (std::size_t p = g * group_size; p < std::min(n, (g + 1) * group_size); ++p)
      if (!context.out_of_play[p]) box.add(swept_box(*context.particles, static_cast<std::uint32_t>(p)));
    swept_[g] = box;
  });
  swept_by_all_ = Box();
  for (const Box& box : swept_) swept_by_all_.add(box);
}

namespace {

/// Of the queries of each liquid; negative = it does not collide with the surface.
std::vector<double> query_reach(const Context& context, std::uint32_t surface) {
  const SurfaceMotion& motion = *context.surfaces[surface];
  std::vector<double> reach;
  for (const Liquid& liquid : context.liquids)
    reach.push_back(liquid.collides_with(surface) ? std::max(std::max(motion.thickness, 2 * motion.delta) +
                                                                 CandidateSet::prediction_margin(liquid),
                                                             wall_layer(liquid, motion))
                                                  : -1);
  OILSKIN_ASSERT(std::all_of(reach.begin(), reach.end(), [&](double r) {
    return r == -1 || (r > 2 * motion.delta && std::isfinite(r));
  }));
  return reach;
}

double largest(const std::vector<double>& reach) {
  return *std::max_element(reach.begin(), reach.end());
}

}  // namespace

void CandidateSet::collect(Context& context) {
  OILSKIN_ASSERT(context.geometry.size() == context.surfaces.size());
  measure_groups(context);
  surfaces_.resize(context.surfaces.size());
  for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
    Surface& set = surfaces_[s];
    set.reach = query_reach(context, s);
    set.forget_clear();
    set.slot.assign(swept_.size(), none);
    set.box.clear();
    set.begin.clear();
    set.count.clear();
    set.pool.clear();
    context.geometry[s]->use(context.settings->hierarchy);
    context.geometry[s]->fit(*context.surfaces[s], *context.workers);
    set.triangle_stamp.clear();
    set.read_epoch = set.tree_epoch = context.epoch;
    set.drift = 0;
    if (find_near_groups(context, s, 0)) query(context, s, find_stale(context, set, true, {}, 0));
    set.pool_of_all = set.pool.size();
  }
  list_near_surfaces();
}

/// Whether the surface is as far from all particles as from those of a group that is far.
bool CandidateSet::is_clear_of_all(const Context& context, std::uint32_t surface, double reach) {
  Surface& set = surfaces_[surface];
  if (largest(set.reach) < 0) return true;
  if (!set.box.empty()) return false;
  if (set.clear.contains(swept_by_all_.inflated(reach))) return true;
  set.clear = Box();
  const Box box = swept_by_all_.inflated(largest(set.reach));
  if (context.geometry[surface]->tree.overlaps(box)) return false;
  set.forget_clear();
  set.clear = box;
  return true;
}

/// Finds groups that were far and no longer are. True if there are any.
bool CandidateSet::find_near_groups(const Context& context, std::uint32_t surface, double reach) {
  Surface& set = surfaces_[surface];
  if (is_clear_of_all(context, surface, reach)) return false;
  set.clear_of_group.resize(swept_.size());
  std::vector<std::uint8_t> is_near(swept_.size(), 0);
  context.workers->for_each(swept_.size(), chunk / group_size, [&](std::size_t g) {
    Box& clear = set.clear_of_group[g];
    if (set.slot[g] != none || clear.contains(swept_[g].inflated(reach))) return;
    clear = swept_[g].inflated(largest(set.reach));
    is_near[g] = context.geometry[surface]->tree.overlaps(clear);
  });
  std::size_t groups = set.box.size() / group_size;
  const std::size_t before = groups;
  for (std::size_t g = 0; g < swept_.size(); ++g)
    if (is_near[g]) set.slot[g] = static_cast<std::uint32_t>(groups++);
  set.box.resize(groups * group_size);
  set.begin.resize(groups * group_size, 0);
  set.count.resize(groups * group_size, 0);
  return groups > before;
}

void CandidateSet::list_near_surfaces() {
  near_begin_.assign(1, 0);
  near_surface_.clear();
  for (std::size_t g = 0; g < swept_.size(); ++g) {
    for (std::uint32_t s = 0; s < surfaces_.size(); ++s)
      if (surfaces_[s].slot[g] != none) near_surface_.push_back(s);
    near_begin_.push_back(static_cast<std::uint32_t>(near_surface_.size()));
  }
}

void CandidateSet::query(Context& context, std::uint32_t surface,
                         const std::vector<std::uint32_t>& particles) {
  Surface& set = surfaces_[surface];
  const SurfaceMotion& motion = *context.surfaces[surface];
  boxes_.resize(particles.size());
  context.workers->for_each(particles.size(), chunk, [&](std::size_t k) {
    const std::uint32_t p = particles[k];
    OILSKIN_ASSERT(!context.out_of_play[p]);
    const double r = set.reach[context.liquid_of(p)];
    boxes_[k] = set.box[set.place(p)] = r < 0 ? Box{} : swept_box(*context.particles, p).inflated(r);
  });
  context.geometry[surface]->tree.query(boxes_, *context.workers, set.scratch);
  OILSKIN_ASSERT(set.pool.size() + set.scratch.triangle.size() <= std::numeric_limits<std::uint32_t>::max());
  const auto base = static_cast<std::uint32_t>(set.pool.size());
  set.pool.resize(base + set.scratch.triangle.size());
  context.workers->for_each(particles.size(), chunk, [&](std::size_t k) {
    const Span<const std::uint32_t> found = set.scratch.of(k);
    std::uint32_t at = base + set.scratch.begin[k];
    const std::size_t place = set.place(particles[k]);
    set.begin[place] = at;
    set.count[place] = static_cast<std::uint32_t>(found.size());
    OILSKIN_ASSERT(found.empty() || found[found.size() - 1] < motion.triangles.size());
    for (std::uint32_t t : found) set.pool[at++] = {t, 0, std::numeric_limits<double>::infinity()};
  });
}

namespace {

/// Copies those that overlap the box.
void select_overlapping(const std::vector<Box>& boxes, const Box& box, std::vector<Box>& selected) {
  selected.clear();
  for (const Box& b : boxes)
    if (b.overlaps(box)) selected.push_back(b);
}

bool overlaps_any(const std::vector<Box>& boxes, const Box& box) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const Box& b) { return b.overlaps(box); });
}

/// The swept boxes of the triangles that have moved since `epoch`. The tree fits.
std::vector<Box> boxes_of_moved(const proximity::SurfaceTree& tree, const std::vector<std::uint32_t>& stamp,
                                std::uint32_t epoch) {
  std::vector<Box> boxes;
  for (std::uint32_t t = 0; t < stamp.size(); ++t)
    if (stamp[t] >= epoch) boxes.push_back(tree.swept_box(t));
  return boxes;
}

/// The smallest margin of a query over what detection needs, of the liquids that collide [m].
double smallest_margin(const Context& context, std::uint32_t surface) {
  double margin = std::numeric_limits<double>::infinity();
  for (const Liquid& liquid : context.liquids)
    if (liquid.collides_with(surface)) margin = std::min(margin, CandidateSet::prediction_margin(liquid));
  return margin;
}

}  // namespace

/// Brings triangle_stamp up to date. True if a triangle has left its box in the tree by more than half of the
/// margin of the queries: then the tree is to be fitted.
bool CandidateSet::read_node_stamps(const Context& context, std::uint32_t surface) {
  Surface& set = surfaces_[surface];
  const SurfaceMotion& motion = *context.surfaces[surface];
  const std::vector<std::uint32_t>& stamp = context.node_stamp[surface];
  const proximity::SurfaceTree& tree = context.geometry[surface]->tree;
  set.triangle_stamp.resize(motion.triangles.size(), 0);
  set.drift = smallest_margin(context, surface) / 2;
  bool has_left = false;
  for (std::uint32_t t = 0; t < motion.triangles.size(); ++t) {
    const Triangle& nodes = motion.triangles[t];
    const std::uint32_t youngest = std::max({stamp[nodes[0]], stamp[nodes[1]], stamp[nodes[2]]});
    if (youngest < set.read_epoch) continue;
    set.triangle_stamp[t] = youngest;
    has_left = has_left || !tree.swept_box(t).inflated(set.drift).contains(
                               proximity::swept_box(nodes, motion.x_t0, motion.x_t1));
  }
  set.read_epoch = context.epoch + 1;
  return has_left;
}

/// The particles in play of groups that are near whose swept box, inflated by `reach`, is not within that of
/// their last query, whose last query one of the boxes `moved` overlaps, or all of them. Those out of play
/// have no candidates from now on.
std::vector<std::uint32_t> CandidateSet::find_stale(const Context& context, Surface& set, bool all,
                                                    const std::vector<Box>& moved, double reach) {
  const std::size_t n = context.particle_count();
  std::vector<std::vector<std::uint32_t>> part((n + chunk - 1) / chunk);
  context.workers->for_chunks(n, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    std::vector<Box> near;
    for (std::size_t first = begin; first < end; first += group_size) {
      if (set.slot[first / group_size] == none) continue;
      const auto stop = static_cast<std::uint32_t>(std::min(end, first + group_size));
      if (!moved.empty()) {
        Box queried;
        for (auto p = static_cast<std::uint32_t>(first); p < stop; ++p) queried.add(set.box[set.place(p)]);
        select_overlapping(moved, queried, near);
      }
      for (auto p = static_cast<std::uint32_t>(first); p < stop; ++p) {
        if (context.out_of_play[p]) {
          set.count[set.place(p)] = 0;
          continue;
        }
        const Box& box = set.box[set.place(p)];
        if (all ||
            (context.particle_stamp[p] > 0 &&
             !box.contains(swept_box(*context.particles, p).inflated(reach))) ||
            overlaps_any(near, box))
          part[c].push_back(p);
      }
    }
  });
  std::vector<std::uint32_t> stale;
  for (const std::vector<std::uint32_t>& p : part) stale.insert(stale.end(), p.begin(), p.end());
  return stale;
}

std::vector<std::uint32_t> CandidateSet::refresh(Context& context, double margin) {
  OILSKIN_ASSERT(surfaces_.size() == context.surfaces.size() && margin >= 0);
  measure_groups(context);
  std::vector<std::uint32_t> queried;
  bool has_near_groups = false;
  for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
    Surface& set = surfaces_[s];
    const SurfaceMotion& motion = *context.surfaces[s];
    const bool nodes_moved = context.surface_stamp[s] >= set.read_epoch && context.surface_stamp[s] > 0;
    bool query_all = false;
    std::vector<Box> moved;
    if (nodes_moved && read_node_stamps(context, s)) {
      OILSKIN_ASSERT(motion.still == 0);
      context.geometry[s]->fit(motion, *context.workers);
      moved = boxes_of_moved(context.geometry[s]->tree, set.triangle_stamp, set.tree_epoch);
      set.tree_epoch = context.epoch + 1;
      set.drift = 0;
      set.forget_clear();
      // Then a query of all particles takes less time, or memory.
      query_all = moved.size() > motion.triangles.size() / 8 || set.pool.size() > 4 * set.pool_of_all;
      if (query_all) {
        set.pool.clear();
        moved.clear();
      }
    }
    // Pairs farther apart than δ are no violations: for detection a swept box inflated by 2 δ is enough.
    const double reach = std::max(2 * motion.delta, margin * motion.thickness) + set.drift;
    has_near_groups |= find_near_groups(context, s, reach);
    if (set.box.empty()) continue;
    const std::vector<std::uint32_t> stale = find_stale(context, set, query_all, moved, reach);
    if (!stale.empty()) query(context, s, stale);
    if (query_all) set.pool_of_all = set.pool.size();
    queried.insert(queried.end(), stale.begin(), stale.end());
  }
  if (has_near_groups) list_near_surfaces();
  OILSKIN_ASSERT(std::all_of(queried.begin(), queried.end(),
                             [&](std::uint32_t p) { return context.out_of_play[p] == 0; }));
  std::sort(queried.begin(), queried.end());
  queried.erase(std::unique(queried.begin(), queried.end()), queried.end());
  return queried;
}

double CandidateSet::min_end_distance(const Context& context) const {
  struct Smallest {
    double distance = std::numeric_limits<double>::infinity();
    void operator+=(const Smallest& o) { distance = std::min(distance, o.distance); }
  };
  const auto smallest_of = [&](std::size_t begin, std::size_t end) {
    Smallest smallest;
    for (auto p = static_cast<std::uint32_t>(begin); p < end; ++p)
      if (!context.out_of_play[p])
        for (const std::uint32_t s : surfaces_near(p))
          for (const CandidatePair& pair : of(s, p)) smallest += {pair.end_distance};
    return smallest;
  };
  return context.workers->ordered_sum(context.particle_count(), chunk, Smallest(), smallest_of).distance;
}

std::uint64_t CandidateSet::size() const {
  std::uint64_t n = 0;
  for (const Surface& s : surfaces_)
    for (std::uint32_t c : s.count) n += c;
  return n;
}

}  // namespace oilskin::contact
