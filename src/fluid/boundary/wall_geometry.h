/// The walls of each particle near a surface: density λ_T, gradient γ_T, and where they apply (B.7).
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "fluid/boundary/mirror_image.h"
#include "fluid/boundary/near_triangles.h"

namespace oilskin::fluid {

/// Pressure of a particle at its walls: θ_T = at_particle + per_depth d_T [m/s] (B.13).
template <class T>
struct WallLoad {
  T at_particle = 0, per_depth = 0;

  T on(float depth) const { return at_particle + per_depth * static_cast<T>(depth); }
  WallLoad times(T f) const { return {f * at_particle, f * per_depth}; }
};

/// A particle near a surface.
struct WallPoint {
  std::uint32_t particle = 0;
  float lambda = 0;                                       ///< λ_i at the start, 0 … 1 (B.42)
  float covered = 1;                                      ///< part of what lies beyond its planes (B.43)
  Eigen::Vector3f gamma = Eigen::Vector3f::Zero();        ///< Σ_T γ_T
  Eigen::Vector3f depth_gamma = Eigen::Vector3f::Zero();  ///< Σ_T d_T γ_T
  float max_depth = 0;                                    ///< max |d_T|
  std::uint32_t begin = 0, end = 0;                       ///< its walls

  void add(float wall_lambda, const Eigen::Vector3f& wall_gamma, float depth) {
    lambda += wall_lambda;
    gamma += wall_gamma;
    depth_gamma += depth * wall_gamma;
    max_depth = std::max(max_depth, std::abs(depth));
  }
  void reset_sums() {
    lambda = max_depth = 0;
    gamma.setZero();
    depth_gamma.setZero();
  }
  /// Δv = Σ_T θ_T γ_T [m/s] (B.13).
  Eigen::Vector3f velocity_change(const WallLoad<float>& load) const {
    return load.at_particle * gamma + load.per_depth * depth_gamma;
  }
};

/// One triangle within reach of a particle, or a plane sheet that is represented by its closest triangle.
struct Wall {
  std::uint32_t surface = 0, triangle = 0;
  std::uint32_t point = 0;
  std::array<float, 2> weight{};  ///< barycentric, of corners 0 and 1 of the closest point
  Eigen::Vector3f gamma = Eigen::Vector3f::Zero();
  float lambda = 0;
  float distance = 1;                                ///< ζ_T
  float covered = 0;                                 ///< S_T
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< n_T
  float depth = 0;  ///< d_T (B.15): how much deeper than the particle the wall lies [H]; 0 for free nodes

  /// b_c of a corner.
  double share(int corner) const {
    const double a = static_cast<double>(weight[0]), b = static_cast<double>(weight[1]);
    return corner == 0 ? a : corner == 1 ? b : 1 - a - b;
  }
};

/// What a part of the search keeps for its memory alone.
struct WallBuffers;

/// A plane that stands for the walls of a particle in about one direction.
struct ImagePlane {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< to the particle
  float distance = 0, share = 0;                     ///< ζ, S
};

class WallGeometry {
 public:
  static constexpr std::uint32_t none = UINT32_MAX;

  explicit WallGeometry(const MirrorImage& image) : image_(image) {}

  void find(const BoundaryInput& input, const Workers& workers);
  void clear();

  /// Of the walls that it finds [m].
  double reach(double support_radius) const { return image_.reach(support_radius); }
  const std::vector<WallPoint>& points() const { return points_; }
  const std::vector<Wall>& walls() const { return walls_; }  ///< in the order of points
  Span<const ImagePlane> images_of(std::size_t point) const {
    return {images_.data() + images_begin_[point], images_begin_[point + 1] - images_begin_[point]};
  }
  /// Index into points(), or none. One per particle of the last find().
  const std::vector<std::uint32_t>& point_of() const { return point_of_; }

 private:
  struct Part {  // of a chunk of cells
    std::vector<WallPoint> points;
    std::vector<Wall> walls;
    std::vector<ImagePlane> images;
    std::vector<std::uint32_t> images_end;  // per point
    std::shared_ptr<WallBuffers> buffers;
  };

  void find_part(const BoundaryInput& input, std::size_t begin, std::size_t end, Part& part) const;
  void join(std::size_t parts, std::size_t particles, const Workers& workers);

  const MirrorImage image_;
  std::vector<Part> parts_;
  std::vector<WallPoint> points_;
  std::vector<Wall> walls_;
  std::vector<std::uint32_t> point_of_;
  std::vector<ImagePlane> images_;           // in the order of points
  std::vector<std::uint32_t> images_begin_;  // per point, and one more
};

}  // namespace oilskin::fluid
