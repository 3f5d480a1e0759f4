#include "fluid/emission/nozzle.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/assert.h"
#include "fluid/kernels.h"

namespace oilskin::fluid {

namespace {

struct Site {
  double x, y;  // [spacings]
  double squared() const { return x * x + y * y; }
};

/// A square lattice, moved against the axis by (x, y), and the order of its rotations about the axis.
struct Placement {
  double x, y;
  int order;
};
constexpr Placement placements[] = {{0, 0, 4}, {0.5, 0.5, 4}, {0.5, 0, 2}};

/// One point of each orbit, nearest first.
std::vector<Site> representatives(const Placement& p, double radius) {
  const int n = static_cast<int>(std::ceil(radius));
  std::vector<Site> sites;
  for (int b = p.order == 4 ? 0 : -n; b <= n; ++b)
    for (int a = 0; a <= n; ++a) {
      const Site s{a + p.x, b + p.y};
      if (s.squared() <= radius * radius && (s.x > 0 || s.squared() == 0)) sites.push_back(s);
    }
  std::sort(sites.begin(), sites.end(), [](const Site& s, const Site& t) {
    return std::make_tuple(s.squared(), s.y, s.x) < std::make_tuple(t.squared(), t.y, t.x);
  });
  return sites;
}

void add_orbit(Site s, int order, std::vector<Site>& sites) {
  const int members = s.squared() == 0 ? 1 : order;
  for (int k = 0; k < members; ++k) {
    sites.push_back(s);
    s = order == 4 ? Site{-s.y, s.x} : Site{-s.x, -s.y};
  }
}

std::vector<Site> fill(const Placement& placement, double needed) {
  std::vector<Site> sites;
  for (const Site& s : representatives(placement, std::sqrt(needed / pi) + 2)) {
    if (static_cast<double>(sites.size()) >= needed) break;
    add_orbit(s, placement.order, sites);
  }
  OILSKIN_ASSERT(static_cast<double>(sites.size()) >= needed);
  return sites;
}

double second_moment(const std::vector<Site>& sites) {
  double sum = 0;
  for (const Site& s : sites) sum += s.squared();
  return sum;
}

/// Fewer sites are nearer to what is needed; of equal numbers the rounder layer.
std::vector<Site> best_layer(double needed) {
  std::vector<Site> best;
  for (const Placement& p : placements) {
    std::vector<Site> sites = fill(p, needed);
    if (best.empty() || sites.size() < best.size() ||
        (sites.size() == best.size() && second_moment(sites) < second_moment(best)))
      best = std::move(sites);
  }
  return best;
}

}  // namespace

std::vector<Vec3> nozzle_sites(const DiscEmitter& e, double needed, double spacing) {
  OILSKIN_ASSERT(needed > 0 && spacing > 0);
  const Vec3 axis = e.direction.stableNormalized();
  int minimum = 0;
  axis.cwiseAbs().minCoeff(&minimum);
  const Vec3 u = axis.cross(Vec3::Unit(minimum)).normalized(), v = axis.cross(u);
  std::vector<Vec3> sites;
  for (const Site& s : best_layer(needed)) sites.push_back(e.center + spacing * (s.x * u + s.y * v));
  return sites;
}

}  // namespace oilskin::fluid
