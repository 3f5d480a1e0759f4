#include "contact/candidates.h"

#include <algorithm>
#include <cmath>

#include "contact/reach.h"
#include "core/assert.h"

namespace oilskin::contact {

namespace {

constexpr std::size_t chunk = 512;  // a multiple of the size of groups
/// A surface of fewer triangles, or one with fewer particles in groups that are near, is not worth loops of
/// its own on several threads: such surfaces are the tasks of one loop.
constexpr std::size_t few_triangles = 1024, few_particles = 4096;

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

/// Empty if the particle does not collide with the surface.
Box CandidateSet::Surface::box_of_query(const Context& context, std::uint32_t particle) const {
  const double r = reach[context.liquid_of(particle)];
  return r < 0 ? Box() : swept_box(*context.particles, particle).inflated(r);
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

/// Calls f(surface, workers) for each: those that `is_small`, on several threads at once.
template <class IsSmall, class F>
void CandidateSet::for_surfaces(const Workers& workers, const IsSmall& is_small, const F& f) const {
  static const Workers caller(1);
  std::vector<std::uint32_t> small;
  for (std::uint32_t s = 0; s < surfaces_.size(); ++s)
    if (is_small(s)) small.push_back(s);
  workers.for_each(small.size(), 4, [&](std::size_t k) { f(small[k], caller); });
  for (std::uint32_t s = 0, k = 0; s < surfaces_.size(); ++s)
    if (k < small.size() && small[k] == s)
      ++k;
    else
      f(s, workers);
}

/// First `prepare`, then `query` of those that have near groups.
template <class Prepare, class Query>
void CandidateSet::for_near_surfaces(const Context& context, const Prepare& prepare, const Query& query) {
  for_surfaces(
      *context.workers,
      [&](std::uint32_t s) { return context.surfaces[s]->triangles.size() < few_triangles; }, prepare);
  for_surfaces(
      *context.workers, [&](std::uint32_t s) { return surfaces_[s].box.size() < few_particles; },
      [&](std::uint32_t s, const Workers& workers) {
        if (!surfaces_[s].box.empty()) query(s, workers);
      });
}

void CandidateSet::collect(Context& context) {
  OILSKIN_ASSERT(context.geometry.size() == context.surfaces.size());
  measure_groups(context);
  surfaces_.resize(context.surfaces.size());
  const auto prepare = [&](std::uint32_t s, const Workers& workers) {
    Surface& set = surfaces_[s];
    set.reach = query_reach(context, s);
    set.forget_clear();
    set.slot.clear();
    set.box.clear();
    set.begin.clear();
    set.count.clear();
    set.pool.clear();
    set.triangle_stamp.clear();
    set.read_epoch = set.tree_epoch = context.epoch;
    set.drift = 0;
    context.geometry[s]->use(context.settings->hierarchy);
    context.geometry[s]->fit(*context.surfaces[s], workers);
    find_near_groups(context, s, 0, workers);
  };
  for_near_surfaces(context, prepare, [&](std::uint32_t s, const Workers& workers) {
    surfaces_[s].moved.clear();
    query(context, s, find_stale(context, s, true, 0, workers), workers);
    surfaces_[s].pool_of_all = surfaces_[s].pool.size();
  });
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
bool CandidateSet::find_near_groups(const Context& context, std::uint32_t surface, double reach,
                                    const Workers& workers) {
  Surface& set = surfaces_[surface];
  if (is_clear_of_all(context, surface, reach)) return false;
  set.clear_of_group.resize(swept_.size());
  set.slot.resize(swept_.size(), none);
  std::vector<std::uint8_t> is_near(swept_.size(), 0);
  const proximity::SurfaceTree& tree = context.geometry[surface]->tree;
  const Box bounds = tree.bounds();
  const double widest = largest(set.reach);
  workers.for_each(swept_.size(), chunk / group_size, [&](std::size_t g) {
    Box& clear = set.clear_of_group[g];
    if (set.slot[g] != none || clear.contains(swept_[g].inflated(reach))) return;
    clear = swept_[g].inflated(widest);
    is_near[g] = clear.overlaps(bounds) && tree.overlaps(clear);
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
  std::vector<std::uint32_t> near;
  for (std::uint32_t s = 0; s < surfaces_.size(); ++s)
    if (!surfaces_[s].box.empty()) near.push_back(s);
  near_begin_.assign(1, 0);
  near_surface_.clear();
  for (std::size_t g = 0; g < swept_.size(); ++g) {
    for (const std::uint32_t s : near)
      if (surfaces_[s].slot[g] != none) near_surface_.push_back(s);
    near_begin_.push_back(static_cast<std::uint32_t>(near_surface_.size()));
  }
}

void CandidateSet::query(const Context& context, std::uint32_t surface,
                         const std::vector<std::uint32_t>& particles, const Workers& workers) {
  if (particles.empty()) return;
  Surface& set = surfaces_[surface];
  const SurfaceMotion& motion = *context.surfaces[surface];
  std::vector<Box> boxes(particles.size());
  workers.for_each(particles.size(), chunk, [&](std::size_t k) {
    const std::uint32_t p = particles[k];
    OILSKIN_ASSERT(!context.out_of_play[p]);
    boxes[k] = set.box[set.place(p)] = set.box_of_query(context, p);
  });
  context.geometry[surface]->tree.query(boxes, workers, set.scratch);
  OILSKIN_ASSERT(set.pool.size() + set.scratch.triangle.size() <= std::numeric_limits<std::uint32_t>::max());
  const auto base = static_cast<std::uint32_t>(set.pool.size());
  set.pool.resize(base + set.scratch.triangle.size());
  workers.for_each(particles.size(), chunk, [&](std::size_t k) {
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

/// Fits the tree again where triangles have left their boxes, and lists the boxes of those that have moved.
/// True where a query of all particles takes less time, or memory, than one of those near them.
bool CandidateSet::follow_triangles(const Context& context, std::uint32_t surface, const Workers& workers) {
  Surface& set = surfaces_[surface];
  const SurfaceMotion& motion = *context.surfaces[surface];
  set.moved.clear();
  const std::uint32_t stamp = context.surface_stamp[surface];
  if (stamp < set.read_epoch || stamp == 0 || !read_node_stamps(context, surface)) return false;
  OILSKIN_ASSERT(motion.still == 0);
  context.geometry[surface]->fit(motion, workers);
  set.moved = boxes_of_moved(context.geometry[surface]->tree, set.triangle_stamp, set.tree_epoch);
  set.tree_epoch = context.epoch + 1;
  set.drift = 0;
  set.forget_clear();
  const bool query_all =
      set.moved.size() > motion.triangles.size() / 8 || set.pool.size() > 4 * set.pool_of_all;
  if (query_all) {
    set.pool.clear();
    set.moved.clear();
  }
  return query_all;
}

/// The particles in play of groups that are near whose swept box, inflated by `reach`, is not within that of
/// their last query, whose last query a box of triangles that have moved overlaps, or all of them. Those out
/// of play have no candidates from now on. Those that had none and are off the bounds of the surface have
/// none without a query: in groups beside many small surfaces those are most of the particles.
std::vector<std::uint32_t> CandidateSet::find_stale(const Context& context, std::uint32_t surface, bool all,
                                                    double reach, const Workers& workers) {
  Surface& set = surfaces_[surface];
  const Box bounds = context.geometry[surface]->tree.bounds();
  const std::size_t n = context.particle_count();
  std::vector<std::vector<std::uint32_t>> part((n + chunk - 1) / chunk);
  workers.for_chunks(n, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    std::vector<Box> near;
    for (std::size_t first = begin; first < end; first += group_size) {
      if (set.slot[first / group_size] == none) continue;
      const auto stop = static_cast<std::uint32_t>(std::min(end, first + group_size));
      if (!set.moved.empty()) {
        Box queried;
        for (auto p = static_cast<std::uint32_t>(first); p < stop; ++p) queried.add(set.box[set.place(p)]);
        select_overlapping(set.moved, queried, near);
      }
      for (auto p = static_cast<std::uint32_t>(first); p < stop; ++p) {
        const std::size_t place = set.place(p);
        if (context.out_of_play[p]) {
          set.count[place] = 0;
          continue;
        }
        Box& box = set.box[place];
        const bool is_stale = all ||
                              (context.particle_stamp[p] > 0 &&
                               !box.contains(swept_box(*context.particles, p).inflated(reach))) ||
                              overlaps_any(near, box);
        if (!is_stale) continue;
        const Box next = set.box_of_query(context, p);
        if (set.count[place] == 0 && !next.overlaps(bounds)) {
          box = next;
          set.begin[place] = 0;  // the pool may have been cleared
        } else {
          part[c].push_back(p);
        }
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
  std::vector<std::uint8_t> query_all(surfaces_.size(), 0), has_near_groups(surfaces_.size(), 0);
  // Pairs farther apart than δ are no violations: for detection a swept box inflated by 2 δ is enough.
  const auto reach = [&](std::uint32_t s) {
    const SurfaceMotion& motion = *context.surfaces[s];
    return std::max(2 * motion.delta, margin * motion.thickness) + surfaces_[s].drift;
  };
  const auto prepare = [&](std::uint32_t s, const Workers& workers) {
    query_all[s] = follow_triangles(context, s, workers);
    has_near_groups[s] = find_near_groups(context, s, reach(s), workers);
  };
  std::vector<std::vector<std::uint32_t>> stale(surfaces_.size());
  for_near_surfaces(context, prepare, [&](std::uint32_t s, const Workers& workers) {
    stale[s] = find_stale(context, s, query_all[s] != 0, reach(s), workers);
    query(context, s, stale[s], workers);
    if (query_all[s]) surfaces_[s].pool_of_all = surfaces_[s].pool.size();
  });
  if (std::find(has_near_groups.begin(), has_near_groups.end(), 1) != has_near_groups.end())
    list_near_surfaces();
  std::vector<std::uint32_t> queried;
  for (const std::vector<std::uint32_t>& of_one : stale)
    queried.insert(queried.end(), of_one.begin(), of_one.end());
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
