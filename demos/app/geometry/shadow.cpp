#include "geometry/shadow.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

namespace oilskin::demo {
namespace {

constexpr int bins_per_side = 64;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

int place(double x, double from, double to) {
  const double f = to > from ? (x - from) / (to - from) : 0;
  return std::clamp(static_cast<int>(f * bins_per_side), 0, bins_per_side - 1);
}

}  // namespace

Shadow::Shadow(const SurfaceMotion& cloth, const Vec3& down) : up_(-down.normalized()) {
  u_ = up_.unitOrthogonal();
  v_ = up_.cross(u_);
  min_.setConstant(std::numeric_limits<double>::infinity());
  max_ = -min_;
  for (const Vec3& x : cloth.x_t1) {
    min_ = min_.cwiseMin(flat(x));
    max_ = max_.cwiseMax(flat(x));
  }
  bins_.resize(bins_per_side * bins_per_side);
  std::map<std::array<std::uint32_t, 2>, int> edges;
  for (const Triangle& t : cloth.triangles) {
    const Vec3 &a = cloth.x_t1[t[0]], &b = cloth.x_t1[t[1]], &c = cloth.x_t1[t[2]];
    triangles_.push_back({flat(a), flat(b), flat(c), a.dot(up_), b.dot(up_), c.dot(up_)});
    const Point low = flat(a).cwiseMin(flat(b)).cwiseMin(flat(c)),
                high = flat(a).cwiseMax(flat(b)).cwiseMax(flat(c));
    for (int j = place(low.y(), min_.y(), max_.y()); j <= place(high.y(), min_.y(), max_.y()); ++j)
      for (int i = place(low.x(), min_.x(), max_.x()); i <= place(high.x(), min_.x(), max_.x()); ++i)
        bins_[j * bins_per_side + i].push_back(static_cast<std::uint32_t>(triangles_.size() - 1));
    for (int k = 0; k < 3; ++k) ++edges[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}];
  }
  for (const auto& [edge, count] : edges)
    if (count == 1) border_.push_back({flat(cloth.x_t1[edge[0]]), flat(cloth.x_t1[edge[1]])});
}

bool Shadow::below(const Point& p, double height) const {
  if ((p.array() < min_.array()).any() || (p.array() > max_.array()).any()) return false;
  const int i = place(p.x(), min_.x(), max_.x()), j = place(p.y(), min_.y(), max_.y());
  for (const std::uint32_t t : bins_[j * bins_per_side + i]) {
    const Flat& f = triangles_[t];
    const double area = cross(f.b - f.a, f.c - f.a);
    if (area == 0) continue;
    const double wb = cross(p - f.a, f.c - f.a) / area, wc = cross(f.b - f.a, p - f.a) / area;
    if (wb < 0 || wc < 0 || wb + wc > 1) continue;
    if (height < (1 - wb - wc) * f.height_a + wb * f.height_b + wc * f.height_c) return true;
  }
  return false;
}

bool Shadow::covers(const Vec3& x, double margin) const {
  const Point p = flat(x);
  if (!below(p, x.dot(up_))) return false;
  for (const auto& [a, b] : border_) {
    const Point edge = b - a;
    const double s =
        edge.squaredNorm() > 0 ? std::clamp((p - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0) : 0;
    if ((a + s * edge - p).norm() < margin) return false;
  }
  return true;
}

}  // namespace oilskin::demo
