/// A camera that turns about a point.
#pragma once

#include <Eigen/Core>

#include "scene/scene.h"

namespace oilskin::demo {

struct Ray {
  Vec3 origin = Vec3::Zero();
  Vec3 direction = Vec3(0, 0, -1);  ///< unit
};

/// Looks from `eye()` at `target`. Pixels count from the upper left corner of the picture.
class OrbitCamera {
 public:
  OrbitCamera() = default;
  /// What a view of a scene shows; one without perspective becomes one whose picture has the same height at
  /// the target.
  explicit OrbitCamera(const View& view);

  /// Turns about the target [radians]; the height above the horizon stays within ± 89°.
  void orbit(double sideways, double upwards);
  /// Moves the target across the line of sight, by fractions of the picture's height.
  void pan(double right, double up);
  /// Multiplies the distance from the target; it stays within 1 mm … 1 km.
  void zoom(double factor);

  Vec3 eye() const;
  const Vec3& target() const { return target_; }
  double distance() const { return distance_; }
  /// Unit vectors of the picture: right, up, and towards the eye.
  Eigen::Matrix3d axes() const;
  /// From the world to the eye's axes.
  Eigen::Matrix4d view() const;
  /// To OpenGL's clip coordinates; `aspect`: width over height.
  Eigen::Matrix4d projection(double aspect) const;
  /// Through the middle of a pixel.
  Ray ray(double x, double y, int width, int height) const;
  /// Where a point is in the picture [pixels], and its distance along the line of sight [m]; a point behind
  /// the eye has a negative one.
  Vec3 pixel(const Vec3& point, int width, int height) const;

 private:
  Vec3 target_ = Vec3::Zero(), up_ = Vec3(0, 1, 0);
  double distance_ = 1, azimuth_ = 0, elevation_ = 0;  ///< [m], [radians]
  double angle_ = 30;                                  ///< of sight, vertical [degrees]
};

}  // namespace oilskin::demo
