#include "effects/wetting/wetting_flow.h"

#include <algorithm>
#include <cmath>

namespace oilskin {

namespace {

constexpr std::uint32_t none = UINT32_MAX;
/// β of (W.7).
constexpr double drift_ratio = 8;
/// ε of (W.10).
constexpr double full_storage = 1e-3;
/// Rounds of (W.10). What is still above the limit then, return_excess() moves.
constexpr int max_rounds = 12;
/// Of S, relative to the largest.
constexpr double tolerance = 1e-11;
/// Likewise, of a correction that is limited afterwards.
constexpr double correction_tolerance = 1e-9;

double power(double s, double a) {
  if (a == 0) return 1;
  if (a == 1) return s;
  if (a == 2) return s * s;
  return std::pow(s, a);
}

}  // namespace

bool WettingFlow::solve(const Interval& interval) {
  in_ = interval;
  is_solved_ = true;
  iterations_ = 0;
  find_nodes();
  if (edges_.empty()) return false;
  find_mobilities();
  set_diffusion(false);
  potential_.clear();
  for (const std::uint32_t i : nodes_) potential_.push_back((*in_.saturation)[i]);
  is_full_.assign(nodes_.size(), 0);
  for (int round = 0; round < max_rounds; ++round) {
    is_solved_ = solve_rows(tolerance);
    if (!is_solved_ || !fill()) break;
  }
  if (is_solved_) find_amounts();
  return is_solved_;
}

bool WettingFlow::solve_with_negative_conductances() {
  set_diffusion(true);
  if (!solve_rows(correction_tolerance)) return false;
  find_amounts();
  return true;
}

/// Where the mobility of dry textile is 0, liquid cannot get farther than to the neighbours of wet nodes.
void WettingFlow::find_nodes() {
  const std::vector<double>& s = *in_.saturation;
  row_of_.assign(s.size(), none);
  std::vector<std::uint8_t> is_wet(mesh_.part_count, 0);
  for (std::size_t i = 0; i < s.size(); ++i)
    if (s[i] > 0) is_wet[mesh_.part[i]] = 1;
  nodes_.clear();
  for (std::uint32_t i = 0; i < s.size(); ++i) {
    const auto links = mesh_.links(i);
    if (links.empty() || is_wet[mesh_.part[i]] == 0) continue;
    const bool reached = in_.exponent == 0 || s[i] > 0 ||
                         std::any_of(links.begin(), links.end(), [&](auto& l) { return s[l.node] > 0; });
    if (!reached) continue;
    row_of_[i] = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(i);
  }
  edges_.clear();
  for (const std::uint32_t i : nodes_)
    for (const auto& link : mesh_.links(i))
      if (i < link.node && row_of_[link.node] != none) edges_.push_back(link.edge);
}

void WettingFlow::find_mobilities() {
  diffusive_.resize(mesh_.capacity.size());
  gravitational_.resize(mesh_.capacity.size());
  for (const std::uint32_t i : nodes_) {
    const double s = std::min((*in_.saturation)[i], 1.0);
    diffusive_[i] = power(s, in_.exponent);
    gravitational_[i] = in_.exponent >= 1 ? diffusive_[i] : s;
  }
  for (auto* v : {&diffusion_, &drift_, &amount_, &drift_amount_}) v->assign(mesh_.edges.size(), 0);
  if (!in_.slope.isZero(0))
    for (const std::uint32_t e : edges_) set_drift(e);
}

/// The coefficient of S of the node that loses liquid, (W.7) and (W.8).
void WettingFlow::set_drift(std::uint32_t e) {
  const auto& edge = mesh_.edges[e];
  const double fall = in_.slope.dot(in_.position[edge.second] - in_.position[edge.first]);
  const double strength = in_.dt * edge.conductance * fall;
  const std::uint32_t up = strength > 0 ? edge.first : edge.second;
  const std::uint32_t down = strength > 0 ? edge.second : edge.first;
  const double own = gravitational_[up], s = (*in_.saturation)[up];
  const double mean = 0.5 * (own + gravitational_[down]);
  if (s > 0)
    drift_[e] = strength * (mean > own ? std::min(mean, drift_ratio * own) : own) / s;
  else
    drift_[e] = in_.exponent <= 1 && mean > 0 ? strength * drift_ratio : 0;
}

void WettingFlow::set_diffusion(bool with_negative) {
  for (const std::uint32_t e : edges_) {
    const auto& edge = mesh_.edges[e];
    const double conductance = with_negative ? edge.conductance : std::max(edge.conductance, 0.0);
    diffusion_[e] = in_.dt * conductance * 0.5 * (diffusive_[edge.first] + diffusive_[edge.second]);
  }
}

/// S of a row for its potential, (W.10): S = offset + storage ψ.
void WettingFlow::set_storage() {
  storage_.resize(nodes_.size());
  offset_.resize(nodes_.size());
  for (std::uint32_t row = 0; row < nodes_.size(); ++row) {
    const bool full = is_full_[row] != 0;
    storage_[row] = full ? full_storage : 1;
    offset_[row] = full ? (1 - full_storage) * (*in_.upper)[nodes_[row]] : 0;
  }
}

void WettingFlow::assemble() {
  matrix_.begin.resize(nodes_.size() + 1);
  matrix_.column.resize(mesh_.link.size());
  matrix_.value.resize(mesh_.link.size());
  matrix_.diagonal.resize(nodes_.size());
  right_.resize(nodes_.size());
  weight_.resize(nodes_.size());
  std::uint32_t end = matrix_.begin[0] = 0;
  for (std::uint32_t row = 0; row < nodes_.size(); ++row)
    matrix_.begin[row + 1] = end = assemble_row(row, end);
}

/// `end`: of the entries so far; returns the new one.
std::uint32_t WettingFlow::assemble_row(std::uint32_t row, std::uint32_t end) {
  const std::uint32_t i = nodes_[row];
  const double s = (*in_.saturation)[i], c = mesh_.capacity[i];
  const bool is_held = (*in_.held)[i] != 0;
  double diagonal = is_held ? 1 : c * storage_[row], right = is_held ? s : c * (s - offset_[row]);
  for (const auto& link : mesh_.links(i)) {
    const std::uint32_t other = row_of_[link.node];
    if (is_held || other == none) continue;
    const double d = diffusion_[link.edge];
    const double f = drift_[link.edge] * (i < link.node ? 1.0 : -1.0);
    // The larger of f and 0, of −f and 0, without branches, which cannot be predicted here.
    const double out = 0.5 * (std::abs(f) + f), in = 0.5 * (std::abs(f) - f);
    if (d == 0 && f == 0) continue;
    diagonal += d + out * storage_[row];
    right += in * offset_[other] - out * offset_[row];
    matrix_.column[end] = other;
    matrix_.value[end++] = -(d + in * storage_[other]);
  }
  matrix_.diagonal[row] = diagonal;
  right_[row] = right;
  weight_[row] = is_held ? 1 : 1 / c;
  return end;
}

bool WettingFlow::solve_rows(double accepted) {
  set_storage();
  assemble();
  double largest = 0;
  for (const std::uint32_t i : nodes_) largest = std::max(largest, (*in_.saturation)[i]);
  const bool solved = solver_.solve(matrix_, right_, weight_, accepted, largest, potential_);
  iterations_ += solver_.iterations();
  return solved;
}

/// Which nodes are full at the end, (W.10). True: others than assumed.
bool WettingFlow::fill() {
  bool changed = false;
  for (std::uint32_t row = 0; row < nodes_.size(); ++row) {
    const std::uint32_t i = nodes_[row];
    const double over = potential_[row] - (*in_.upper)[i];
    const bool full = (*in_.held)[i] == 0 && over > (is_full_[row] != 0 ? 0 : full_storage);
    changed = changed || full != (is_full_[row] != 0);
    is_full_[row] = full ? 1 : 0;
  }
  return changed;
}

void WettingFlow::find_amounts() {
  for (const std::uint32_t e : edges_) {
    const std::uint32_t a = row_of_[mesh_.edges[e].first], b = row_of_[mesh_.edges[e].second];
    const std::uint32_t up = drift_[e] > 0 ? a : b;
    drift_amount_[e] = drift_[e] * (offset_[up] + storage_[up] * potential_[up]);
    amount_[e] = diffusion_[e] * (potential_[a] - potential_[b]) + drift_amount_[e];
  }
}

}  // namespace oilskin
