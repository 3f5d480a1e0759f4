#include "core/body_path.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace oilskin {

BodyPath BodyPath::part(double fraction) const {
  Eigen::AngleAxisd turn(rotation);
  turn.angle() *= fraction;
  return {center_t0, center_t0 + fraction * (center_t1 - center_t0), turn.toRotationMatrix()};
}

BodyPath path_of_body(const SurfaceMotion& s, const Vec3* displacement) {
  const BodyMotion& body = *s.body;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < s.x_t0.size(); ++i) {
    const Vec3 before = s.x_t0[i] - body.center_t0, after = s.x_t0[i] + displacement[i] - body.center_t1;
    covariance += after * before.transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double mirrored = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  const Vec3 signs(1, 1, mirrored < 0 ? -1 : 1);
  return {body.center_t0, body.center_t1, svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose()};
}

BodyPath path_of_body(const SurfaceMotion& s) {
  std::vector<Vec3> displacement;
  for (std::size_t i = 0; i < s.x_t1.size(); ++i) displacement.push_back(s.x_t1[i] - s.x_t0[i]);
  return path_of_body(s, displacement.data());
}

}  // namespace oilskin
