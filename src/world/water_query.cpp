#include "oilskin/water_query.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/refuse.h"
#include "fluid/kernels.h"

namespace oilskin {

namespace {

/// f(c) for the cells from `low` to `high`, each once. Far out, where doubles are farther apart than 1, they
/// are neighbours in double.
template <class F>
void for_cells(double low, double high, const F& f) {
  f(low);
  for (double c = low; c < high;) {
    c = c + 1 > c ? c + 1 : high;
    f(c);
  }
}

}  // namespace

WaterQuery::WaterQuery(const World& world)
    : position_(world.positions().begin(), world.positions().end()),
      motion_(world.motions().begin(), world.motions().end()),
      mass_(position_.size(), world.particle_mass()),
      support_radius_(world.fluid_settings().support_ratio * world.fluid_settings().spacing),
      spacing_(world.fluid_settings().spacing),
      rest_density_(world.fluid_settings().rest_density) {
  const Span<const float> ratio = world.mass_ratios();
  for (std::size_t i = 0; i < ratio.size(); ++i) mass_[i] *= static_cast<double>(ratio[i]);
  for (std::size_t i = 0; i < position_.size(); ++i)
    if (position_[i].allFinite()) cells_.emplace_back(cell_of(position_[i]), i);
  std::sort(cells_.begin(), cells_.end());
}

WaterQuery::Cell WaterQuery::cell_of(const Vec3& x) const {
  return {std::floor(x.x() / support_radius_), std::floor(x.y() / support_radius_),
          std::floor(x.z() / support_radius_)};
}

template <class Inside>
double WaterQuery::volume_where(const Inside& inside) const {
  double mass = 0;
  for (std::size_t i = 0; i < position_.size(); ++i)
    if (inside(position_[i])) mass += mass_[i];
  return mass / rest_density_;
}

Status WaterQuery::volume(const Box& box, double* cubic_metres) const {
  if (Status s = check_box(box); !s.ok()) return s;
  if (!cubic_metres) return Status::refused("the result is null");
  *cubic_metres = volume_where([&](const Vec3& x) { return box.contains(x); });
  return {};
}

Status WaterQuery::volume(const Vec3& center, double radius, double* cubic_metres) const {
  if (Status s = check_ball(center, radius); !s.ok()) return s;
  if (!cubic_metres) return Status::refused("the result is null");
  *cubic_metres = volume_where([&](const Vec3& x) { return (x - center).stableNorm() <= radius; });
  return {};
}

Status WaterQuery::sample(const Vec3& point, WaterSample* water) const {
  if (Status s = check_point("point", point); !s.ok()) return s;
  if (!water) return Status::refused("the result is null");
  const double h = support_radius_;
  const Cell low = cell_of(point - Vec3::Constant(h)), high = cell_of(point + Vec3::Constant(h));
  WaterSample sum;
  const auto add = [&](std::size_t i) {
    const double q = (position_[i] - point).norm() / h;
    if (!(q < 1)) return;
    const double part = mass_[i] * fluid::Poly6::norm / (h * h * h) * fluid::Poly6::w(q);
    sum.density += part;
    sum.velocity += part * motion_[i];
  };
  for_cells(low[0], high[0], [&](double x) {
    for_cells(low[1], high[1], [&](double y) {
      const Cell last = {x, y, high[2]};
      auto it =
          std::lower_bound(cells_.begin(), cells_.end(), std::make_pair(Cell{x, y, low[2]}, std::size_t{0}));
      for (; it != cells_.end() && it->first <= last; ++it) add(it->second);
    });
  });
  if (sum.density > 0) sum.velocity /= sum.density;
  *water = sum;
  return {};
}

Status WaterQuery::nearest(const Vec3& point, WaterHit* hit) const {
  if (Status s = check_point("point", point); !s.ok()) return s;
  if (!hit) return Status::refused("the result is null");
  *hit = {};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < position_.size(); ++i) {
    const double distance = (position_[i] - point).stableNorm();
    if (!(distance < least)) continue;
    least = distance;
    *hit = {true, i, position_[i], Vec3::Zero()};
  }
  return {};
}

Status WaterQuery::ray(const Vec3& from, const Vec3& to, WaterHit* hit) const {
  if (Status s = check_point("from", from); !s.ok()) return s;
  if (Status s = check_point("to", to); !s.ok()) return s;
  if (from == to) return refuse_value("to", to.transpose(), "another point than from");
  if (!hit) return Status::refused("the result is null");
  *hit = {};
  const double length = (to - from).stableNorm(), radius = 0.5 * spacing_;
  const Vec3 along = (to - from) / length;
  double first = length;
  for (std::size_t i = 0; i < position_.size(); ++i) {
    const Vec3 d = position_[i] - from;
    const double middle = d.dot(along), gap = (d - middle * along).squaredNorm();
    if (!(gap <= radius * radius)) continue;
    const double enters = middle - std::sqrt(radius * radius - gap);
    if (!(enters >= 0 && enters <= first) || (hit->found && enters == first)) continue;
    first = enters;
    const Vec3 place = from + enters * along;
    *hit = {true, i, place, (place - position_[i]).normalized()};
  }
  return {};
}

}  // namespace oilskin
