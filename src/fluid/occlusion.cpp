#include "fluid/occlusion.h"

#include <algorithm>

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t triangle_chunk = 64, particle_chunk = 64;

/// So many ends are not compared with others: particles, and those among which they are searched.
constexpr std::size_t few = 8, few_to_search = 64;

using Pair = std::pair<std::uint32_t, std::uint32_t>;

/// A particle, and a triangle that may hide some of its neighbours: an index into TriangleCells::triangles().
struct NearPair {
  std::uint32_t particle, triangle;
};

/// The triangles from whose hidden pairs a particle is an end, by particle. Each hidden pair is found from an
/// end of it at least.
struct DividingTriangles {
  std::vector<std::uint32_t> particle;  // ascending
  std::vector<std::uint32_t> begin;     // one more than particles
  std::vector<std::uint32_t> triangle;

  explicit DividingTriangles(std::vector<NearPair> all);
  Span<const std::uint32_t> of(std::size_t k) const {
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

/// How far points are from a triangle, at least, along its plane: by the edges.
class BesideTriangle {
 public:
  explicit BesideTriangle(const SightTest& triangle) : corner_(triangle.corners()) {
    for (std::size_t k = 0; k < 3; ++k)
      outward_[k] = (corner_[(k + 1) % 3] - corner_[k]).cross(triangle.normal()).normalized();
  }
  double distance(const Vec3& p) const {
    double beside = 0;
    for (std::size_t k = 0; k < 3; ++k) beside = std::max(beside, outward_[k].dot(p - corner_[k]));
    return beside;
  }

 private:
  std::array<Vec3, 3> corner_, outward_;
};

/// Of a pair that a triangle hides, each side of the plane has an end. Both are within H of the triangle, and
/// one within H/2. So it is found from the particles on one side, and from those within H/2.
class EndsOfPairs {
 public:
  EndsOfPairs(Span<const Vec3> x, double support_radius, const TriangleCells& cells)
      : x_(x), reach_(support_radius * (1 + 1e-9)), cells_(cells) {}

  /// Few particles from which all pairs are found that the triangle hides; none where all are on one side.
  const std::vector<std::uint32_t>& find(const SurfaceMotion& motion, std::uint32_t triangle);

 private:
  struct Target;
  void find_within(const Target& target, Sides sides, double reach, std::vector<std::uint32_t>& found) const;

  Span<const Vec3> x_;
  double reach_;
  const TriangleCells& cells_;
  std::vector<std::uint32_t> ends_, others_;
};

struct EndsOfPairs::Target {
  std::uint32_t triangle;
  SightTest test;
  BesideTriangle beside{test};
  Box corners;

  Target(const SurfaceMotion& motion, std::uint32_t index, const NearbyTriangle& nearby)
      : triangle(index), test(motion, nearby.triangle) {
    for (const Vec3& corner : test.corners()) corners.add(corner);
  }
};

void EndsOfPairs::find_within(const Target& target, Sides sides, double reach,
                              std::vector<std::uint32_t>& found) const {
  found.clear();
  const Box box = target.corners.inflated(reach);  // a quick test
  const double length = target.test.normal_length(), most = reach * length, highest = sides.front ? most : 0,
               lowest = sides.back ? -most : 0;
  cells_.for_particles_near(target.triangle, [&](const TriangleCells::Cell& group, Sides of_group) {
    if (!(sides.front && of_group.front) && !(sides.back && of_group.back)) return;
    if (!box.overlaps(group.box)) return;
    for (std::uint32_t i = group.begin; i < group.end; ++i) {
      const double side = target.test.side(x_[i]);
      if (!(side >= lowest && side <= highest && box.contains(x_[i]))) continue;
      const double above = side / length, aside = target.beside.distance(x_[i]);
      if (above * above + aside * aside <= reach * reach) found.push_back(i);
    }
  });
}

const std::vector<std::uint32_t>& EndsOfPairs::find(const SurfaceMotion& motion, std::uint32_t triangle) {
  const Target target(motion, triangle, cells_.triangles()[triangle]);
  ends_.clear();
  if (target.test.normal_length() == 0) return ends_;
  std::size_t front = 0, back = 0;
  cells_.for_particles_near(triangle, [&](const TriangleCells::Cell& group, Sides of_group) {
    front += of_group.front ? group.end - group.begin : 0;
    back += of_group.back ? group.end - group.begin : 0;
  });
  // Where few are on one side, as above a floor, that is the least work; else what is nearer.
  const Sides fewer = {front < back, front >= back};
  const bool one_side_first = std::min(front, back) <= few_to_search;
  const auto find_one_side = [&](std::vector<std::uint32_t>& found) {
    find_within(target, fewer, reach_, found);
  };
  const auto find_nearer = [&](std::vector<std::uint32_t>& found) {
    find_within(target, {true, true}, 0.5 * reach_, found);
  };
  one_side_first ? find_one_side(ends_) : find_nearer(ends_);
  if (ends_.size() <= few) return ends_;
  one_side_first ? find_nearer(others_) : find_one_side(others_);
  if (others_.size() < ends_.size()) ends_.swap(others_);
  return ends_;
}

DividingTriangles find_dividing_triangles(Span<const Vec3> x, Span<SurfaceMotion* const> surfaces,
                                          const TriangleCells& cells, double support_radius,
                                          const Workers& workers) {
  std::vector<std::uint32_t> triangles;  // nearly all have water on one side
  for (std::uint32_t t = 0; t < cells.triangles().size(); ++t)
    if (cells.triangles()[t].sides.front && cells.triangles()[t].sides.back) triangles.push_back(t);
  std::vector<std::vector<NearPair>> found((triangles.size() + triangle_chunk - 1) / triangle_chunk);
  workers.for_chunks(triangles.size(), triangle_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
    EndsOfPairs ends(x, support_radius, cells);
    for (std::size_t k = b; k < e; ++k) {
      const std::uint32_t t = triangles[k];
      for (std::uint32_t i : ends.find(*surfaces[cells.triangles()[t].surface], t))
        found[c].push_back({i, t});
    }
  });
  std::vector<NearPair> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  return DividingTriangles(std::move(all));
}

void find_hidden_neighbours(std::uint32_t i, Span<const std::uint32_t> triangles, Span<const Vec3> x,
                            Span<SurfaceMotion* const> surfaces, const TriangleCells& cells,
                            const Neighbours& neighbours, std::vector<Pair>& hidden) {
  const std::uint32_t* list = neighbours.list(i);
  const std::uint32_t count = neighbours.count(i);
  std::vector<std::uint8_t> is_hidden(count, 0);
  for (std::uint32_t t : triangles) {
    const NearbyTriangle& nearby = cells.triangles()[t];
    const SightTest test(*surfaces[nearby.surface], nearby.triangle);
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
  const DividingTriangles dividing = find_dividing_triangles(x, surfaces, cells, support_radius, workers);
  const std::size_t count = dividing.particle.size();
  std::vector<std::vector<Pair>> hidden((count + particle_chunk - 1) / particle_chunk);
  workers.for_chunks(count, particle_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
    for (std::size_t k = b; k < e; ++k)
      find_hidden_neighbours(dividing.particle[k], dividing.of(k), x, surfaces, cells, neighbours, hidden[c]);
    sort_unique(hidden[c]);
  });
  const std::vector<Pair> pairs = both_orders(hidden);
  neighbours.remove(pairs, workers);
  return pairs.size() / 2;
}

}  // namespace oilskin::fluid
