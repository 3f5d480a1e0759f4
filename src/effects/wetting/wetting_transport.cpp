#include "effects/wetting/wetting_transport.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/refuse.h"

namespace oilskin {

namespace {

/// At which capillary_rise is measured [m/s²].
constexpr double rise_gravity = 9.81;
constexpr double largest_coordinate = 1e15;
/// Amounts below this part of the capacity are dry: they would only become denormal.
constexpr double dry = 1e-18;

bool is_position(const Vec3& x) {
  return (x.array().abs() < largest_coordinate).all();
}

}  // namespace

Status WettingTransport::validate(Span<const Vec3> rest, Span<const Triangle> triangles,
                                  const Fabric& fabric) {
  if (Status s = fabric.validate(); !s.ok()) return s;
  if (!std::all_of(rest.begin(), rest.end(), is_position))
    return refuse("a rest position is not finite, or not below ", largest_coordinate, " m");
  for (const Triangle& t : triangles)
    if (*std::max_element(t.begin(), t.end()) >= rest.size())
      return refuse("a triangle names node ", *std::max_element(t.begin(), t.end()), "; there are ",
                    rest.size());
  return {};
}

WettingTransport::WettingTransport(Span<const Vec3> rest, Span<const Triangle> triangles,
                                   const Fabric& fabric)
    : fabric_(checked(rest, triangles, fabric)), mesh_(rest, triangles, fabric), flow_(mesh_), sums_(mesh_) {}

const Fabric& WettingTransport::checked(Span<const Vec3> rest, Span<const Triangle> triangles,
                                        const Fabric& fabric) {
  OILSKIN_ASSERT(validate(rest, triangles, fabric).ok());
  return fabric;
}

Status WettingTransport::check(double dt, Span<const Vec3> position, const Vec3& gravity,
                               Span<const double> liquid, Span<const std::uint32_t> held) const {
  const std::size_t n = mesh_.capacity.size();
  if (!within(dt, 0, 1e9)) return refuse_value("dt", dt, "0 … 1e9 s");
  if (position.size() != n) return refuse("there are ", position.size(), " positions for ", n, " nodes");
  if (liquid.size() != n) return refuse("there are ", liquid.size(), " amounts for ", n, " nodes");
  if (!(gravity.norm() <= 1e6)) return refuse_value("gravity", gravity.transpose(), "at most 1e6 m/s²");
  if (!std::all_of(position.begin(), position.end(), is_position))
    return refuse("a position is not finite, or not below ", largest_coordinate, " m");
  for (std::size_t i = 0; i < n; ++i)
    if (!within(liquid[i], 0, 1e12)) return refuse_value("liquid", liquid[i], "0 … 1e12 kg");
  for (const std::uint32_t i : held)
    if (i >= n) return refuse("held names node ", i, "; there are ", n);
  return {};
}

void WettingTransport::prepare(Span<const double> liquid, Span<const std::uint32_t> held) {
  const std::size_t n = liquid.size();
  held_.assign(n, 0);
  for (const std::uint32_t i : held) held_[i] = 1;
  saturation_.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    saturation_[i] = mesh_.capacity[i] > 0 ? liquid[i] / mesh_.capacity[i] : 0;
  find_upper();
}

/// What neighbours had may be reached again: an excess spreads. (W.11)
void WettingTransport::find_upper() {
  upper_.resize(saturation_.size());
  for (std::size_t i = 0; i < upper_.size(); ++i) {
    upper_[i] = std::max(fabric_.saturation_limit, saturation_[i]);
    for (const auto& link : mesh_.links(i)) upper_[i] = std::max(upper_[i], saturation_[link.node]);
  }
}

void WettingTransport::add_amounts(const std::vector<double>& amount, std::vector<double>& mass) const {
  for (std::size_t e = 0; e < amount.size(); ++e) {
    mass[mesh_.edges[e].first] -= amount[e];
    mass[mesh_.edges[e].second] += amount[e];
  }
}

/// From the solution without negative conductances to the one with them, within the bounds of the former and
/// of the start.
void WettingTransport::correct_flux(std::vector<double>& mass) {
  std::vector<double> correction = flow_.amount();
  if (!flow_.solve_with_negative_conductances()) return;
  for (std::size_t e = 0; e < correction.size(); ++e) correction[e] = flow_.amount()[e] - correction[e];
  const std::size_t n = mass.size();
  std::vector<double> low(n), high(n), lower(n, 0), upper(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const double s = mesh_.capacity[i] > 0 ? mass[i] / mesh_.capacity[i] : 0;
    low[i] = std::min(s, saturation_[i]);
    high[i] = std::max(s, saturation_[i]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    lower[i] = low[i], upper[i] = high[i];
    for (const auto& link : mesh_.links(i)) {
      lower[i] = std::min(lower[i], low[link.node]);
      upper[i] = std::max(upper[i], high[link.node]);
    }
    lower[i] = std::max(lower[i], 0.0) * mesh_.capacity[i];
    upper[i] = std::min(upper[i], upper_[i]) * mesh_.capacity[i];
    if (held_[i] != 0) lower[i] = -1e300, upper[i] = 1e300;
  }
  add_limited(mesh_, correction, lower, upper, mass);
}

void WettingTransport::bound(Span<const Vec3> position, const Vec3& slope, std::vector<double>& mass) const {
  std::vector<double> upper(mass.size());
  bool is_over = false;
  for (const std::uint32_t i : flow_.nodes()) {
    if (held_[i] != 0) continue;
    if (mass[i] < dry * mesh_.capacity[i]) mass[i] = 0;
    upper[i] = upper_[i] * mesh_.capacity[i];
    is_over = is_over || mass[i] > upper[i];
  }
  if (!is_over) return;
  std::vector<std::uint32_t> lowest_first = flow_.nodes();
  std::stable_sort(lowest_first.begin(), lowest_first.end(), [&](std::uint32_t a, std::uint32_t b) {
    return slope.dot(position[a]) > slope.dot(position[b]);
  });
  return_excess(mesh_, lowest_first, flow_.drift(), flow_.amount(), upper, held_, mass);
}

Status WettingTransport::step(double dt, Span<const Vec3> position, const Vec3& gravity, Span<double> liquid,
                              Span<const std::uint32_t> held, TransportReport* report) {
  if (report != nullptr) *report = {};
  if (Status s = check(dt, position, gravity, liquid, held); !s.ok()) return s;
  const bool is_dry = std::all_of(liquid.begin(), liquid.end(), [](double m) { return m == 0; });
  if (is_dry || dt == 0) return {};
  prepare(liquid, held);
  WettingFlow::Interval interval{dt,
                                 position,
                                 gravity / (rise_gravity * fabric_.capillary_rise),
                                 fabric_.mobility_exponent,
                                 &saturation_,
                                 &upper_,
                                 &held_};
  if (!flow_.solve(interval))
    return flow_.is_solved() ? Status()
                             : Status::refused("the equations of the transport could not be solved");
  sums_.remember(liquid);
  std::vector<double> mass(liquid.begin(), liquid.end());
  add_amounts(flow_.amount(), mass);
  if (mesh_.has_negative) correct_flux(mass);
  bound(position, interval.slope, mass);
  const double gained = sums_.restore(held_, mass);
  double supplied = gained;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    if (held_[i] != 0)
      supplied -= mass[i] - liquid[i];
    else
      liquid[i] = mass[i];
  }
  if (report != nullptr) *report = {supplied, flow_.iterations()};
  return {};
}

}  // namespace oilskin
