#include "view/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace oilskin::demo {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double max_elevation = 89 * pi / 180;
constexpr double parallel_angle = 15;  // of sight for views without perspective [degrees]

/// Half of the picture's height at distance 1.
double half_height(double angle) {
  return std::tan(0.5 * angle * pi / 180);
}

}  // namespace

OrbitCamera::OrbitCamera(const View& view) : target_(view.target), up_(view.up.normalized()) {
  Vec3 sight = view.eye - view.target;
  if (!(sight.norm() > 0)) sight = up_.unitOrthogonal();
  angle_ = view.orthographic > 0 ? parallel_angle : view.angle;
  distance_ = view.orthographic > 0 ? 0.5 * view.orthographic / half_height(angle_) : sight.norm();
  sight.normalize();
  const Vec3 a = up_.unitOrthogonal(), b = up_.cross(a);
  elevation_ = std::clamp(std::asin(std::clamp(sight.dot(up_), -1.0, 1.0)), -max_elevation, max_elevation);
  azimuth_ = std::atan2(sight.dot(b), sight.dot(a));
}

void OrbitCamera::orbit(double sideways, double upwards) {
  azimuth_ = std::remainder(azimuth_ + sideways, 2 * pi);
  elevation_ = std::clamp(elevation_ + upwards, -max_elevation, max_elevation);
}

void OrbitCamera::pan(double right, double up) {
  const double height = 2 * distance_ * half_height(angle_);
  const Eigen::Matrix3d axis = axes();
  target_ += height * (right * axis.col(0) + up * axis.col(1));
}

void OrbitCamera::zoom(double factor) {
  distance_ = std::clamp(distance_ * factor, 1e-3, 1e3);
}

Eigen::Matrix3d OrbitCamera::axes() const {
  const Vec3 a = up_.unitOrthogonal(), b = up_.cross(a);
  const Vec3 level = std::cos(azimuth_) * a + std::sin(azimuth_) * b;
  Eigen::Matrix3d axis;
  axis.col(2) = std::cos(elevation_) * level + std::sin(elevation_) * up_;
  axis.col(0) = up_.cross(axis.col(2)).normalized();
  axis.col(1) = axis.col(2).cross(axis.col(0));
  return axis;
}

Vec3 OrbitCamera::eye() const {
  return target_ + distance_ * axes().col(2);
}

Eigen::Matrix4d OrbitCamera::view() const {
  const Eigen::Matrix3d turned = axes().transpose();
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = turned;
  matrix.topRightCorner<3, 1>() = -turned * eye();
  return matrix;
}

Eigen::Matrix4d OrbitCamera::projection(double aspect) const {
  const double near = 0.02 * distance_, far = 50 * distance_, scale = 1 / half_height(angle_);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  matrix(0, 0) = scale / aspect;
  matrix(1, 1) = scale;
  matrix(2, 2) = -(far + near) / (far - near);
  matrix(2, 3) = -2 * far * near / (far - near);
  matrix(3, 2) = -1;
  return matrix;
}

Ray OrbitCamera::ray(double x, double y, int width, int height) const {
  const double pixel = 2 * half_height(angle_) / height;
  const Eigen::Matrix3d axis = axes();
  const Vec3 along =
      (x + 0.5 - 0.5 * width) * pixel * axis.col(0) - (y + 0.5 - 0.5 * height) * pixel * axis.col(1);
  return {eye(), (along - axis.col(2)).normalized()};
}

Vec3 OrbitCamera::pixel(const Vec3& point, int width, int height) const {
  const Vec3 seen = axes().transpose() * (point - eye());
  const double size = 2 * half_height(angle_) / height * -seen.z();
  return {seen.x() / size + 0.5 * width - 0.5, -seen.y() / size + 0.5 * height - 0.5, -seen.z()};
}

}  // namespace oilskin::demo
