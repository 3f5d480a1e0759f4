// The only file that includes FCL. It uses trees over axis-aligned boxes, which have no transform, updates
// them and reads them node by node. It uses none of FCL's collision tests.
#include "proximity/surface_tree.h"

#include <fcl/math/bv/utility.h>
// BVH_model.h needs the fitting functions of utility.h declared before it.
#include <fcl/geometry/bvh/BVH_model.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "core/assert.h"
#include "core/chunks.h"
#include "proximity/box_tree.h"

namespace oilskin::proximity {

namespace {

using Aabb = fcl::AABB<double>;
using Model = fcl::BVHModel<Aabb>;

/// Boxes that share a traversal, at most. Consecutive particles of a sorted fluid lie in a few cells.
constexpr std::size_t block_size = 16;
/// Leaves of mean size that the box of a block covers, at most; 8 to 24 take about the same time.
constexpr double leaves_of_block = 16;
/// Blocks per chunk of a thread, at least. Queries of a tree of few triangles are not worth a task.
constexpr std::size_t smallest_chunk = 2, smallest_chunk_of_small_tree = 64;
constexpr std::size_t small_tree = 256;
/// Triangles per chunk.
constexpr std::size_t triangle_chunk = 512;
/// A block that overlaps more triangles has triangles much smaller than the mean. Then a traversal per member
/// is faster than testing all triangles for each.
constexpr std::size_t block_limit = 48;
constexpr std::size_t no_limit = std::numeric_limits<std::size_t>::max();

constexpr double rebuild_growth = 2;

void check(int code, const char* what) {
  if (code != fcl::BVH_OK)
    throw std::runtime_error("oilskin: FCL refused to " + std::string(what) +
                             " a bounding-volume tree, code " + std::to_string(code));
}

/// fcl::AABB::overlap is not inlined, so this is faster.
bool overlap(const Aabb& a, const Box& b) {
  return a.min_[0] <= b.max[0] && b.min[0] <= a.max_[0] && a.min_[1] <= b.max[1] && b.min[1] <= a.max_[1] &&
         a.min_[2] <= b.max[2] && b.min[2] <= a.max_[2];
}

bool is_empty(const Box& b) {
  return !(b.min.array() <= b.max.array()).all();
}

bool same_triangles(Span<const Triangle> a, const std::vector<Triangle>& b) {
  // One call for all: comparing arrays of three is a call for each.
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Triangle)) == 0;
}

bool all_finite(Span<const Vec3> x) {
  return std::all_of(x.begin(), x.end(), [](const Vec3& p) { return p.allFinite(); });
}

bool all_in_range(Span<const Triangle> triangles, std::size_t nodes) {
  return std::all_of(triangles.begin(), triangles.end(),
                     [nodes](const Triangle& t) { return t[0] < nodes && t[1] < nodes && t[2] < nodes; });
}

/// Buffers of one thread.
struct Scratch {
  std::vector<std::int32_t> stack;
  std::vector<std::uint32_t> found;
};

}  // namespace

struct SurfaceTree::Impl {
  std::unique_ptr<Model> model;  ///< null without triangles
  BoxTree flat;                  ///< the same tree
  Hierarchy hierarchy = Hierarchy::flat;
  std::vector<Triangle> triangles;
  std::vector<Vec3> fitted_x_t0, fitted_x_t1;
  std::vector<Box> boxes;  ///< swept box of each triangle
  std::size_t builds = 0;
  double leaf_size_built = 0, tree_size_built = 0;

  void update(Span<const Triangle> tris, Span<const Vec3> x_t0, Span<const Vec3> x_t1, Hierarchy by,
              const Workers& workers);
  void clear();
  void build(Span<const Triangle> tris, Span<const Vec3> x_t1, const Workers& workers);
  void copy_structure(const Workers& workers);
  void refit(Span<const Vec3> x_t0, Span<const Vec3> x_t1, const Workers& workers);
  void refit_model();
  bool is_fitted_to(Span<const Vec3> x_t0, Span<const Vec3> x_t1) const;
  bool collect(const Box& box, std::size_t limit, Scratch& scratch) const;
  bool collect_from_model(const Box& box, std::size_t limit, Scratch& scratch) const;
  std::size_t size_of_block(Span<const Box> next) const;
  void query_block(Span<const Box> block, Scratch& scratch, std::uint32_t* counts,
                   std::vector<std::uint32_t>& triangles_out) const;
};

/// Always makes a new model, since FCL cannot rebuild one (it clears it and reports a wrong sequence of
/// calls). Uses one set of positions only, so a refit must follow for swept boxes.
void SurfaceTree::Impl::build(Span<const Triangle> tris, Span<const Vec3> x_t1, const Workers& workers) {
  triangles.assign(tris.begin(), tris.end());
  model = std::make_unique<Model>();
  boxes.assign(tris.size(), Box());
  ++builds;
  const std::vector<Vec3> points(x_t1.begin(), x_t1.end());
  std::vector<fcl::Triangle> faces;
  faces.reserve(tris.size());
  for (const Triangle& t : tris) faces.emplace_back(t[0], t[1], t[2]);
  check(model->beginModel(static_cast<int>(faces.size()), static_cast<int>(points.size())), "begin");
  check(model->addSubModel(points, faces), "fill");
  check(model->endModel(), "build");
  copy_structure(workers);
}

