#include "checks/martin_moyce.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace oilskin::demo {
namespace {

struct Measured {
  double time, value;
};

// [Martin1952], column of 2.25 in with height 2a (n² = 2). Their Table 2 (front over a against
// t sqrt(2g/a)) as two public validation scripts print it; an independent digitisation of their Fig. 3 agrees
// within 2.5 %. Their Table 6 (height of the column at the wall over 2a against t sqrt(g/a)).
constexpr Measured front_of_experiment[] = {{0.41, 1.11}, {0.84, 1.22}, {1.19, 1.44}, {1.43, 1.67},
                                            {1.63, 1.89}, {1.83, 2.11}, {1.98, 2.33}, {2.20, 2.56},
                                            {2.32, 2.78}, {2.51, 3.00}, {2.65, 3.22}, {2.83, 3.44},
                                            {2.98, 3.67}, {3.11, 3.89}, {3.33, 4.11}};
constexpr Measured height_of_experiment[] = {
    {0.56, 0.94}, {0.77, 0.89}, {0.93, 0.83}, {1.08, 0.78}, {1.28, 0.72}, {1.46, 0.67},
    {1.66, 0.61}, {1.84, 0.56}, {2.00, 0.50}, {2.21, 0.44}, {2.45, 0.39}, {2.70, 0.33},
    {3.06, 0.28}, {3.44, 0.22}, {4.20, 0.17}, {5.25, 0.11}, {7.40, 0.06}};

constexpr double first_front = 1.2, last_front = 4;  // [a]: between the gate's opening and the film's tip
constexpr double quantile = 0.995;
constexpr double shift_step = 0.005;
constexpr double speed_over = 0.2;  // time over which the front's speed is taken: a particle more or less in
                                    // the quantile must not pass for a jump

const double not_covered = std::numeric_limits<double>::infinity();

using Cell = std::array<std::int64_t, 3>;
struct CellHash {
  std::size_t operator()(const Cell& c) const {
    return static_cast<std::size_t>(c[0] * 73856093 ^ c[1] * 19349663 ^ c[2] * 83492791);
  }
};

/// Sets of linked particles.
class Linked {
 public:
  explicit Linked(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }

  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::size_t i, std::size_t j) { parent_[find(i)] = find(j); }

 private:
  std::vector<std::size_t> parent_;
};

Linked link(Span<const Vec3> x, double reach) {
  std::unordered_map<Cell, std::vector<std::size_t>, CellHash> cells;
  auto cell_of = [&](const Vec3& p) {
    return Cell{static_cast<std::int64_t>(std::floor(p.x() / reach)),
                static_cast<std::int64_t>(std::floor(p.y() / reach)),
                static_cast<std::int64_t>(std::floor(p.z() / reach))};
  };
  Linked linked(x.size());
  // Each particle is linked with those before it.
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Cell c = cell_of(x[i]);
    for (int k = 0; k < 27; ++k) {
      const auto it = cells.find({c[0] + k % 3 - 1, c[1] + k / 3 % 3 - 1, c[2] + k / 9 - 1});
      if (it == cells.end()) continue;
      for (const std::size_t j : it->second)
        if ((x[i] - x[j]).squaredNorm() < reach * reach) linked.unite(i, j);
    }
    cells[c].push_back(i);
  }
  return linked;
}

double quantile_of(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::size_t>(quantile * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

/// Linear between moments; not finite outside of the run.
double value_at(const std::vector<DamMoment>& run, double DamMoment::*value, double t) {
  if (run.empty() || t < run.front().t || t > run.back().t) return not_covered;
  const auto after =
      std::find_if(run.begin(), run.end(), [t](const DamMoment& moment) { return moment.t >= t; });
  if (after == run.begin()) return *after.*value;
  const DamMoment &a = *(after - 1), &b = *after;
  return a.*value + (b.*value - a.*value) * (t - a.t) / (b.t - a.t);
}

struct Difference {
  double worst = 0, sum = 0;
  int count = 0;

  void add(double difference) {
    worst = std::max(worst, difference);
    sum += difference;
    ++count;
  }
  double mean() const { return count > 0 ? sum / count : not_covered; }
};

Difference front_difference(const std::vector<DamMoment>& run, double width, double unit, double shift) {
  Difference found;
  for (const Measured& m : front_of_experiment) {
    if (m.value <= first_front || m.value >= last_front) continue;
    const double z = value_at(run, &DamMoment::front, (m.time + shift) * unit) / width;
    found.add(std::abs(z / m.value - 1));
  }
  return found;
}

Difference height_difference(const std::vector<DamMoment>& run, double width, double unit, double shift) {
  const double until = std::prev(std::end(front_of_experiment), 2)->time * unit;
  Difference found;
  for (const Measured& m : height_of_experiment) {
    const double t = m.time * unit * std::sqrt(2.0);
    if (t > until) break;
    const double h = value_at(run, &DamMoment::height, t + shift * unit) / (2 * width);
    found.add(std::abs(h / m.value - 1));
  }
  return found;
}

double fastest_front(const std::vector<DamMoment>& run, double unit) {
  double fastest = 0;
  std::size_t from = 0;
  for (const DamMoment& to : run) {
    while (run[from + 1].t <= to.t - speed_over * unit) ++from;
    if (run[from].t > to.t - speed_over * unit) continue;
    fastest = std::max(fastest, (to.front - run[from].front) / (to.t - run[from].t));
  }
  return fastest;
}

}  // namespace

std::vector<Vec3> bulk_of(Span<const Vec3> positions, double reach) {
  Linked linked = link(positions, reach);
  std::unordered_map<std::size_t, std::size_t> count;
  std::size_t largest = 0, maximum = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const std::size_t root = linked.find(i);
    if (++count[root] > maximum) {
      maximum = count[root];
      largest = root;
    }
  }
  std::vector<Vec3> bulk;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (linked.find(i) == largest) bulk.push_back(positions[i]);
  return bulk;
}

DamMoment look_at_dam(Span<const Vec3> positions, const DamPlace& place, double t) {
  const double near_wall = 0.25 * place.width;
  std::vector<double> displacements;
  double at_wall = 0;  // particles
  for (const Vec3& x : bulk_of(positions, 2 * place.spacing)) {
    displacements.push_back((x - place.foot).dot(place.along));
    if (displacements.back() < near_wall) ++at_wall;
  }
  const double volume = at_wall * place.spacing * place.spacing * place.spacing;
  return {t, quantile_of(displacements) + 0.5 * place.spacing, volume / (near_wall * place.breadth)};
}

DamComparison compare_with_martin_moyce(const std::vector<DamMoment>& run, double width, double gravity,
                                        const DamFit& fit) {
  const double unit = std::sqrt(width / (2 * gravity));
  DamComparison found;
  double minimum = not_covered;
  const int steps = static_cast<int>(std::floor(fit.max_shift / shift_step + 1e-9));
  for (int i = -steps; i <= steps; ++i) {
    const double shift = i * shift_step;
    const Difference front = front_difference(run, width, unit, shift);
    const Difference height = height_difference(run, width, unit, shift);
    const double worse =
        std::max(front.worst / fit.front, std::isinf(fit.height) ? 0 : height.worst / fit.height);
    if (worse >= minimum) continue;
    minimum = worse;
    found.front = front.worst;
    found.height = height.worst;
    found.mean_front = front.mean();
    found.mean_height = height.mean();
    found.shift = shift;
  }
  if (run.size() > 1) found.speed = fastest_front(run, unit) / (2 * std::sqrt(2 * gravity * width));
  return found;
}

}  // namespace oilskin::demo
