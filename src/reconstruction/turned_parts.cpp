#include "reconstruction/turned_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/assert.h"
#include "reconstruction/blobs.h"
#include "reconstruction/grid.h"

namespace oilskin::reconstruction {

using Float3 = std::array<float, 3>;

/// Counts how often vertical lines pass through chosen triangles. Triangles that follow each other in the
/// mesh lie near each other, so a box for some of them excludes most.
class TurnedParts::Crossings {
 public:
  Crossings(const std::vector<Float3>& positions, const std::vector<Triangle>& triangles)
      : positions_(positions), triangles_(triangles) {}

  void add(std::uint32_t triangle) {
    if (numbers_.size() % group == 0) groups_.emplace_back();
    numbers_.push_back(triangle);
    Group& g = groups_.back();
    for (const std::uint32_t v : triangles_[triangle]) {
      const Float3& p = positions_[v];
      for (std::size_t a = 0; a < 2; ++a) {
        g.low[a] = std::min(g.low[a], p[a]);
        g.high[a] = std::max(g.high[a], p[a]);
      }
      g.top = std::max(g.top, p[2]);
    }
  }
  /// How many triangles with normals up lie above x, less those with normals down: how many parts x is in.
  int above(const Vec3& x) const {
    int sum = 0;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (!groups_[g].may_be_above(x)) continue;
      const std::size_t end = std::min(numbers_.size(), (g + 1) * group);
      for (std::size_t k = g * group; k < end; ++k) sum += above(x, triangles_[numbers_[k]]);
    }
    return sum;
  }

 private:
  static constexpr std::size_t group = 64;
  struct Group {
    std::array<float, 2> low = {infinity, infinity}, high = {-infinity, -infinity};
    float top = -infinity;

    bool may_be_above(const Vec3& x) const {
      return x.z() <= double(top) && x.x() >= double(low[0]) && x.x() <= double(high[0]) &&
             x.y() >= double(low[1]) && x.y() <= double(high[1]);
    }
    static constexpr float infinity = std::numeric_limits<float>::infinity();
  };

  /// Twice the area of the triangle of an edge and x, seen from above: the same number, but for the sign,
  /// from both of its triangles, so that a line passes through exactly one of them.
  double beside(std::uint32_t from, std::uint32_t to, const Vec3& x) const {
    if (from > to) return -beside(to, from, x);
    const Float3 &a = positions_[from], &b = positions_[to];
    return (double(b[0]) - double(a[0])) * (x.y() - double(a[1])) -
           (double(b[1]) - double(a[1])) * (x.x() - double(a[0]));
  }
  /// 1: the triangle is above x and its normal is up, −1: down, 0: it is not above x.
  int above(const Vec3& x, const Triangle& t) const {
    std::array<double, 3> area{};  // opposite to the corners
    int left = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t[(k + 1) % 3], to = t[(k + 2) % 3];
      area[k] = beside(from, to, x);
      left += area[k] > 0 || (area[k] == 0 && from < to);
    }
    if (left != 0 && left != 3) return 0;
    double height = 0, sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      height += area[k] * (double(positions_[t[k]][2]) - x.z());
      sum += area[k];
    }
    // With normals down the areas are negative.
    const int up = left == 3 ? 1 : -1;
    return up * height > 0 && sum != 0 ? up : 0;
  }

  const std::vector<Float3>& positions_;
  const std::vector<Triangle>& triangles_;
  std::vector<std::uint32_t> numbers_;
  std::vector<Group> groups_;
};

std::vector<double> part_volumes(const std::vector<Float3>& positions, const std::vector<Triangle>& triangles,
                                 const std::vector<std::uint32_t>& of_vertex, const Workers& workers) {
  OILSKIN_ASSERT(of_vertex.size() == positions.size());
  constexpr std::size_t chunk = 1 << 12;
  const std::size_t n = triangles.size();
  // The sums of chunks are added in their order.
  std::vector<std::vector<std::pair<std::uint32_t, double>>> sums((n + chunk - 1) / chunk);
  workers.for_chunks(n, chunk, [&](std::size_t from, std::size_t to, std::size_t c) {
    for (std::size_t k = from; k < to; ++k) {
      const Triangle& t = triangles[k];
      const std::uint32_t p = of_vertex[t[0]];
      if (sums[c].empty() || sums[c].back().first != p) sums[c].emplace_back(p, 0.0);
      sums[c].back().second += six_volumes(positions, t, positions[p]) / 6;
    }
  });
  std::vector<double> volume(positions.size(), 0);
  for (const auto& part : sums)
    for (const auto& [p, sum] : part) volume[p] += sum;
  return volume;
}

namespace {

/// Triangles of a part, spread evenly over all of them.
class Samples {
 public:
  void add(const Vec3& middle, double area) {
    if (seen_++ % every_ != 0) return;
    taken_.push_back({middle, area});
    if (taken_.size() < 2 * least) return;
    for (std::size_t i = 0; i < least; ++i) taken_[i] = taken_[2 * i];
    taken_.resize(least);
    every_ *= 2;
  }
  /// The share of the area for which f(middle) holds.
  template <class F>
  double share(const F& f) const {
    double sum = 0, all = 0;
    for (const Sample& s : taken_) {
      all += s.area;
      if (f(s.middle)) sum += s.area;
    }
    return all > 0 ? sum / all : 0;
  }

 private:
  static constexpr std::size_t least = 32;
  struct Sample {
    Vec3 middle;
    double area;
  };
  std::vector<Sample> taken_;
  std::size_t seen_ = 0, every_ = 1;
};

}  // namespace

TurnedParts::TurnedParts(const std::vector<Float3>& positions, const std::vector<Triangle>& triangles,
                         const std::vector<std::uint32_t>& of_vertex, const std::vector<double>& volume,
                         const Workers& workers) {
  OILSKIN_ASSERT(of_vertex.size() == positions.size() && volume.size() == positions.size());
  std::vector<std::uint32_t> negative;
  for (std::uint32_t v = 0; v < volume.size(); ++v)
    if (volume[v] < 0) negative.push_back(v);
  if (negative.empty()) return;
  positive_ = std::make_unique<Crossings>(positions, triangles);
  std::vector<Samples> samples(negative.size());
  for (std::uint32_t n = 0; n < triangles.size(); ++n) {
    const Triangle& t = triangles[n];
    const std::uint32_t part = of_vertex[t[0]];
    if (!(volume[part] < 0)) {
      positive_->add(n);
      continue;
    }
    const Vec3 a = vec(positions[t[0]]), b = vec(positions[t[1]]), c = vec(positions[t[2]]);
    samples[std::size_t(std::lower_bound(negative.begin(), negative.end(), part) - negative.begin())].add(
        (a + b + c) / 3, (b - a).cross(c - a).norm());
  }
  std::vector<std::uint8_t> is_turned(negative.size(), 0);
  workers.for_each(negative.size(), 8, [&](std::size_t i) {
    is_turned[i] = samples[i].share([&](const Vec3& x) { return is_in_water(x); }) < 0.5;
  });
  for (std::size_t i = 0; i < negative.size(); ++i)
    if (is_turned[i]) numbers_.push_back(negative[i]);
}

TurnedParts::~TurnedParts() = default;

bool TurnedParts::is_in_water(const Vec3& x) const {
  return positive_ && positive_->above(x) > 0;
}

}  // namespace oilskin::reconstruction