void SurfaceTree::Impl::copy_structure(const Workers& workers) {
  std::vector<BoxTree::Link> links(static_cast<std::size_t>(model->getNumBVs()));
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto& node = static_cast<const Model&>(*model).getBV(static_cast<int>(i));
    OILSKIN_ASSERT(node.isLeaf() || node.rightChild() == node.leftChild() + 1);
    OILSKIN_ASSERT(!node.isLeaf() || static_cast<std::size_t>(node.primitiveId()) < boxes.size());
    links[i].child = node.isLeaf() ? -1 - node.primitiveId() : node.leftChild();
  }
  flat.assign(links, workers);
}

void SurfaceTree::Impl::refit(Span<const Vec3> x_t0, Span<const Vec3> x_t1, const Workers& workers) {
  fitted_x_t0.assign(x_t0.begin(), x_t0.end());
  fitted_x_t1.assign(x_t1.begin(), x_t1.end());
  workers.for_each(triangles.size(), triangle_chunk,
                   [&](std::size_t t) { boxes[t] = proximity::swept_box(triangles[t], x_t0, x_t1); });
  flat.refit(boxes, workers);
  if (hierarchy == Hierarchy::fcl) refit_model();
}

void SurfaceTree::Impl::refit_model() {
  check(model->beginUpdateModel(), "begin the update of");
  for (const Vec3& x : fitted_x_t1) check(model->updateVertex(x), "update");
  // FCL would sweep from the positions of its last update. Contact has changed those since: the motion starts
  // at x_t0.
  std::copy(fitted_x_t0.begin(), fitted_x_t0.end(), model->prev_vertices);
  check(model->endUpdateModel(/*refit=*/true, /*bottomup=*/true), "refit");
}

/// Is the tree already fitted to this motion? So for walls and floors, which do not move.
bool SurfaceTree::Impl::is_fitted_to(Span<const Vec3> x_t0, Span<const Vec3> x_t1) const {
  return std::equal(x_t0.begin(), x_t0.end(), fitted_x_t0.begin(), fitted_x_t0.end()) &&
         std::equal(x_t1.begin(), x_t1.end(), fitted_x_t1.begin(), fitted_x_t1.end());
}

/// Collects the triangles whose boxes overlap the box, unordered. False if it stopped at the limit.
bool SurfaceTree::Impl::collect(const Box& box, std::size_t limit, Scratch& scratch) const {
  scratch.found.clear();
  if (!model || is_empty(box)) return true;
  return hierarchy == Hierarchy::fcl ? collect_from_model(box, limit, scratch)
                                     : flat.collect(box, limit, scratch.stack, scratch.found);
}

bool SurfaceTree::Impl::collect_from_model(const Box& box, std::size_t limit, Scratch& scratch) const {
  const Model& m = *model;
  std::vector<std::int32_t>& stack = scratch.stack;
  stack.assign(1, 0);
  while (!stack.empty()) {
    const auto& node = m.getBV(stack.back());
    stack.pop_back();
    if (!overlap(node.bv, box)) continue;
    if (!node.isLeaf()) {
      stack.push_back(node.rightChild());
      stack.push_back(node.leftChild());
      continue;
    }
    if (scratch.found.size() == limit) return false;
    scratch.found.push_back(static_cast<std::uint32_t>(node.primitiveId()));
  }
  return true;
}

/// How many of `next`, at least one, share a traversal: together they may overlap few triangles.
std::size_t SurfaceTree::Impl::size_of_block(Span<const Box> next) const {
  const double per_side = 3 * static_cast<double>(boxes.size()) / flat.size_of_leaves();
  Box all;
  for (std::size_t k = 0; k < next.size(); ++k) {
    if (is_empty(next[k])) continue;
    all.add(next[k]);
    // A surface passes through a box along the two longest of its sides.
    const Vec3 leaves = (all.max - all.min) * per_side + Vec3::Ones();
    if (k > 0 && leaves.prod() > leaves_of_block * leaves.minCoeff()) return k;
  }
  return next.size();
}

void SurfaceTree::Impl::query_block(Span<const Box> block, Scratch& scratch, std::uint32_t* counts,
                                    std::vector<std::uint32_t>& out) const {
  OILSKIN_ASSERT(block.size() <= block_size);
  Box all;
  for (const Box& b : block)
    if (!is_empty(b)) all.add(b);
  const bool shared = collect(all, block.size() > 1 ? block_limit : no_limit, scratch);
  if (shared) std::sort(scratch.found.begin(), scratch.found.end());
  for (std::size_t i = 0; i < block.size(); ++i) {
    const std::size_t before = out.size();
    if (is_empty(block[i])) {
      // No candidates, although its infinities may pass the comparisons.
    } else if (shared) {
      for (std::uint32_t t : scratch.found)
        if (boxes[t].overlaps(block[i])) out.push_back(t);
    } else {
      collect(block[i], no_limit, scratch);
      std::sort(scratch.found.begin(), scratch.found.end());
      out.insert(out.end(), scratch.found.begin(), scratch.found.end());
    }
    counts[i] = static_cast<std::uint32_t>(out.size() - before);
  }
}

