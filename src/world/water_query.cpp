#include "oilskin/water_query.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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

/// f(i) for the particles in the cells around a ball of radius up to H.
template <class F>
void WaterQuery::visit_cells(const Vec3& point, double radius, const F& f) const {
  const Cell low = cell_of(point - Vec3::Constant(radius)), high = cell_of(point + Vec3::Constant(radius));
  for_cells(low[0], high[0], [&](double x) {
    for_cells(low[1], high[1], [&](double y) {
      const Cell last = {x, y, high[2]};
      auto it =
          std::lower_bound(cells_.begin(), cells_.end(), std::make_pair(Cell{x, y, low[2]}, std::size_t{0}));
      for (; it != cells_.end() && it->first <= last; ++it) f(it->second);
    });
  });
}

/// poly6 [1/m³].
double WaterQuery::kernel(double distance) const {
  const double h = support_radius_, q = distance / h;
  return q < 1 ? fluid::Poly6::norm / (h * h * h) * fluid::Poly6::w(q) : 0;
}

Status WaterQuery::sample(const Vec3& point, WaterSample* water) const {
  if (Status s = check_point("point", point); !s.ok()) return s;
  if (!water) return Status::refused("the result is null");
  WaterSample sum;
  visit_cells(point, support_radius_, [&](std::size_t i) {
    const double part = mass_[i] * kernel((position_[i] - point).norm());
    if (part == 0) return;
    sum.density += part;
    sum.velocity += part * motion_[i];
  });
  if (sum.density > 0) sum.velocity /= sum.density;
  *water = sum;
  return {};
}

Status WaterQuery::is_near(const Vec3& point, double distance, bool* is) const {
  if (Status s = check_ball(point, distance); !s.ok()) return s;
  if (!is) return Status::refused("the result is null");
  bool found = false;
  const auto look = [&](std::size_t i) { found |= (position_[i] - point).norm() <= distance; };
  if (distance <= support_radius_)
    visit_cells(point, distance, look);
  else
    for (std::size_t i = 0; i < position_.size() && !found; ++i) look(i);
  *is = found;
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

namespace {

constexpr double search_step = 0.125;  // of the spacing; the density varies over twice the spacing
constexpr int bisections = 40;

/// The highest place with is_water(place). There is none above `start`.
template <class IsWater>
std::optional<double> find_highest(double start, double end, double step, const IsWater& is_water) {
  const auto steps = static_cast<int>(std::ceil((start - end) / step));
  for (int i = 0; i < steps; ++i) {
    double at = start - i * step;
    if (!is_water(at)) continue;
    double above = at + step;
    for (int k = 0; k < bisections; ++k) {
      const double middle = 0.5 * (at + above);
      (is_water(middle) ? at : above) = middle;
    }
    return at;
  }
  return {};
}

}  // namespace

/// Particles within H of the line through `point` along the unit vector `up`, highest first.
std::vector<WaterQuery::Beside> WaterQuery::beside_line(const Vec3& point, const Vec3& up) const {
  std::vector<Beside> beside;
  for (std::size_t i = 0; i < position_.size(); ++i) {
    const Vec3 d = position_[i] - point;
    const double along = d.dot(up), squared = (d - along * up).squaredNorm();
    if (squared < support_radius_ * support_radius_) beside.push_back({along, squared, mass_[i]});
  }
  std::sort(beside.begin(), beside.end(), [](const Beside& a, const Beside& b) { return a.along > b.along; });
  return beside;
}

double WaterQuery::density_on_line(const std::vector<Beside>& beside, double at) const {
  const double top = at + support_radius_, bottom = at - support_radius_;
  double density = 0;
  auto it =
      std::partition_point(beside.begin(), beside.end(), [top](const Beside& b) { return b.along > top; });
  for (; it != beside.end() && it->along > bottom; ++it)
    density += it->mass * kernel(std::sqrt(it->squared_distance + (it->along - at) * (it->along - at)));
  return density;
}

Status WaterQuery::level(const Vec3& point, const Vec3& up, double* s, bool* found) const {
  if (Status status = check_point("point", point); !status.ok()) return status;
  const double length = up.stableNorm();
  if (!(length > 0 && std::isfinite(length)))
    return refuse_value("up", up.transpose(), "a vector of finite length > 0");
  if (!s || !found) return Status::refused("the result is null");
  const std::vector<Beside> beside = beside_line(point, up / length);
  const auto is_water = [&](double at) { return density_on_line(beside, at) >= 0.5 * rest_density_; };
  std::optional<double> highest;
  double start = std::numeric_limits<double>::infinity();
  for (const Beside& b : beside) {  // between particles farther apart than 2 H there is no water
    start = std::min(start, b.along + support_radius_);
    const double end = b.along - support_radius_;
    highest = find_highest(start, end, search_step * spacing_, is_water);
    if (highest) break;
    start = std::min(start, end + search_step * spacing_);
  }
  *found = highest.has_value();
  *s = highest.value_or(0);
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
