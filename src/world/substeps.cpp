#include "world/substeps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/assert.h"
#include "core/body_path.h"
#include "core/chunks.h"

namespace oilskin::world {

int substep_count(const Speeds& speeds, double dt, double distance, int maximum) {
  OILSKIN_ASSERT(dt > 0 && distance > 0 && maximum >= 1);
  const double fluid = speeds.fluid + speeds.gravity * dt;
  const double by_speed = std::ceil(dt * std::max(fluid, speeds.surfaces) / distance);
  const double by_change = parts_needed(dt, longest_step({speeds.fluid, speeds.change, 0, 0}, distance));
  const double parts = std::max(by_speed, by_change);
  return parts < maximum ? std::max(1, static_cast<int>(parts)) : maximum;
}

double parts_needed(double dt, double longest) {
  OILSKIN_ASSERT(dt > 0 && longest >= 0);
  return std::max(1.0, std::ceil(dt / longest * (1 - 1e-12)));
}

double longest_step(const Speeds& speeds, double distance) {
  OILSKIN_ASSERT(distance > 0 && speeds.fluid >= 0 && speeds.gravity >= 0 && speeds.surfaces >= 0);
  // The root of dt (v + g dt) = distance, in the form without cancellation.
  const double slope = speeds.fluid + std::sqrt(speeds.fluid * speeds.fluid + 4 * speeds.gravity * distance);
  double longest = std::numeric_limits<double>::infinity();
  if (slope > 0) longest = 2 * distance / slope;
  if (speeds.surfaces > 0) longest = std::min(longest, distance / speeds.surfaces);
  return longest;
}

bool has_free_nodes(Span<SurfaceMotion* const> surfaces, const Box& water) {
  return std::any_of(surfaces.begin(), surfaces.end(), [&](const SurfaceMotion* s) {
    if (s->still != 0 || s->body ||
        std::none_of(s->inverse_mass.begin(), s->inverse_mass.end(), [](double m) { return m > 0; }))
      return false;
    Box swept;
    for (const std::vector<Vec3>* nodes : {&s->x_t0, &s->x_t1})
      for (const Vec3& x : *nodes) swept.add(x);
    return swept.overlaps(water);
  });
}

namespace {

/// Which of many layers have something in them.
class Layers {
 public:
  static constexpr std::size_t count = 4096;

  void mark(std::size_t first, std::size_t last) {
    for (std::size_t k = first; k <= last; ++k) words_[k / 64] |= std::uint64_t(1) << (k % 64);
  }
  void operator+=(const Layers& o) {
    for (std::size_t w = 0; w < words_.size(); ++w) words_[w] |= o.words_[w];
  }
  /// From a layer with something in it to another, with at most `empty` layers in a row between them.
  std::size_t longest_run(std::size_t empty) const {
    std::size_t longest = 0, first = 0, last = count;  // last: none yet
    for (std::size_t k = 0; k < count; ++k) {
      if ((words_[k / 64] >> (k % 64) & 1) == 0) continue;
      if (last == count || k - last > empty + 1) first = k;
      last = k;
      longest = std::max(longest, last - first + 1);
    }
    return longest;
  }