SurfaceTree::SurfaceTree() : impl_(std::make_unique<Impl>()) {}
SurfaceTree::~SurfaceTree() = default;
SurfaceTree::SurfaceTree(SurfaceTree&&) noexcept = default;
SurfaceTree& SurfaceTree::operator=(SurfaceTree&&) noexcept = default;

void SurfaceTree::Impl::clear() {
  // FCL, out of memory in its first refit, leaves one array under two names and would free it twice.
  if (model && model->prev_vertices == model->vertices) model->prev_vertices = nullptr;
  const std::size_t kept = builds;
  *this = Impl();
  builds = kept;
}

void SurfaceTree::Impl::update(Span<const Triangle> tris, Span<const Vec3> x_t0, Span<const Vec3> x_t1,
                               Hierarchy by, const Workers& workers) {
  const bool is_other = by != hierarchy;
  hierarchy = by;
  if (fitted_x_t1.size() == x_t1.size() && same_triangles(tris, triangles)) {
    if (!is_other && is_fitted_to(x_t0, x_t1)) return;
    refit(x_t0, x_t1, workers);
    // Leaves grow with stretch and speed; inner nodes also if parts that were close have moved apart.
    if (flat.size_of_leaves() <= rebuild_growth * leaf_size_built &&
        flat.size_of_nodes() <= rebuild_growth * tree_size_built)
      return;
  }
  build(tris, x_t1, workers);
  refit(x_t0, x_t1, workers);
  leaf_size_built = flat.size_of_leaves();
  tree_size_built = flat.size_of_nodes();
}

void SurfaceTree::update(Span<const Triangle> triangles, Span<const Vec3> x_t0, Span<const Vec3> x_t1,
                         const Workers& workers, Hierarchy hierarchy) {
  OILSKIN_ASSERT(x_t0.size() == x_t1.size());
  OILSKIN_ASSERT(all_in_range(triangles, x_t1.size()));
  OILSKIN_ASSERT(all_finite(x_t0) && all_finite(x_t1));
  if (triangles.empty()) return impl_->clear();
  try {
    impl_->update(triangles, x_t0, x_t1, hierarchy, workers);
  } catch (...) {
    impl_->clear();  // FCL's model may be inconsistent
    throw;
  }
}

std::size_t SurfaceTree::builds() const {
  return impl_->builds;
}

const Box& SurfaceTree::swept_box(std::uint32_t triangle) const {
  OILSKIN_ASSERT(triangle < impl_->boxes.size());
  return impl_->boxes[triangle];
}

Box SurfaceTree::bounds() const {
  return impl_->flat.empty() ? Box() : impl_->flat.bounds();
}

void SurfaceTree::query(const Box& box, std::vector<std::uint32_t>& triangles) const {
  Scratch scratch;
  impl_->collect(box, no_limit, scratch);
  std::sort(scratch.found.begin(), scratch.found.end());
  triangles.insert(triangles.end(), scratch.found.begin(), scratch.found.end());
}

bool SurfaceTree::overlaps(const Box& box) const {
  Scratch scratch;
  return !impl_->collect(box, 0, scratch);
}

void SurfaceTree::query(Span<const Box> boxes, const Workers& workers, Candidates& candidates) const {
  const std::size_t n = boxes.size();
  const bool is_small = impl_->triangles.size() < small_tree;
  const std::size_t blocks = (n + block_size - 1) / block_size;  // they do not depend on chunks
  const std::size_t chunk_size =
      block_size * even_chunk(blocks, is_small ? smallest_chunk_of_small_tree : smallest_chunk);
  candidates.begin.assign(n + 1, 0);
  std::vector<std::vector<std::uint32_t>> found((n + chunk_size - 1) / chunk_size);
  workers.for_chunks(n, chunk_size, [&](std::size_t begin, std::size_t end, std::size_t chunk) {
    Scratch scratch;
    for (std::size_t i = begin, size = 0; i < end; i += size) {
      size = impl_->size_of_block({boxes.data() + i, std::min(block_size, end - i)});
      impl_->query_block({boxes.data() + i, size}, scratch, candidates.begin.data() + i + 1, found[chunk]);
    }
  });
  std::size_t total = 0;
  for (const auto& part : found) total += part.size();
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw std::length_error("oilskin: more than 2^32 candidate pairs; lower dt");
  for (std::size_t i = 0; i < n; ++i) candidates.begin[i + 1] += candidates.begin[i];
  OILSKIN_ASSERT(candidates.begin[n] == total);
  candidates.triangle.resize(total);
  workers.for_chunks(n, chunk_size, [&](std::size_t begin, std::size_t, std::size_t chunk) {
    std::copy(found[chunk].begin(), found[chunk].end(),
              candidates.triangle.begin() + candidates.begin[begin]);
  });
}

}  // namespace oilskin::proximity
