/// Which part of each triangle near a particle the particle sees, and the share (B.7) of that part.
#pragma once

#include <array>
#include <vector>

#include "fluid/boundary/view_samples.h"
#include "fluid/boundary/wall_integral.h"

namespace oilskin::fluid {

/// The triangles around a particle at the origin, lengths in units of H. A triangle hides what lies beyond
/// its plane within the pyramid from the particle through its edges (B.31). The visible parts of all
/// triangles have no direction in common, so that nothing counts twice: the side of a box below its top, a
/// floor that goes on behind a wall, layers behind a layer.
class VisibleParts {
 public:
  void clear() {
    triangles_.clear();
    order_.clear();
  }
  /// Of triangles that lie on each other the one that is added first is seen.
  void add(const std::array<Eigen::Vector3f, 3>& corners);
  float distance(std::size_t k) const { return triangles_[k].plane.distance(); }
  /// A quick test. False only if each triangle is seen as a whole.
  bool any_may_hide();
  /// Planes of the triangles k for which `is_asked(k)`, and the shares of their visible parts. The others
  /// have none. If it takes more than `most_tests` tests of pieces to cut them, the shares are sampled: in a
  /// ball of crumpled cloth a particle sees hundreds of triangles, cut into thousands of pieces.
  template <class F>
  const std::vector<WallView>& views(const F& is_asked, std::size_t most_tests = 10000) {
    views_.assign(triangles_.size(), WallView());
    if (!cut(is_asked, most_tests)) sample(is_asked);
    return views_;
  }

 private:
  static constexpr std::size_t few = 8, sure = 3;

  /// False if it takes too many tests.
  template <class F>
  bool cut(const F& is_asked, std::size_t most_tests) {
    arrange();
    shadows_.clear();
    pieces_end_.clear();
    tests_ = 0;
    for (std::size_t k = 0; k < triangles_.size(); ++k) {
      if (is_asked(k) && triangles_[k].plane.acts() && !cast_shadows(k, most_tests)) return false;
      pieces_end_.push_back(shadows_.size());
      // At this rate it will take far too many.
      if (k >= few && tests_ * triangles_.size() > sure * most_tests * (k + 1)) return false;
    }
    find_views();
    return true;
  }
  template <class F>
  void sample(const F& is_asked) {
    samples_.clear();
    for (const Occluder& o : triangles_) samples_.add(o.plane, o.side, o.axis, o.cosine);
    const std::vector<float>& masses = samples_.masses();
    for (std::size_t k = 0; k < triangles_.size(); ++k)
      if (masses[k] > 0 && is_asked(k) && triangles_[k].plane.acts())
        views_[k] = view_with_shadow(triangles_[k].plane, masses[k]);
  }

  /// The triangle's plane, normal away from the particle, and the faces of its pyramid, inwards: four
  /// normals.
  struct Faces {
    Eigen::Array4f x, y, z;
    Eigen::Array4f heights(const Eigen::Vector3f& p) const { return x * p.x() + (y * p.y() + z * p.z()); }
    Eigen::Vector3f normal(Eigen::Index k) const { return {x[k], y[k], z[k]}; }
  };
  struct Occluder {
    WallPlane plane;
    std::array<Eigen::Vector3f, 3> corners;
    std::array<Eigen::Vector3f, 3> side;  ///< unit normals of the pyramid's faces, inwards
    Faces faces;
    Eigen::Vector3f axis;  ///< of a cone around the pyramid, a unit vector
    float cosine, sine;    ///< of the cone's half angle; cosine < 0: the cone is all of space
  };
  struct Piece {
    std::size_t begin, end;  ///< in points_
  };

  Occluded occluded(std::size_t k) const;
  void find_occluders(std::size_t k);
  void sort_by_key(std::vector<std::size_t>& sorted);
  void sort_by_distance();
  void fill_blocks();
  void arrange();
  bool cut_triangle(std::size_t k, std::size_t most_tests);
  bool cast_shadows(std::size_t k, std::size_t most_tests);
  void find_views();
  void subtract(const Occluder& occluder);
  Piece split(Piece piece, const Eigen::Vector3f& normal, float offset);

  std::vector<Occluder> triangles_;
  std::vector<std::size_t> order_;      ///< by distance
  std::vector<std::size_t> rank_;       ///< in this order, per triangle
  std::vector<std::size_t> in_blocks_;  ///< by direction
  std::vector<OccluderBlock> blocks_;   ///< in this order
  std::vector<std::uint8_t> may_hide_;  ///< per block, a bit per triangle
  std::vector<std::size_t> occluders_;  ///< of one triangle, in order_
  std::vector<std::uint64_t> keys_;
  Shadows shadows_;                      ///< of the pieces that are seen
  std::vector<std::size_t> pieces_end_;  ///< per triangle
  std::vector<WallView> views_;
  ViewSamples samples_;
  std::size_t tests_ = 0;
  // Of cut(): what is left of the triangle
  std::vector<Eigen::Vector3f> points_, below_;
  std::vector<float> height_;
  std::vector<Piece> pieces_, remaining_;
};

}  // namespace oilskin::fluid
