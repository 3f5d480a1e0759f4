#include "fluid/boundary/wall_integral.h"

#include <cmath>

#include "core/assert.h"
#include "fluid/kernels.h"

namespace oilskin::fluid {

WallPlane::WallPlane(const std::array<Eigen::Vector3f, 3>& x) {
  const Eigen::Vector3f cross = (x[1] - x[0]).cross(x[2] - x[0]);
  const float area2 = cross.norm();
  const float longest =
      std::max({(x[1] - x[0]).squaredNorm(), (x[2] - x[0]).squaredNorm(), (x[2] - x[1]).squaredNorm()});
  if (!(area2 > 1e-6f * longest)) return;
  normal = cross / area2;
  offset = normal.dot(x[0]);
}

void Shadows::clear() {
  edges_ = 0;
  end_.clear();
}

void Shadows::add(const WallPlane& plane, Span<const Eigen::Vector3f> polygon) {
  const float z = plane.distance(), mass = half_space_mass(z);
  if (8 * blocks_.size() < edges_ + polygon.size()) blocks_.resize((edges_ + polygon.size()) / 8 + 8);
  for (std::size_t k = 0; k < polygon.size(); ++k, ++edges_) {
    EdgeBlock& block = blocks_[edges_ / 8];
    const std::size_t lane = edges_ % 8;
    const Eigen::Vector3f &u = polygon[k], &v = polygon[k + 1 < polygon.size() ? k + 1 : 0];
    for (int axis = 0; axis < 3; ++axis) {
      block.from[axis][lane] = u[axis];
      block.to[axis][lane] = v[axis];
      block.normal[axis][lane] = plane.normal[axis];
    }
    block.distance[lane] = z;
    block.mass[lane] = mass;
  }
  end_.push_back(edges_);
}

void Shadows::integrate() {
  integral_.resize(edges_);
  pair_kernels().edges(blocks_.data(), edges_, integral_.data());
}

float Shadows::operator[](std::size_t k) const {
  float sum = 0;
  for (std::size_t e = k == 0 ? 0 : end_[k - 1]; e < end_[k]; ++e) sum += integral_[e];
  return sum;
}

WallView view_with_shadow(const WallPlane& plane, float shadow) {
  WallView view;
  const float mass = static_cast<float>(2 * pi) * half_space_mass(plane.distance());
  OILSKIN_ASSERT(plane.acts() && mass > 0);
  view.distance = plane.distance();
  view.share = std::clamp(shadow / mass, 0.0f, 1.0f);
  view.normal = plane.to_particle();
  return view;
}

}  // namespace oilskin::fluid
