#include "reconstruction/turned_parts.h"

#include <algorithm>
#include <utility>

#include "core/assert.h"
#include "reconstruction/blobs.h"
#include "reconstruction/grid.h"

namespace oilskin::reconstruction {

using Float3 = std::array<float, 3>;

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
  positive_ = std::make_unique<LineCrossings>(positions, triangles);
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
  return positive_ && positive_->beyond(x) > 0;
}

}  // namespace oilskin::reconstruction
