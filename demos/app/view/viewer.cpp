#include "view/viewer.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "scene/views.h"

namespace oilskin::demo {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double pi = 3.14159265358979323846;
constexpr double turn_per_pixel = pi / 600;
constexpr double zoom_per_step = 0.88;

}  // namespace

Viewer::Viewer(LiveScene& live, int width, int height)
    : live_(live), views_(views_of(live.scene())), width_(width), height_(height) {
  use_view(0);
}

void Viewer::use_view(std::size_t number) {
  view_ = number;
  const View& view = views_[number];
  camera_ = OrbitCamera(view);
  shown_.colour = view.colour;
  shown_.cut = view.slice.has_value();
  // Without a slice of the view a cut goes through its target, across the line of sight.
  shown_.slice = view.slice.value_or(Slice{view.target, (view.eye - view.target).normalized(), 0.01});
  if (shown_.slice.normal.dot(view.eye - shown_.slice.point) < 0) shown_.slice.normal *= -1;
}

int Viewer::left() const {
  return panel_ && width_ >= 2 * panel_width ? panel_width : 0;
}

Ray Viewer::ray(double x, double y) const {
  return camera_.ray(x - left(), y, width_ - left(), height_);
}

bool Viewer::grab(double x, double y, bool even_static) {
  let_go();
  const std::optional<Picked> picked =
      pick(live_.simulation(), live_.scene(), ray(x, y), shown_.bodies == BodyLook::solid);
  if (!picked || (picked->is_body && !even_static)) return false;
  Status status;
  if (picked->is_body)
    live_.simulation().grab_body(picked->index, picked->point);
  else
    status = live_.simulation().grab_cloth(picked->index, picked->point);
  if (!status.ok()) {
    message_ = status.message;
    return false;
  }
  plane_point_ = live_.simulation().grip()->place;
  plane_normal_ = camera_.axes().col(2);
  return true;
}

void Viewer::drag(double x, double y) {
  const std::optional<Vec3> goal = hit_on_plane(ray(x, y), plane_point_, plane_normal_);
  if (goal) live_.simulation().pull_to(*goal);
}

void Viewer::let_go() {
  live_.simulation().let_go();
}

void Viewer::orbit(double dx, double dy) {
  camera_.orbit(-dx * turn_per_pixel, dy * turn_per_pixel);
}

void Viewer::pan(double dx, double dy) {
  camera_.pan(-dx / height_, dy / height_);
}

void Viewer::zoom(double steps) {
  camera_.zoom(std::pow(zoom_per_step, steps));
}

void Viewer::resize(int width, int height) {
  width_ = std::max(width, 1);
  height_ = std::max(height, 1);
}

void Viewer::advance(double wall, double budget) {
  if (paused_) return;
  const Clock::time_point start = Clock::now();
  const double dt = live_.scene().dt;
  due_ += wall * speed_;
  while (due_ > 0.5 * dt) {
    const double before = live_.time();
    live_.step();
    due_ -= live_.time() - before;
    if (std::chrono::duration<double>(Clock::now() - start).count() < budget) continue;
    due_ = std::min(due_, 0.0);  // what this machine cannot make up is left out
    return;
  }
}

std::string Viewer::take_screenshot() {
  std::string file;
  file.swap(screenshot_);
  return file;
}

}  // namespace oilskin::demo
