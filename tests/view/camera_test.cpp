// The camera of the window: what is seen where, and back.
#include "view/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace oilskin::demo {
namespace {

constexpr int width = 640, height = 480;

View view_from(const Vec3& eye, const Vec3& target) {
  View view;
  view.eye = eye;
  view.target = target;
  return view;
}

TEST(OrbitCamera, a_view_of_a_scene_is_taken_over) {
  for (const Vec3& eye : {Vec3(0.5, 0.4, 0.7), Vec3(-0.2, -0.9, 0.1), Vec3(1, 0, 0)}) {
    const OrbitCamera camera(view_from(eye, Vec3(0.1, 0.2, -0.1)));
    EXPECT_LT((camera.eye() - eye).norm(), 1e-12);
    const Vec3 middle = camera.pixel(camera.target(), width, height);
    EXPECT_NEAR(middle.x(), 0.5 * width - 0.5, 1e-9);
    EXPECT_NEAR(middle.y(), 0.5 * height - 0.5, 1e-9);
  }
}

TEST(OrbitCamera, a_view_straight_down_is_nearly_straight_down) {
  const OrbitCamera camera(view_from(Vec3(0, 2, 0), Vec3::Zero()));
  EXPECT_LT((camera.eye() - Vec3(0, 2, 0)).norm(), 2 * 0.02);
  EXPECT_TRUE(camera.view().allFinite());
}

TEST(OrbitCamera, a_view_without_perspective_shows_its_height_at_the_target) {
  View view = view_from(Vec3(0, 0, 1), Vec3(0, 0.1, 0));
  view.orthographic = 0.4;
  const OrbitCamera camera(view);
  const Vec3 top = camera.pixel(camera.target() + 0.2 * camera.axes().col(1), width, height);
  EXPECT_NEAR(top.y(), -0.5, 1e-9);
}

TEST(OrbitCamera, rays_go_through_what_their_pixel_shows) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-0.3, 0.3);
  OrbitCamera camera(view_from(Vec3(0.9, 0.5, 0.8), Vec3(0.1, 0, 0)));
  for (int k = 0; k < 200; ++k) {
    camera.orbit(number(random), number(random));
    const Vec3 point(number(random), number(random), number(random));
    const Vec3 pixel = camera.pixel(point, width, height);
    const Ray ray = camera.ray(pixel.x(), pixel.y(), width, height);
    const Vec3 way = point - ray.origin;
    EXPECT_LT((way - way.dot(ray.direction) * ray.direction).norm(), 1e-12);
    EXPECT_GT(way.dot(ray.direction), 0);
  }
}

TEST(OrbitCamera, the_matrices_show_points_where_the_pixels_are) {
  OrbitCamera camera(view_from(Vec3(0.9, 0.5, 0.8), Vec3(0.1, 0, 0)));
  const Vec3 point(0.2, -0.1, 0.15);
  const Eigen::Vector4d clip =
      camera.projection(double(width) / height) * camera.view() * point.homogeneous();
  const Vec3 pixel = camera.pixel(point, width, height);
  EXPECT_NEAR((0.5 + 0.5 * clip.x() / clip.w()) * width - 0.5, pixel.x(), 1e-9);
  EXPECT_NEAR((0.5 - 0.5 * clip.y() / clip.w()) * height - 0.5, pixel.y(), 1e-9);
  EXPECT_NEAR(clip.w(), pixel.z(), 1e-12);
  EXPECT_LT(std::abs(clip.z() / clip.w()), 1);
}

TEST(OrbitCamera, turning_keeps_distance_and_target_and_never_turns_over) {
  OrbitCamera camera(view_from(Vec3(0.9, 0.5, 0.8), Vec3(0.1, 0, 0)));
  const Vec3 eye = camera.eye();
  const double distance = camera.distance();
  camera.orbit(2 * 3.14159265358979323846, 0);
  EXPECT_LT((camera.eye() - eye).norm(), 1e-9);
  camera.orbit(0.4, 10);
  EXPECT_NEAR((camera.eye() - camera.target()).norm(), distance, 1e-12);
  EXPECT_GT(camera.axes().col(1).y(), 0) << "up is up in the picture";
  camera.orbit(0, -20);
  EXPECT_GT(camera.axes().col(1).y(), 0);
  EXPECT_NEAR((camera.axes().transpose() * camera.axes() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
}

TEST(OrbitCamera, a_pan_moves_the_picture_by_its_fraction_of_the_height) {
  OrbitCamera camera(view_from(Vec3(0.9, 0.5, 0.8), Vec3(0.1, 0, 0)));
  const Vec3 point = camera.target();
  camera.pan(0.25, -0.125);
  const Vec3 pixel = camera.pixel(point, width, height);
  EXPECT_NEAR(pixel.x(), 0.5 * width - 0.5 - 0.25 * height, 1e-9);
  EXPECT_NEAR(pixel.y(), 0.5 * height - 0.5 - 0.125 * height, 1e-9);
}

TEST(OrbitCamera, the_distance_stays_within_its_limits) {
  OrbitCamera camera(view_from(Vec3(0, 0, 1), Vec3::Zero()));
  camera.zoom(0.5);
  EXPECT_NEAR(camera.distance(), 0.5, 1e-12);
  camera.zoom(1e-9);
  EXPECT_EQ(camera.distance(), 1e-3);
  camera.zoom(1e12);
  EXPECT_EQ(camera.distance(), 1e3);
}

}  // namespace
}  // namespace oilskin::demo
