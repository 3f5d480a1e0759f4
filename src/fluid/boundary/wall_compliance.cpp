#include "fluid/boundary/wall_compliance.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/assert.h"
#include "core/chunks.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t smallest_chunk = 64;

/// Error that solve() leaves, and the largest condition number C that it iterates for (B.24).
constexpr double solve_tolerance = 0.3, max_condition = 50;

/// Where the nodes of one point are in a list: a hash table, as long as the point has walls, whatever the
/// number of nodes.
class NodePlaces {
 public:
  /// For up to `most` nodes, none of which has a place.
  void start(std::size_t most) {
    std::size_t size = 8;
    while (size < 2 * most) size *= 2;
    slots_.assign(size, {none, 0});
  }
  /// The place of the node, which is `next` if it has none yet.
  std::size_t of(std::uint32_t node, std::size_t next) {
    std::size_t slot = node;
    while (at(slot).node != none && at(slot).node != node) ++slot;
    if (at(slot).node == none) at(slot) = {node, next};
    return at(slot).place;
  }

 private:
  static constexpr std::uint32_t none = UINT32_MAX;
  struct Slot {
    std::uint32_t node;
    std::size_t place;
  };
  Slot& at(std::size_t slot) { return slots_[slot & (slots_.size() - 1)]; }

  std::vector<Slot> slots_;
};

}  // namespace

void WallCompliance::build(const WallGeometry& geometry, const WallNodes& nodes,
                           std::vector<WallNodeMotion> motion, double particle_mass, const Workers& workers) {
  OILSKIN_ASSERT(motion.size() == nodes.size());
  mass_ = static_cast<float>(particle_mass);
  motion_ = std::move(motion);
  has_free_nodes_ =
      std::any_of(motion_.begin(), motion_.end(), [](const WallNodeMotion& n) { return n.inverse_mass > 0; });
  couple_points(geometry, nodes, workers);
  couple_nodes(workers);
  sum_rows(workers);
  wall_velocity_.resize(motion_.size());
  normal_flux_.assign(geometry.points().size(), 0);
  set_wall_velocity(std::vector<float>(normal_flux_.size()), workers);
}

/// The walls of a point share most of their nodes. Their sums are stored, so that the iterations read each
/// pair of point and node once. Nodes that stand still and do not yield add nothing and are left out.
void WallCompliance::couple_points(const WallGeometry& geometry, const WallNodes& nodes,
                                   const Workers& workers) {
  const std::vector<WallPoint>& points = geometry.points();
  const std::size_t point_chunk = even_chunk(points.size(), smallest_chunk);
  std::vector<std::vector<Coupling>> found((points.size() + point_chunk - 1) / point_chunk);
  of_point_.begin.assign(points.size() + 1, 0);
  workers.for_chunks(points.size(), point_chunk, [&](std::size_t begin, std::size_t end, std::size_t chunk) {
    std::vector<Coupling>& list = found[chunk];
    NodePlaces places;
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t first = list.size();
      places.start(3 * (points[k].end - points[k].begin));
      for (std::uint32_t w = points[k].begin; w < points[k].end; ++w)
        for (int c = 0; c < 3; ++c) {
          const Wall& wall = geometry.walls()[w];
          const std::uint32_t node = nodes.of_wall(w)[static_cast<std::size_t>(c)];
          if (motion_[node].is_still()) continue;
          const Eigen::Vector3f gamma = static_cast<float>(wall.share(c)) * wall.gamma;
          const std::size_t place = places.of(node, list.size());
          if (place < list.size())
            list[place].gamma += gamma;
          else
            list.push_back({node, gamma});
        }
      of_point_.begin[k + 1] = static_cast<std::uint32_t>(list.size() - first);
    }
  });
  std::partial_sum(of_point_.begin.begin(), of_point_.begin.end(), of_point_.begin.begin());
  of_point_.list.resize(of_point_.begin.back());
  workers.for_each(found.size(), 1, [&](std::size_t c) {
    std::copy(found[c].begin(), found[c].end(), of_point_.list.begin() + of_point_.begin[c * point_chunk]);
  });
}

/// The same couplings in the order of the nodes.
void WallCompliance::couple_nodes(const Workers& workers) {
  const auto for_couplings = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t k = begin; k < end; ++k)
      for (const Coupling& c : of_point_.of(k)) f(c.other, Coupling{static_cast<std::uint32_t>(k), c.gamma});
  };
  sort_by_key(of_point_.begin.size() - 1, smallest_chunk, motion_.size(), for_couplings, workers, of_node_);
}

void WallCompliance::sum_rows(const Workers& workers) {
  row_sums_.assign(of_point_.begin.size() - 1, 0);
  if (!bodies_.empty()) bodies_.add_row_sums(row_sums_);
  if (!has_free_nodes_) return;
  std::vector<float> of_node(motion_.size());
  for_each_evenly(workers, motion_.size(), smallest_chunk, [&](std::size_t n) {
    float sum = 0;
    for (const Coupling& c : of_node_.of(n)) sum += c.gamma.norm();
    of_node[n] = motion_[n].inverse_mass * mass_ * sum;
  });
  for_each_evenly(workers, row_sums_.size(), smallest_chunk, [&](std::size_t k) {
    for (const Coupling& c : of_point_.of(k)) row_sums_[k] += c.gamma.norm() * of_node[c.other];
  });
}

