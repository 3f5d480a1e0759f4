#include "effects/wetting/flux_limiter.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace oilskin {

namespace {

/// Of return_excess() along all flows.
constexpr int max_sweeps = 10;

/// The part of the wanted change that the space allows, 0 … 1.
double allowed(double space, double wanted) {
  return wanted <= 0 ? 1 : std::clamp(space / wanted, 0.0, 1.0);
}

/// The node that loses and the one that gains, without a branch, which could not be predicted.
std::array<std::uint32_t, 2> ends(const WettingMesh::Edge& edge, double flow) {
  const std::array<std::uint32_t, 2> nodes = {edge.first, edge.second};
  return {nodes[flow > 0 ? 0 : 1], nodes[flow > 0 ? 1 : 0]};
}

/// The excess of one node goes back over the links by which `flow` [kg] brought liquid, but not to nodes that
/// are done; false: there is no such link.
bool return_from(const WettingMesh& mesh, const std::vector<double>& flow,
                 const std::vector<std::uint8_t>& is_done, std::uint32_t node, double excess,
                 std::vector<double>& mass) {
  const auto brought = [&](const WettingMesh::Link& link) {
    const double to_second = is_done[link.node] != 0 ? 0 : flow[link.edge];
    return std::max(mesh.edges[link.edge].second == node ? to_second : -to_second, 0.0);
  };
  double total = 0;
  for (const auto& link : mesh.links(node)) total += brought(link);
  if (!(total > 0)) return false;
  mass[node] -= excess;
  for (const auto& link : mesh.links(node)) mass[link.node] += excess * (brought(link) / total);
  return true;
}

/// Excess fills what is free in its connected part.
void spread(const WettingMesh& mesh, const std::vector<std::uint32_t>& nodes,
            const std::vector<double>& upper, const std::vector<std::uint8_t>& held,
            std::vector<double>& mass) {
  std::vector<double> excess(mesh.part_count, 0), free(mesh.part_count, 0);
  for (const std::uint32_t i : nodes) {
    if (held[i] != 0) continue;
    excess[mesh.part[i]] += std::max(mass[i] - upper[i], 0.0);
    free[mesh.part[i]] += std::max(upper[i] - mass[i], 0.0);
  }
  for (const std::uint32_t i : nodes) {
    const double e = excess[mesh.part[i]], f = free[mesh.part[i]];
    if (held[i] != 0 || !(e > 0 && f > 0)) continue;
    if (mass[i] > upper[i])
      mass[i] -= (mass[i] - upper[i]) * std::min(1.0, f / e);
    else
      mass[i] += (upper[i] - mass[i]) * std::min(1.0, e / f);
  }
}

/// Neumaier's summation.
struct ExactSum {
  double sum = 0, rest = 0;
  void add(double x) {
    const double t = sum + x;
    rest += std::abs(sum) >= std::abs(x) ? (sum - t) + x : (x - t) + sum;
    sum = t;
  }
  double value() const { return sum + rest; }
};

}  // namespace

void add_limited(const WettingMesh& mesh, const std::vector<double>& correction,
                 const std::vector<double>& lower, const std::vector<double>& upper,
                 std::vector<double>& mass) {
  std::vector<double> gain(mass.size(), 0), loss(mass.size(), 0);
  for (std::size_t e = 0; e < correction.size(); ++e) {
    const auto [from, to] = ends(mesh.edges[e], correction[e]);
    gain[to] += std::abs(correction[e]);
    loss[from] += std::abs(correction[e]);
  }
  for (std::size_t i = 0; i < mass.size(); ++i) {
    gain[i] = allowed(upper[i] - mass[i], gain[i]);
    loss[i] = allowed(mass[i] - lower[i], loss[i]);
  }
  for (std::size_t e = 0; e < correction.size(); ++e) {
    const auto [from, to] = ends(mesh.edges[e], correction[e]);
    const double amount = std::abs(correction[e]) * std::min(loss[from], gain[to]);
    mass[from] -= amount;
    mass[to] += amount;
  }
}

void return_excess(const WettingMesh& mesh, const std::vector<std::uint32_t>& lowest_first,
                   const std::vector<double>& drift, const std::vector<double>& amount,
                   const std::vector<double>& upper, const std::vector<std::uint8_t>& held,
                   std::vector<double>& mass) {
  std::vector<std::uint8_t> is_done(mass.size(), 0);
  bool is_left = false;
  for (const std::uint32_t i : lowest_first) {
    is_done[i] = held[i] == 0 ? 1 : 0;
    if (held[i] == 0 && mass[i] > upper[i])
      is_left = !return_from(mesh, drift, is_done, i, mass[i] - upper[i], mass) || is_left;
  }
  is_done.assign(mass.size(), 0);
  for (int sweep = 0; sweep < max_sweeps && is_left; ++sweep) {
    is_left = false;
    for (const std::uint32_t i : lowest_first)
      if (held[i] == 0 && mass[i] > upper[i])
        is_left = return_from(mesh, amount, is_done, i, mass[i] - upper[i], mass) || is_left;
  }
  spread(mesh, lowest_first, upper, held, mass);
}

std::vector<double> PartSums::of(Span<const double> mass) const {
  std::vector<ExactSum> sums(mesh_.part_count);
  for (std::size_t i = 0; i < mass.size(); ++i) sums[mesh_.part[i]].add(mass[i]);
  std::vector<double> values;
  values.reserve(sums.size());
  for (const ExactSum& s : sums) values.push_back(s.value());
  return values;
}

double PartSums::restore(const std::vector<std::uint8_t>& held, std::vector<double>& mass) const {
  const std::vector<double> now = of(mass);
  std::vector<std::uint8_t> is_open(mesh_.part_count, 0);
  for (std::size_t i = 0; i < mass.size(); ++i)
    if (held[i] != 0) is_open[mesh_.part[i]] = 1;
  ExactSum gained;
  for (std::size_t p = 0; p < mesh_.part_count; ++p)
    if (is_open[p] != 0) gained.add(now[p] - sum_[p]);
  for (std::size_t i = 0; i < mass.size(); ++i) {
    const std::uint32_t p = mesh_.part[i];
    if (is_open[p] == 0 && now[p] > 0) mass[i] *= sum_[p] / now[p];
  }
  const std::vector<double> scaled = of(mass);
  // Of each part: the node that rounding takes least out of its range.
  std::vector<std::uint32_t> best(mesh_.part_count, UINT32_MAX);
  const auto margin = [&](std::uint32_t i) { return std::min(mass[i], mesh_.capacity[i] - mass[i]); };
  for (std::uint32_t i = 0; i < mass.size(); ++i) {
    std::uint32_t& b = best[mesh_.part[i]];
    if (mass[i] > 0 && (b == UINT32_MAX || margin(i) > margin(b))) b = i;
  }
  for (std::size_t p = 0; p < mesh_.part_count; ++p)
    if (is_open[p] == 0 && best[p] != UINT32_MAX) mass[best[p]] += sum_[p] - scaled[p];
  return gained.value();
}

}  // namespace oilskin
