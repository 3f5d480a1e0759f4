#include "study/comparators/water_cases.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "study/comparators/run_clock.h"
#include "study/comparators/study_hosts.h"

namespace oilskin::study {
namespace {

constexpr double g = 9.81;  // [m/s²], downwards along y

void require(const Status& status) {
  if (!status.ok()) throw std::runtime_error(status.message);
}

std::size_t fill(CouplingMethod& method, const Box& box, double spacing) {
  const std::vector<Vec3> x = lattice_in(box, spacing);
  require(method.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())));
  return x.size();
}

/// A tank around the lattice in a box, open above, its walls where the method wants them.
demo::MockBody tank_around(Method method, const Box& box, double spacing) {
  const double off = (wall_distance(method) - 0.5) * spacing;
  return make_tank({box.min - Vec3::Constant(off), box.max + Vec3::Constant(off)});
}

double height_of_centre(const CouplingMethod& method) {
  double sum = 0;
  for (const Vec3& x : method.positions()) sum += x.y();
  return sum / static_cast<double>(method.positions().size());
}

double first_layer(const CouplingMethod& method, std::size_t count) {
  std::vector<double> y;
  for (const Vec3& x : method.positions()) y.push_back(x.y());
  std::sort(y.begin(), y.end());
  y.resize(std::min(count, y.size()));
  double sum = 0;
  for (double height : y) sum += height;
  return sum / static_cast<double>(y.size());
}

/// Sums over particles and steps of a column at rest.
struct RestSums {
  double steps = 0, impulse = 0, time = 0, level = 0, first = 0, speed2 = 0, particles = 0;
  // Between 2 dx and depth − 2 dx: of pressures over ρ0 g, in metres of water
  double inner = 0, error2 = 0, density = 0, d = 0, p = 0, dd = 0, dp = 0;

  void add(const CouplingMethod& method, double depth, double spacing, double rest_density) {
    const double surface = 2 * height_of_centre(method);
    level += surface, steps += 1, first += first_layer(method, 64) / spacing;
    for (std::size_t i = 0; i < method.positions().size(); ++i) {
      const double y = method.positions()[i].y(), below = surface - y;
      speed2 += method.velocities()[i].squaredNorm(), particles += 1;
      if (y < 2 * spacing || y > depth - 2 * spacing) continue;
      const double head = method.pressures()[i] / (rest_density * g);
      inner += 1, error2 += (head - below) * (head - below), density += method.densities()[i] / rest_density;
      d += below, p += head, dd += below * below, dp += below * head;
    }
  }
};

double downward_impulse(const CouplingMethod& method, std::size_t surface) {
  double sum = 0;
  for (const Vec3& j : method.surface(surface).impulse) sum -= j.y();
  return sum;
}

void write(const RestSums& sums, double depth, ColumnResult& result) {
  result.level_error = sums.level / sums.steps / depth - 1;
  result.first_layer = sums.first / sums.steps;
  result.pressure_error = std::sqrt(sums.error2 / sums.inner) / depth;
  result.pressure_slope = (sums.inner * sums.dp - sums.d * sums.p) / (sums.inner * sums.dd - sums.d * sums.d);
  result.density = sums.density / sums.inner;
  result.rms_speed = std::sqrt(sums.speed2 / sums.particles);
}

}  // namespace

ColumnResult run(const ColumnCase& setup) {
  MethodSettings settings;
  settings.max_substeps = setup.max_substeps;
  const double width = 8 * settings.spacing, depth = setup.layers * settings.spacing;
  demo::MockBody tank =
      tank_around(setup.method, {Vec3::Zero(), Vec3(width, 2 * depth, width)}, settings.spacing);
  const std::unique_ptr<CouplingMethod> method = make_method(setup.method, settings);
  RunClock clock(*method);
  require(method->attach(tank));
  ColumnResult result;
  result.setup = setup;
  result.particles = fill(*method, {Vec3::Zero(), Vec3(width, depth, width)}, settings.spacing);
  RestSums sums;
  Vec3 momentum = Vec3::Zero();
  const int steps = static_cast<int>(std::ceil(setup.duration / setup.dt - 1e-9));
  for (int k = 0; k < steps && method->positions().size() > 0; ++k) {
    require(clock.step(setup.dt));
    if (k < steps / 2) {
      momentum = method->momentum();
      continue;
    }
    sums.impulse += downward_impulse(*method, 0), sums.time += setup.dt;
    sums.add(*method, depth, settings.spacing, settings.rest_density);
  }
  result.remaining = method->positions().size();
  if (sums.steps > 0 && sums.inner > 0) write(sums, depth, result);
  // What the column's own momentum still changes does not press on the tank.
  const double change = method->momentum().y() - momentum.y();
  const double weight = static_cast<double>(result.remaining) * method->particle_mass() * g;
  result.force_over_weight = (sums.impulse - change) / (weight * sums.time);
  result.leaks = clock.leaks();
  result.seconds_per_second = clock.seconds_per_second();
  return result;
}