 private:
  std::array<std::uint64_t, count / 64> words_{};
};

/// From the lowest to the highest corner along `up`.
std::pair<double, double> extent_of(const Box& box, const Vec3& up) {
  const Vec3 a = box.min.cwiseProduct(up), b = box.max.cwiseProduct(up);
  return {a.cwiseMin(b).sum(), a.cwiseMax(b).sum()};
}

}  // namespace

double tallest_part(Span<const Vec3> points, const Box& box, const Box& bounds, const Vec3& up, double gap,
                    const Workers& workers) {
  constexpr std::size_t chunk = 8192, layers_of_gap = 4;
  const auto [low, high] = extent_of(bounds, up);
  const double layer = std::max(gap / layers_of_gap, (high - low) / (Layers::count - 1));
  OILSKIN_ASSERT(gap > 0 && std::isfinite(layer));
  const auto layer_of = [&, low = low](double height) {
    return static_cast<std::size_t>(std::clamp((height - low) / layer, 0.0, Layers::count - 1.0));
  };
  Layers layers =
      workers.ordered_sum(points.size(), chunk, Layers(), [&](std::size_t begin, std::size_t end) {
        Layers part;
        for (std::size_t i = begin; i < end; ++i) {
          if (!bounds.contains(points[i])) continue;
          const std::size_t k = layer_of(up.dot(points[i]));
          part.mark(k, k);
        }
        return part;
      });
  if (box.min.x() <= box.max.x()) {
    const auto [bottom, top] = extent_of(box, up);
    layers.mark(layer_of(bottom), layer_of(top));
  }
  return std::min(high - low, static_cast<double>(layers.longest_run(layers_of_gap)) * layer);
}

namespace {

constexpr std::size_t triangle_chunk = 512;

/// Squared, of a node of one of the triangles begin … end − 1 that sweep through `water`.
double longest_path(const SurfaceMotion& s, const Box& water, std::size_t begin, std::size_t end) {
  double longest = 0;
  for (std::size_t t = begin; t < end; ++t) {
    Box swept;
    double distance = 0;
    for (std::uint32_t node : s.triangles[t]) {
      swept.add(s.x_t0[node]);
      swept.add(s.x_t1[node]);
      distance = std::max(distance, (s.x_t1[node] - s.x_t0[node]).squaredNorm());
    }
    if (distance > longest && swept.overlaps(water)) longest = distance;
  }
  return longest;
}

}  // namespace

double fastest_node(Span<SurfaceMotion* const> surfaces, const Box& water, double dt,
                    const Workers& workers) {
  OILSKIN_ASSERT(dt > 0);
  Largest longest;  // squared
  for (const SurfaceMotion* s : surfaces)
    if (s->still == 0)
      longest += workers.ordered_sum(
          s->triangles.size(), triangle_chunk, Largest(),
          [&](std::size_t begin, std::size_t end) { return Largest{longest_path(*s, water, begin, end)}; });
  return std::sqrt(longest.value) / dt;
}

void SurfacePaths::begin(Span<SurfaceMotion* const> surfaces, int parts, double length) {
  OILSKIN_ASSERT(parts >= 1 && length > 0);
  paths_.clear();
  parts_ = left_ = parts;
  length_ = length;
  for (SurfaceMotion* s : surfaces) {
    paths_.emplace_back();
    paths_.back().motion = s;
    if (parts == 1 || s->still != 0) continue;
    Path& path = paths_.back();
    path.start = s->x_t0;
    path.target = s->x_t1;
    path.velocity = s->velocity;
    if (path.start != path.target && all_prescribed(*s))
      path.turn = turn_between(path.start, path.target, rounding_of(*s));
    if (!s->body) continue;
    path.center = s->body->center_t0;
    path.center_target = s->body->center_t1;
  }
}

void SurfacePaths::next() {
  OILSKIN_ASSERT(left_ > 0);
  if (parts_ == 1) {
    left_ = 0;
    return;
  }
  for (Path& path : paths_) {
    if (left_ < parts_) continue_from_certified(path);
    SurfaceMotion& m = *path.motion;
    if (m.body && left_ > 1) {
      move_body(path);
      continue;
    }
    if (path.turn) {
      turn(path);
      continue;
    }
    for (std::size_t i = 0; i < path.target.size(); ++i)
      m.x_t1[i] =
          left_ == 1 ? path.target[i] : stored(m.x_t0[i] + (path.target[i] - m.x_t0[i]) / left_, m.storage);
    if (m.body) m.body->center_t1 = path.center_target;
  }
  --left_;
}

/// On straight lines the hull would be smaller in between, and would stay so where contact holds the body.
void SurfacePaths::move_body(const Path& path) const {
  SurfaceMotion& m = *path.motion;
  m.x_t1 = path.target;
  m.body->center_t1 = path.center_target;
  const BodyPath whole = path_of_body(m), part = whole.part(1.0 / left_);
  for (std::size_t i = 0; i < path.target.size(); ++i) {
    const Vec3 unturned = whole.start_of(path.target[i]);  // x_t0, unless the host changed the shape
    m.x_t1[i] = stored(part.end_of(m.x_t0[i] + (unturned - m.x_t0[i]) / left_), m.storage);
  }
  m.body->center_t1 = part.center_t1;
}

/// On straight lines a drum would be smaller in between. Its velocities turn with it: that of the part
/// replaces that of the step in what the host gave.
void SurfacePaths::turn(Path& path) const {
  SurfaceMotion& m = *path.motion;
  const double parts = parts_, done = parts_ - left_ + 1;
  const BodyPath part = path.turn->part(done / parts);
  for (std::size_t i = 0; i < path.target.size(); ++i) {
    m.x_t1[i] = left_ == 1 ? path.target[i] : stored(part.end_of(path.start[i]), m.storage);
    m.velocity[i] =
        path.velocity[i] + (m.x_t1[i] - m.x_t0[i] - (path.target[i] - path.start[i]) / parts) / length_;
  }
}

/// Contact holds a node: the others go on straight to where the host wants them, as it catches up.
void SurfacePaths::stop_turning(Path& path) {
  path.turn.reset();
  path.motion->velocity = path.velocity;
  path.before = SurfaceMotion();
}

const SurfaceMotion* SurfacePaths::part_before(std::size_t k) const {
  OILSKIN_ASSERT(k < paths_.size());
  return paths_[k].before.x_t1.empty() ? nullptr : &paths_[k].before;
}

/// Over a step the speed is that of its middle: it turns on by half a step less half a part.
const SurfaceMotion* SurfacePaths::step_before(std::size_t k, const SurfaceMotion& before, double dt) {
  OILSKIN_ASSERT(k < paths_.size());
  Path& path = paths_[k];
  if (!path.turn || !(dt > 0) || before.x_t1.size() != path.start.size()) return &before;
  const Eigen::Matrix3d onwards = path.turn->part(0.5 - 0.5 / parts_).rotation;
  path.before.id = before.id;
  path.before.x_t0.clear();
  for (std::size_t i = 0; i < path.start.size(); ++i)
    path.before.x_t0.push_back(path.start[i] - onwards * (before.x_t1[i] - before.x_t0[i]));
  path.before.x_t1 = path.start;
  return &path.before;
}

namespace {

/// Of the impulses of the interval.
Vec3 moment_of(const SurfaceMotion& m) {
  Vec3 moment = Vec3::Zero();
  for (const std::uint32_t node : m.touched) moment += m.x_t0[node].cross(m.impulse[node]);
  return moment;
}

}  // namespace

/// impulses += those of the interval, which come first in each sum.
void SurfacePaths::sum_impulses(Path& path) const {
  path.moment += moment_of(*path.motion);
  if (parts_ == 1) return;
  const SurfaceMotion& m = *path.motion;
  std::vector<std::pair<std::uint32_t, Vec3>> sums;
  sums.reserve(path.impulses.size() + m.touched.size());
  auto before = path.impulses.begin();
  for (std::uint32_t node : m.touched) {
    for (; before != path.impulses.end() && before->first < node; ++before) sums.push_back(*before);
    const bool is_there = before != path.impulses.end() && before->first == node;
    sums.emplace_back(node, m.impulse[node]);
    if (is_there) sums.back().second += (before++)->second;
  }
  sums.insert(sums.end(), before, path.impulses.end());
  path.impulses.swap(sums);
}

void SurfacePaths::continue_from_certified(Path& path) const {
  SurfaceMotion& m = *path.motion;
  OILSKIN_ASSERT(m.impulse.size() == m.x_t1.size());
  sum_impulses(path);
  if (m.still != 0) return;
  OILSKIN_ASSERT(path.target.size() == m.x_t1.size());
  if (path.turn) {
    path.before.id = m.id;
    path.before.x_t0 = m.x_t0;
    path.before.x_t1 = m.x_t1;
    if (std::any_of(m.touched.begin(), m.touched.end(), [&](std::uint32_t i) { return m.moved[i] != 0; }))
      stop_turning(path);
  }
  m.x_t0 = m.x_t1;
  if (m.smooth) m.velocity_t0 = m.velocity;
  if (m.body) {
    m.body->center_t0 = m.body->center_t1;
    return;
  }
  // A prescribed node that was held has a longer displacement in less time; its velocity is that.
  for (std::uint32_t i : m.touched)
    if (m.moved[i] && m.inverse_mass[i] == 0)
      m.velocity[i] = (path.target[i] - m.x_t0[i]) / (left_ * length_);
}

void SurfacePaths::end() {
  OILSKIN_ASSERT(left_ == 0);
  for (Path& path : paths_) end(path);
}

void SurfacePaths::end(Path& path) const {
  SurfaceMotion& m = *path.motion;
  sum_impulses(path);
  m.angular_impulse = path.moment;
  if (parts_ == 1) return;
  m.touched.clear();
  for (const auto& [node, impulse] : path.impulses) {
    m.impulse[node] = impulse;
    m.touched.push_back(node);
  }
  if (m.still != 0) return;
  m.x_t0 = path.start;
  if (m.body) m.body->center_t0 = path.center;
  std::vector<std::uint32_t> moved;
  for (std::uint32_t i = 0; i < m.x_t0.size(); ++i) {
    m.moved[i] = m.x_t1[i] != path.target[i];
    if (m.moved[i]) moved.push_back(i);
    if (m.inverse_mass[i] == 0 && !m.body) m.velocity[i] = path.velocity[i];
  }
  std::vector<std::uint32_t> both;
  std::set_union(m.touched.begin(), m.touched.end(), moved.begin(), moved.end(), std::back_inserter(both));
  m.touched.swap(both);
}

}  // namespace oilskin::world
