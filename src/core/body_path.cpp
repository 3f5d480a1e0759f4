#include "core/body_path.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "core/assert.h"

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

Vec3 mean_of(Span<const Vec3> x) {
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

std::optional<BodyPath> rigid_motion_between(Span<const Vec3> from, Span<const Vec3> to, double tolerance) {
  OILSKIN_ASSERT(from.size() == to.size());
  if (from.empty()) return {};
  const Vec3 mean_from = mean_of(from), mean_to = mean_of(to);
  const auto before = [&](std::size_t i) -> Vec3 { return from[i] - mean_from; };
  const auto after = [&](std::size_t i) -> Vec3 { return to[i] - mean_to; };
  const BodyPath path = {mean_from, mean_to, rotation_between(from.size(), before, after)};
  for (std::size_t i = 0; i < from.size(); ++i)
    if (!((path.end_of(from[i]) - to[i]).cwiseAbs().maxCoeff() <= tolerance)) return {};
  return path;
}

double rounding_of(const SurfaceMotion& m) {
  double largest = 0;
  for (const std::vector<Vec3>* nodes : {&m.x_t0, &m.x_t1})
    for (const Vec3& x : *nodes) largest = std::max(largest, x.cwiseAbs().maxCoeff());
  return 16 * epsilon_of(m.storage) * largest;
}

std::optional<BodyPath> turn_between(Span<const Vec3> from, Span<const Vec3> to, double tolerance) {
  constexpr double least_angle = 1e-3;  // [rad]; chords are off by an eighth of its square
  std::optional<BodyPath> path = rigid_motion_between(from, to, tolerance);
  if (!path) return {};
  const Eigen::AngleAxisd turn(path->rotation);
  if (!(turn.angle() >= least_angle)) return {};
  const Vec3 shift = path->center_t1 - path->center_t0;
  const Vec3 along = turn.axis().dot(shift) * turn.axis(), across = shift - along;
  path->center_t0 += 0.5 * (across + turn.axis().cross(across) / std::tan(0.5 * turn.angle()));
  path->center_t1 = path->center_t0 + along;
  return path;
}

bool all_prescribed(const SurfaceMotion& m) {
  return !m.body &&
         std::all_of(m.inverse_mass.begin(), m.inverse_mass.end(), [](double u) { return u == 0; });
}

Vec3 center_at_start(const SurfaceMotion& s) {
  const Vec3 mean_t0 = mean_of(s.x_t0), mean_t1 = mean_of(s.x_t1);
  const auto before = [&](std::size_t i) -> Vec3 { return s.x_t0[i] - mean_t0; };
  const auto after = [&](std::size_t i) -> Vec3 { return s.x_t1[i] - mean_t1; };
  const BodyPath path = {mean_t0, mean_t1, rotation_between(s.x_t0.size(), before, after)};
  return path.start_of(s.body->center_t1);
}

}  // namespace oilskin
