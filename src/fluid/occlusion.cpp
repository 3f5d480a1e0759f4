#include "fluid/occlusion.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t triangle_chunk = 64, particle_chunk = 64;

using Pair = std::pair<std::uint32_t, std::uint32_t>;

struct TriangleRef {
  std::uint32_t surface, triangle;
};

Box triangle_box(const SurfaceMotion& s, std::uint32_t triangle) {
  Box box;
  for (std::uint32_t n : s.triangles[triangle]) box.add(s.x_t0[n]);
  return box;
}

/// Are there particles within H on both sides?
bool separates_particles(const SightTest& test, const Box& box, Span<const Vec3> x, double reach,
                         const Neighbours& neighbours) {
  const double plane_reach = reach * test.normal_length();
  bool front = false, back = false;
  neighbours.for_runs_in(box, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end && !(front && back); ++i) {
      const double side = test.side(x[i]);
      if (std::abs(side) > plane_reach || !box.contains(x[i])) continue;
      front |= side >= 0;
      back |= side <= 0;
    }
  });
  return front && back;
}

struct NearPair {
  std::uint32_t particle;
  TriangleRef triangle;
};

/// Per particle, the triangles within H/2 that separate particles: of a hidden pair, one end is as near to
/// the triangle.
struct DividingTriangles {
  std::vector<std::uint32_t> particle;  // ascending
  std::vector<std::uint32_t> begin;     // one more than particles
  std::vector<TriangleRef> triangle;

  explicit DividingTriangles(std::vector<NearPair> all);
  Span<const TriangleRef> of(std::size_t k) const {
    return {triangle.data() + begin[k], begin[k + 1] - begin[k]};
  }
};

DividingTriangles::DividingTriangles(std::vector<NearPair> all) {
  std::stable_sort(all.begin(), all.end(),
                   [](const NearPair& a, const NearPair& b) { return a.particle < b.particle; });
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (k == 0 || all[k].particle != all[k - 1].particle) {
      particle.push_back(all[k].particle);
      begin.push_back(static_cast<std::uint32_t>(k));
    }
    triangle.push_back(all[k].triangle);
  }
  begin.push_back(static_cast<std::uint32_t>(all.size()));
  OILSKIN_ASSERT(begin.size() == particle.size() + 1);
}

/// The particles within H/2 of a triangle, if it separates particles.
void find_near_particles(const SurfaceMotion& motion, TriangleRef ref, Span<const Vec3> x,
                         double support_radius, const Neighbours& neighbours, std::vector<NearPair>& found) {
  const SightTest test(motion, ref.triangle);
  if (test.normal_length() == 0) return;
  const Box box = triangle_box(motion, ref.triangle);
  if (!separates_particles(test, box.inflated(support_radius), x, support_radius, neighbours)) return;
  const double half = 0.5 * support_radius * (1 + 1e-9);
  const Box near = box.inflated(half);
  const double plane_reach = half * test.normal_length();
  neighbours.for_runs_in(near, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i)
      if (near.contains(x[i]) && std::abs(test.side(x[i])) <= plane_reach) found.push_back({i, ref});
  });
}

DividingTriangles find_dividing_triangles(Span<const Vec3> x, Span<SurfaceMotion* const> surfaces,
                                          const TriangleCells& cells, double support_radius,
                                          const Neighbours& neighbours, const Workers& workers) {
  std::vector<TriangleRef> triangles;  // nearly all have water on one side
  for (const NearbyTriangle& t : cells.triangles())
    if (t.has_front && t.has_back) triangles.push_back({t.surface, t.triangle});
  std::vector<std::vector<NearPair>> found((triangles.size() + triangle_chunk - 1) / triangle_chunk);
  workers.for_chunks(triangles.size(), triangle_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
    for (std::size_t k = b; k < e; ++k)
      find_near_particles(*surfaces[triangles[k].surface], triangles[k], x, support_radius, neighbours,
                          found[c]);
  });
  std::vector<NearPair> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  return DividingTriangles(std::move(all));
}

void find_hidden_neighbours(std::uint32_t i, Span<const TriangleRef> triangles, Span<const Vec3> x,
                            Span<SurfaceMotion* const> surfaces, const Neighbours& neighbours,
                            std::vector<Pair>& hidden) {
  const std::uint32_t* list = neighbours.list(i);
  const std::uint32_t count = neighbours.count(i);
  std::vector<std::uint8_t> is_hidden(count, 0);
  for (const TriangleRef& t : triangles) {
    const SightTest test(*surfaces[t.surface], t.triangle);
    const double own = test.side(x[i]);
    for (std::uint32_t k = 0; k < count; ++k) {
      if (is_hidden[k]) continue;
      const std::uint32_t j = list[k];
      const double other = test.side(x[j]);
      if ((own > 0 && other > 0) || (own < 0 && other < 0)) continue;
      is_hidden[k] = i < j ? test.blocks(x[i], x[j], own, other) : test.blocks(x[j], x[i], other, own);
    }
  }
  for (std::uint32_t k = 0; k < count; ++k)
    if (is_hidden[k]) hidden.push_back(std::minmax(i, list[k]));
}

void sort_unique(std::vector<Pair>& pairs) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

/// Pairs i < j of all chunks → (i, j) and (j, i), sorted. Water that is compressed between sheets has
/// hundreds of hidden pairs a particle, so each is kept once for as long as possible.
std::vector<Pair> both_orders(std::vector<std::vector<Pair>>& parts) {
  std::vector<Pair> pairs;
  for (std::vector<Pair>& part : parts) {
    pairs.insert(pairs.end(), part.begin(), part.end());
    std::vector<Pair>().swap(part);
  }
  sort_unique(pairs);
  const std::size_t count = pairs.size();
  pairs.reserve(2 * count);
  for (std::size_t k = 0; k < count; ++k) pairs.push_back({pairs[k].second, pairs[k].first});
  const auto middle = pairs.begin() + static_cast<std::ptrdiff_t>(count);
  std::sort(middle, pairs.end());
  std::inplace_merge(pairs.begin(), middle, pairs.end());
  return pairs;
}

}  // namespace

SightTest::SightTest(const SurfaceMotion& surface, std::uint32_t triangle) {
  OILSKIN_ASSERT(triangle < surface.triangles.size());
  nodes_ = surface.triangles[triangle];
  for (std::size_t k = 0; k < 3; ++k) corner_[k] = surface.x_t0[nodes_[k]];
  normal_ = (corner_[1] - corner_[0]).cross(corner_[2] - corner_[0]);
  normal_length_ = normal_.norm();
}

std::uint64_t remove_hidden_neighbours(Span<const Vec3> x, Span<SurfaceMotion* const> surfaces,
                                       const TriangleCells& cells, double support_radius,
                                       Neighbours& neighbours, const Workers& workers) {
  OILSKIN_ASSERT(support_radius > 0 && neighbours.size() == x.size() && cells.is_found());
  const DividingTriangles dividing =
      find_dividing_triangles(x, surfaces, cells, support_radius, neighbours, workers);
  const std::size_t count = dividing.particle.size();
  std::vector<std::vector<Pair>> hidden((count + particle_chunk - 1) / particle_chunk);
  workers.for_chunks(count, particle_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
    for (std::size_t k = b; k < e; ++k)
      find_hidden_neighbours(dividing.particle[k], dividing.of(k), x, surfaces, neighbours, hidden[c]);
    sort_unique(hidden[c]);
  });
  const std::vector<Pair> pairs = both_orders(hidden);
  neighbours.remove(pairs, workers);
  return pairs.size() / 2;
}

}  // namespace oilskin::fluid
