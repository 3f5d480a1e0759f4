/// Boundary particles on triangle meshes [Akinci2012].
#pragma once

#include "study/comparators/neighbour_lists.h"
#include "study/comparators/surface_set.h"

namespace oilskin::study {

/// A boundary particle: a point of a triangle.
struct BoundarySample {
  std::size_t surface = 0;
  Triangle nodes{};
  std::array<double, 3> weights{};
};

/// The particles of all surfaces. Nodes, edges and triangles are sampled at most `spacing` apart, each edge
/// once. The samples follow the lengths at x_t0: a mesh that stretches gets more of them, as [Akinci2013a]
/// resamples. What is sampled too densely has the smaller volumes for it.
class BoundarySamples {
 public:
  /// @param spacing [m]
  /// @param support the support radius H of the kernel [m]
  BoundarySamples(double spacing, double support) : spacing_(spacing), support_(support) {}

  /// Samples the surfaces at x_t0, and computes V_b = 1/Σ_k W_bk, [Akinci2012] Eq. 4. Nothing is done while
  /// no surface moves.
  void update(const SurfaceSet& surfaces);

  std::size_t size() const { return samples_.size(); }
  const BoundarySample& sample(std::size_t b) const { return samples_[b]; }
  Span<const Vec3> positions() const { return x_; }
  double volume(std::size_t b) const { return volume_[b]; }

 private:
  void sample(const SurfaceMotion& motion, std::size_t surface);
  void add(const SurfaceMotion& motion, const BoundarySample& sample);

  double spacing_, support_;
  std::vector<std::vector<Vec3>> sampled_at_;  // per surface: x_t0 then
  std::vector<BoundarySample> samples_;
  std::vector<Vec3> x_;
  std::vector<double> volume_;
  NeighbourLists lists_;
};

}  // namespace oilskin::study
