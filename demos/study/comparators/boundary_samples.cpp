#include "study/comparators/boundary_samples.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace oilskin::study {

void BoundarySamples::update(const SurfaceSet& surfaces) {
  bool moved = sampled_at_.size() != surfaces.size();
  for (std::size_t s = 0; s < surfaces.size() && !moved; ++s) moved = sampled_at_[s] != surfaces[s].x_t0;
  if (!moved) return;
  samples_.clear(), x_.clear(), sampled_at_.clear();
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    sample(surfaces[s], s);
    sampled_at_.push_back(surfaces[s].x_t0);
  }
  lists_.search(x_, x_, support_, true);
  volume_.resize(x_.size());
  for (std::size_t b = 0; b < x_.size(); ++b) {
    double sum = cubic_spline(0, support_);
    for (std::uint32_t k : lists_.of(b)) sum += cubic_spline((x_[b] - x_[k]).norm(), support_);
    volume_[b] = 1 / sum;
  }
}

void BoundarySamples::add(const SurfaceMotion& motion, const BoundarySample& sample) {
  Vec3 x = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) x += sample.weights[k] * motion.x_t0[sample.nodes[k]];
  samples_.push_back(sample);
  x_.push_back(x);
}

void BoundarySamples::sample(const SurfaceMotion& motion, std::size_t surface) {
  const auto parts = [&](std::uint32_t a, std::uint32_t b) {
    const double length = (motion.x_t0[a] - motion.x_t0[b]).norm();
    // A stretch by a rounding error must not add a sample; a sheet torn far apart must not exhaust memory.
    return static_cast<int>(std::clamp(std::ceil(length / spacing_ - 1e-9), 1.0, 1000.0));
  };
  std::set<std::uint32_t> nodes;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Triangle& t : motion.triangles) {
    int most = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const int n = parts(t[k], t[next]);
      most = std::max(most, n);
      BoundarySample s{surface, t, {}};
      s.weights[k] = 1;
      if (nodes.insert(t[k]).second) add(motion, s);
      if (!edges.insert(std::minmax(t[k], t[next])).second) continue;
      for (int i = 1; i < n; ++i) {
        s.weights[next] = double(i) / n;
        s.weights[k] = 1 - s.weights[next];
        add(motion, s);
      }
    }
    for (int i = 1; i < most; ++i)
      for (int j = 1; i + j < most; ++j)
        add(motion, {surface, t, {double(most - i - j) / most, double(i) / most, double(j) / most}});
  }
}

}  // namespace oilskin::study
