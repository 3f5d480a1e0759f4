#include "core/body_path.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace oilskin {

BodyPath BodyPath::part(double fraction) const {
  Eigen::AngleAxisd turn(rotation);
  turn.angle() *= fraction;
  return {center_t0, center_t0 + fraction * (center_t1 - center_t0), turn.toRotationMatrix()};
}

namespace {

/// That takes before(i) to after(i), i < n, with the least squares of errors [Kabsch1976].
template <class Before, class After>
Eigen::Matrix3d rotation_between(std::size_t n, const Before& before, const After& after) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < n; ++i) covariance += after(i) * before(i).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double mirrored = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  const Vec3 signs(1, 1, mirrored < 0 ? -1 : 1);
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

Vec3 mean_of(const std::vector<Vec3>& x) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : x) sum += p;
  return sum / static_cast<double>(x.size());
}

}  // namespace

BodyPath path_of_body(const SurfaceMotion& s, const Vec3* displacement) {
  const BodyMotion& body = *s.body;
  const auto before = [&](std::size_t i) -> Vec3 { return s.x_t0[i] - body.center_t0; };
  const auto after = [&](std::size_t i) -> Vec3 { return s.x_t0[i] + displacement[i] - body.center_t1; };
  return {body.center_t0, body.center_t1, rotation_between(s.x_t0.size(), before, after)};
}

BodyPath path_of_body(const SurfaceMotion& s) {
  std::vector<Vec3> displacement;
  for (std::size_t i = 0; i < s.x_t1.size(); ++i) displacement.push_back(s.x_t1[i] - s.x_t0[i]);
  return path_of_body(s, displacement.data());
}

Vec3 center_at_start(const SurfaceMotion& s) {
  const Vec3 mean_t0 = mean_of(s.x_t0), mean_t1 = mean_of(s.x_t1);
  const auto before = [&](std::size_t i) -> Vec3 { return s.x_t0[i] - mean_t0; };
  const auto after = [&](std::size_t i) -> Vec3 { return s.x_t1[i] - mean_t1; };
  const BodyPath path = {mean_t0, mean_t1, rotation_between(s.x_t0.size(), before, after)};
  return path.start_of(s.body->center_t1);
}

}  // namespace oilskin