void WallCompliance::predict_wall_velocity(const std::vector<float>& theta, const std::vector<float>& depth,
                                           const Workers& workers) {
  OILSKIN_ASSERT(theta.size() == normal_flux_.size());
  if (!bodies_.empty()) bodies_.predict(theta, depth, workers);
  if (yields()) set_wall_velocity(theta, workers);
}

void WallCompliance::set_wall_velocity(const std::vector<float>& theta, const Workers& workers) {
  OILSKIN_ASSERT(wall_velocity_.size() == motion_.size());
  for_each_evenly(workers, motion_.size(), smallest_chunk, [&](std::size_t n) {
    const WallNodeMotion& node = motion_[n];
    wall_velocity_[n] = node.velocity;
    if (node.inverse_mass == 0) return;
    wall_velocity_[n] -= node.inverse_mass * (node.carried + reaction_to(n, theta));
  });
  for_each_evenly(workers, normal_flux_.size(), smallest_chunk, [&](std::size_t k) {
    normal_flux_[k] = flux_at(k, wall_velocity_);
    if (!bodies_.empty()) normal_flux_[k] += bodies_.flux_at(k);
  });
}

/// −J_c (B.14) [N s]: what the node gives to the particles.
Eigen::Vector3f WallCompliance::reaction_to(std::size_t node, const std::vector<float>& theta) const {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const Coupling& c : of_node_.of(node)) sum += theta[c.other] * c.gamma;
  return mass_ * sum;
}

float WallCompliance::flux_at(std::size_t point, const std::vector<Eigen::Vector3f>& velocity) const {
  float sum = 0;
  for (const Coupling& c : of_point_.of(point)) sum += c.gamma.dot(velocity[c.other]);
  return sum;
}

/// max_k (1 + step_k scale Ŷ_k): the condition number of the preconditioned system (B.24).
float WallCompliance::max_row(float scale, const std::vector<float>& step) const {
  float largest = 1;
  for (std::size_t k = 0; k < step.size(); ++k)
    largest = std::max(largest, 1 + step[k] * scale * row_sums_[k]);
  return largest;
}

/// Coefficients of Chebyshev's iteration on the interval [1/C, 1] (B.25). Modes in the interval are damped to
/// the tolerance; modes below it are under-relaxed, never overshot.
struct WallCompliance::Chebyshev {
  double middle, half_width, rho;
  int iterations;
  float keep = 0, add = 0;  // of the next direction: keep × the last one + add × residual

  explicit Chebyshev(double condition)
      : middle(0.5 * (1 + 1 / condition)), half_width(0.5 * (1 - 1 / condition)), rho(half_width / middle) {
    const double root = std::sqrt(condition);
    iterations =
        root > 1
            ? static_cast<int>(std::ceil(std::log(2 / solve_tolerance) / std::log((root + 1) / (root - 1))))
            : 1;
  }
  void advance() {
    const double next = 1 / (2 * middle / half_width - rho);
    keep = static_cast<float>(next * rho);
    add = static_cast<float>(2 * next / half_width);
    rho = next;
  }
};

void WallCompliance::solve(float scale, const std::vector<float>& step, std::vector<float>& change,
                           const Workers& workers) {
  const std::size_t points = normal_flux_.size();
  OILSKIN_ASSERT(step.size() == points && change.size() == points);
  if (!yields()) {
    for (std::size_t k = 0; k < points; ++k) change[k] *= step[k];
    return;
  }
  Chebyshev chebyshev(std::min(static_cast<double>(max_row(scale, step)), max_condition));
  for (std::vector<float>* of_points : {&solve_step_, &residual_, &direction_}) of_points->resize(points);
  velocity_change_.resize(motion_.size());
  for_each_evenly(workers, points, smallest_chunk, [&](std::size_t k) {
    solve_step_[k] = step[k] / (1 + step[k] * scale * row_sums_[k]);
    residual_[k] = solve_step_[k] * change[k];
    change[k] = direction_[k] = residual_[k] / static_cast<float>(chebyshev.middle);
  });
  for (int i = 1; i < chebyshev.iterations; ++i) {
    for_each_evenly(workers, motion_.size(), smallest_chunk, [&](std::size_t n) {
      velocity_change_[n] = motion_[n].inverse_mass * reaction_to(n, direction_);
    });
    if (!bodies_.empty()) bodies_.respond(direction_, workers);
    chebyshev.advance();
    for_each_evenly(workers, points, smallest_chunk, [&](std::size_t k) {
      if (step[k] == 0) return;
      float& d = direction_[k];
      float flux = flux_at(k, velocity_change_);
      if (!bodies_.empty()) flux += bodies_.flux_at(k);
      residual_[k] -= solve_step_[k] * (d / step[k] + scale * flux);
      d = chebyshev.keep * d + chebyshev.add * residual_[k];
      change[k] += d;
    });
  }
}

}  // namespace oilskin::fluid
