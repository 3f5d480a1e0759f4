/// The walls of one particle, from the triangles near it.
#pragma once

#include "fluid/boundary/visible_part.h"
#include "fluid/boundary/wall_geometry.h"

namespace oilskin::fluid {

struct WallBuffers {
  CellTriangles cell;  ///< of the particle
  NearTriangles near;
  VisibleParts parts;
  Shadows shadows;
  std::vector<WallPlane> planes;
};

class PointWalls {
 public:
  /// Walls are appended to `walls`, their sums written to `point`.
  PointWalls(const BoundaryInput& input, const MirrorImage& image, WallBuffers& buffers, WallPoint& point,
             std::vector<Wall>& walls)
      : input_(input),
        image_(image),
        cell_(buffers.cell),
        near_(buffers.near),
        parts_(buffers.parts),
        shadows_(buffers.shadows),
        planes_(buffers.planes),
        x_(input.x[point.particle]),
        point_(point),
        walls_(walls) {}

  /// False if no triangle is near whose plane is within reach.
  bool find();

 private:
  bool find_unhidden();
  void find_visible();
  std::size_t nearest() const;
  bool is_plane() const;
  void add_to_parts();
  bool may_be_hidden() const;
  bool may_be_hidden(std::size_t k) const;
  double side(const SurfaceMotion& surface, std::uint32_t triangle) const;
  void add_plane();
  void add_triangles();
  void limit_density();
  void leave_out_faint_walls();
  void take_off_what_both_count();
  void add(std::size_t k, const WallView& view);
  std::array<Eigen::Vector3f, 3> corners(std::size_t k) const;
  float nearest_distance() const {
    return static_cast<float>(near_.distance(nearest_) / input_.support_radius);
  }

  const BoundaryInput& input_;
  const MirrorImage& image_;
  const CellTriangles& cell_;
  NearTriangles& near_;
  VisibleParts& parts_;
  Shadows& shadows_;
  std::vector<WallPlane>& planes_;
  std::size_t nearest_ = 0;
  const Vec3 x_;
  WallPoint& point_;
  std::vector<Wall>& walls_;
};

}  // namespace oilskin::fluid