namespace {

constexpr double base = 0.05715;  // a [m], 2.25 inches
/// T = t √(2 g/a) and Z = front/a, [Martin1952], with 1.2 < Z < 4.
constexpr std::array<std::array<double, 2>, 13> measured = {{{.84, 1.22},
                                                             {1.19, 1.44},
                                                             {1.43, 1.67},
                                                             {1.63, 1.89},
                                                             {1.83, 2.11},
                                                             {1.98, 2.33},
                                                             {2.20, 2.56},
                                                             {2.32, 2.78},
                                                             {2.51, 3.00},
                                                             {2.65, 3.22},
                                                             {2.83, 3.44},
                                                             {2.98, 3.67},
                                                             {3.11, 3.89}}};

/// The 99.5 % quantile of x, with half a spacing, over a.
double front(const CouplingMethod& method, double spacing) {
  std::vector<double> x;
  for (const Vec3& p : method.positions()) x.push_back(p.x());
  if (x.empty()) return 0;
  const auto at = x.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(x.size()));
  std::nth_element(x.begin(), at, x.end());
  return (*at + 0.5 * spacing) / base;
}

double energy(const CouplingMethod& method) {
  double sum = 0;
  for (std::size_t i = 0; i < method.positions().size(); ++i)
    sum += 0.5 * method.velocities()[i].squaredNorm() + g * method.positions()[i].y();
  return sum;
}

/// Z from time to time, on straight lines between.
struct Front {
  std::vector<std::array<double, 2>> series = {{0, 1}};

  double at(double t) const {
    const auto after = std::find_if(series.begin(), series.end(), [&](const auto& s) { return s[0] >= t; });
    if (after == series.end()) return series.back()[1];
    if (after == series.begin()) return series.front()[1];
    const auto before = after - 1;
    return (*before)[1] + (t - (*before)[0]) / ((*after)[0] - (*before)[0]) * ((*after)[1] - (*before)[1]);
  }
  void compare(DamResult& result) const {
    for (const auto& [time, position] : measured) {
      const double off = at(time / std::sqrt(2 * g / base)) / position - 1;
      result.front_lead += off / measured.size();
      result.front_error += std::abs(off) / measured.size();
    }
  }
};

double mean_compression(const CouplingMethod& method, double rest_density) {
  double sum = 0;
  for (double density : method.densities()) sum += std::max(density / rest_density - 1, 0.0);
  return sum / static_cast<double>(std::max<std::size_t>(1, method.densities().size()));
}

double densest_tenth(const CouplingMethod& method, double rest_density) {
  std::vector<double> density(method.densities().begin(), method.densities().end());
  std::sort(density.begin(), density.end(), std::greater<>());
  density.resize(std::max<std::size_t>(1, density.size() / 10));
  double sum = 0;
  for (double d : density) sum += d / rest_density;
  return sum / static_cast<double>(density.size());
}

}  // namespace

DamResult run(const DamCase& setup) {
  MethodSettings settings;
  settings.max_substeps = setup.max_substeps;
  settings.spacing = setup.spacing;
  const double depth = 8 * setup.spacing;
  demo::MockBody tank =
      tank_around(setup.method, {Vec3::Zero(), Vec3(7 * base, 4 * base, depth)}, setup.spacing);
  const std::unique_ptr<CouplingMethod> method = make_method(setup.method, settings);
  RunClock clock(*method);
  require(method->attach(tank));
  DamResult result;
  result.setup = setup;
  result.particles = fill(*method, {Vec3::Zero(), Vec3(base, 2 * base, depth)}, setup.spacing);
  const double start = energy(*method);
  Front z;
  const int steps = static_cast<int>(std::ceil(setup.duration / setup.dt - 1e-9));
  for (int k = 0; k < steps; ++k) {
    require(clock.step(setup.dt));
    z.series.push_back({(k + 1) * setup.dt, front(*method, setup.spacing)});
    result.energy_gain = std::max(result.energy_gain, energy(*method) / start - 1);
    if (method->densities().empty()) continue;
    result.density_error += mean_compression(*method, settings.rest_density) / steps;
    result.largest_density = std::max(result.largest_density, densest_tenth(*method, settings.rest_density));
  }
  z.compare(result);
  result.leaks = clock.leaks();
  result.remaining = method->positions().size();
  result.seconds_per_second = clock.seconds_per_second();
  return result;
}

}  // namespace oilskin::study
