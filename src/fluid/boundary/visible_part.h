/// Which part of each triangle near a particle the particle sees, and the share (B.7) of that part.
#pragma once

#include <array>
#include <vector>

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
  /// have none.
  template <class F>
  const std::vector<WallView>& views(const F& is_asked) {
    arrange();
    shadows_.clear();
    pieces_end_.clear();
    for (std::size_t k = 0; k < triangles_.size(); ++k) {
      if (is_asked(k) && triangles_[k].plane.acts()) cast_shadows(k);
      pieces_end_.push_back(shadows_.size());
    }
    find_views();
    return views_;
  }

 private:
  struct Occluder {
    WallPlane plane;
    std::array<Eigen::Vector3f, 3> corners;
    std::array<Eigen::Vector3f, 3> side;  ///< unit normals of the pyramid's faces, inwards
    Eigen::Vector3f axis;                 ///< of a cone around the pyramid, a unit vector
    float cosine, sine;                   ///< of the cone's half angle; cosine < 0: the cone is all of space
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
  void cut(std::size_t k);
  void cast_shadows(std::size_t k);
  void find_views();
  bool misses(const Occluder& occluder, const Piece& piece) const;
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
  // Of cut(): what is left of the triangle
  std::vector<Eigen::Vector3f> points_, below_;
  std::vector<Piece> pieces_, remaining_;
};

}  // namespace oilskin::fluid
