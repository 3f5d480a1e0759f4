/// What a particle sees of very many triangles, by rays.
#pragma once

#include <array>
#include <vector>

#include "fluid/boundary/wall_integral.h"

namespace oilskin::fluid {

/// Which triangle a particle at the origin sees in each of 1024 directions (B.41). The time for n triangles
/// is proportional to n, that to cut them by each other to n² and more. Lengths in units of H.
class ViewSamples {
 public:
  void clear();
  /// `side`: unit normals of the faces of the pyramid from the particle through the edges, inwards. The
  /// pyramid lies in the cone around `axis`, a unit vector, with the cosine of its half angle; cosine < 0:
  /// anywhere. Triangles have the numbers 0, 1, …, in the order in which they are added. Of those that lie on
  /// each other the one that is added first is seen.
  void add(const WallPlane& plane, const std::array<Eigen::Vector3f, 3>& side, const Eigen::Vector3f& axis,
           float cosine);
  /// 2π Λ of what is seen of each triangle, as of Shadows.
  const std::vector<float>& masses();

 private:
  static constexpr std::size_t directions = 1024;
  struct Directions;
  struct Range {
    std::size_t begin, end;
  };

  static Range directions_in(const Eigen::Vector3f& axis, float cosine);

  std::size_t triangles_ = 0;
  std::array<float, directions> distance_;
  std::array<std::int32_t, directions> seen_;  ///< number of a triangle, or −1
  std::vector<float> masses_;
};

}  // namespace oilskin::fluid
