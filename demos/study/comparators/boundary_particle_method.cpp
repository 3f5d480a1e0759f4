// DFSPH [Bender2015] with boundary particles on the triangles [Akinci2012].
#include <algorithm>
#include <cmath>

#include "study/comparators/boundary_samples.h"
#include "study/comparators/make_methods.h"
#include "study/comparators/particle_method.h"

namespace oilskin::study {
namespace {

/// τ over √(dx/g), g = 9.81 m/s².
constexpr double correction_time = 0.9;

/// A pair with a boundary particle has the volume of that, and the velocity of its point.
struct Pair {
  std::uint32_t other = 0;
  Vec3 slope = Vec3::Zero();  ///< V ∇W [1/m], V the volume of the other
};

class BoundaryParticleMethod : public ParticleMethod {
 public:
  explicit BoundaryParticleMethod(const MethodSettings& s)
      : ParticleMethod(s, 1 / lattice_sum(cubic_spline, s.spacing, 2 * s.spacing)),
        boundary_(s.spacing, support_) {}

 protected:
  void advance(double dt) override {
    if (x_.empty()) return;
    boundary_.update(surfaces_);
    find_pairs();
    find_boundary_velocities();
    pressure_.assign(x_.size(), 0);
    match_particles();
    correct_divergence(dt);
    for (Vec3& v : v_) v += dt * settings_.gravity;
    smooth(lists_, x_, dt);
    correct_density(dt);
    push_surfaces();
    for (std::size_t i = 0; i < x_.size(); ++i) x_[i] += dt * v_[i];
  }

 private:
  /// Pressures of the last step for the particles that are left; ids ascend.
  void match_particles() {
    std::size_t k = 0;
    for (std::size_t i = 0; i < id_.size(); ++i) {
      while (k < warm_id_.size() && warm_id_[k] < id_[i]) ++k;
      const bool known = k < warm_id_.size() && warm_id_[k] == id_[i];
      if (warm_density_.size() <= i) warm_density_.resize(i + 1), warm_divergence_.resize(i + 1);
      warm_density_[i] = known ? warm_density_[k] : 0;
      warm_divergence_[i] = known ? warm_divergence_[k] : 0;
    }
    warm_id_ = id_;
  }
  /// Densities, and the D of each particle: its rate of compression changes by −D k in a time in which it has
  /// the stiffness k, [Bender2015] Eq. 7 and 8 without their density.
  void find_pairs() {
    lists_.search(x_, x_, support_, true);
    walls_.search(x_, boundary_.positions(), support_, false);
    pairs_.clear(), wall_pairs_.clear();
    density_.resize(x_.size()), diagonal_.resize(x_.size());
    for (std::size_t i = 0; i < x_.size(); ++i) {
      double sum = volume_ * cubic_spline(0, support_), squares = 0;
      Vec3 slope = Vec3::Zero();
      for (std::uint32_t j : lists_.of(i)) {
        add_pair(i, x_[j], j, volume_, sum, slope, pairs_);
        squares += pairs_.back().slope.squaredNorm();
      }
      for (std::uint32_t b : walls_.of(i))
        add_pair(i, boundary_.positions()[b], b, boundary_.volume(b), sum, slope, wall_pairs_);
      density_[i] = settings_.rest_density * sum;
      // Of a lone pair D vanishes with its slope: no stiffness would be large enough.
      diagonal_[i] = std::max(slope.squaredNorm() + squares, 1e-6 / (support_ * support_));
    }
  }
  void add_pair(std::size_t i, const Vec3& other, std::uint32_t index, double volume, double& sum,
                Vec3& slope, std::vector<Pair>& pairs) const {
    const Vec3 offset = x_[i] - other;
    const double r = offset.norm();
    sum += volume * cubic_spline(r, support_);
    pairs.push_back({index, volume * cubic_spline_slope(r, support_) * offset});
    slope += pairs.back().slope;
  }
  /// Host velocities, with what the impulses of this step changed.
  void find_boundary_velocities() {
    wall_velocity_.resize(boundary_.size());
    wall_impulse_.assign(boundary_.size(), Vec3::Zero());
    for (std::size_t b = 0; b < boundary_.size(); ++b) {
      const BoundarySample& s = boundary_.sample(b);
      wall_velocity_[b] = Vec3::Zero();
      for (std::size_t k = 0; k < 3; ++k)
        wall_velocity_[b] += s.weights[k] * surfaces_[s.surface].velocity[s.nodes[k]];
    }
  }
  Span<const Pair> pairs(std::size_t i) const {
    return {pairs_.data() + lists_.begin(i), lists_.of(i).size()};
  }
  Span<const Pair> wall_pairs(std::size_t i) const {
    return {wall_pairs_.data() + walls_.begin(i), walls_.of(i).size()};
  }
  /// The rate of the relative density [1/s] at the present velocities.
  double compression(std::size_t i) const {
    double rate = 0;
    for (const Pair& p : pairs(i)) rate += p.slope.dot(v_[i] - v_[p.other]);
    for (const Pair& p : wall_pairs(i)) rate += p.slope.dot(v_[i] - wall_velocity_[p.other]);
    return rate;
  }

  /// [Bender2015] Alg. 2. Particles with few neighbours are at the surface: their divergence is free.
  void correct_divergence(double dt) {
    constexpr std::size_t full = 20;
    solve(dt, 1, settings_.tolerance, warm_divergence_, [&](std::size_t i) {
      return lists_.of(i).size() + walls_.of(i).size() < full ? -1.0 : dt * compression(i);
    });
  }
  /// [Bender2015] Alg. 3, but compression that the step finds is corrected within the time τ: corrected at
  /// once, what an impact compressed bursts, at short steps the faster.
  void correct_density(double dt) {
    const double tau = correction_time * std::sqrt(settings_.spacing / 9.81);
    const double part = std::min(1.0, dt / tau);
    solve(dt, 2, part * settings_.tolerance, warm_density_, [&](std::size_t i) {
      const double found = density_[i] / settings_.rest_density - 1;
      return (found > 0 ? part : 1) * found + dt * compression(i);
    });
  }

  /// Relaxed Jacobi iterations for pressures ≥ 0, from those of the last step, as in [Ihmsen2014]. They
  /// end where the mean of |error(i)| is within the tolerance; error: the relative density that is too much
  /// at the end of the step. It is free to be negative where there is no pressure.
  template <class Error>
  void solve(double dt, int min_iterations, double tolerance, std::vector<double>& warm, const Error& error) {
    constexpr int max_iterations = 100;
    constexpr double relaxation = 0.5;
    std::vector<double> stiffness(x_.size()), step(x_.size());  // impulses over mass and slope [m²/s]
    for (std::size_t i = 0; i < x_.size(); ++i)
      stiffness[i] = step[i] = warm[i] * dt / settings_.rest_density;
    push(step);
    for (int k = 0; k < max_iterations; ++k) {
      double sum = 0;
      for (std::size_t i = 0; i < x_.size(); ++i) {
        const double e = error(i);
        if (e > 0 || stiffness[i] > 0) sum += std::abs(e);
        step[i] = std::max(relaxation * e / (dt * diagonal_[i]), -stiffness[i]);
      }
      if (k >= min_iterations && sum <= tolerance * static_cast<double>(x_.size())) break;
      push(step);
      for (std::size_t i = 0; i < x_.size(); ++i) stiffness[i] += step[i];
    }
    for (std::size_t i = 0; i < x_.size(); ++i) {
      warm[i] = settings_.rest_density * stiffness[i] / dt;
      pressure_[i] += warm[i];
    }
  }
  /// Equal and opposite between particles, and between a particle and a boundary particle, [Akinci2012] Eq. 9
  /// and 10.
  void push(const std::vector<double>& stiffness) {
    change_.assign(x_.size(), Vec3::Zero());
    for (std::size_t i = 0; i < x_.size(); ++i) {
      for (const Pair& p : pairs(i)) change_[i] -= (stiffness[i] + stiffness[p.other]) * p.slope;
      if (stiffness[i] == 0) continue;
      for (const Pair& p : wall_pairs(i)) {
        change_[i] -= stiffness[i] * p.slope;
        wall_impulse_[p.other] += particle_mass() * stiffness[i] * p.slope;
      }
    }
    for (std::size_t i = 0; i < x_.size(); ++i) v_[i] += change_[i];
  }

  /// What a boundary particle took, the nodes of its triangle get.
  void push_surfaces() {
    for (std::size_t b = 0; b < boundary_.size(); ++b) {
      const BoundarySample& s = boundary_.sample(b);
      surfaces_.push(s.surface, s.nodes, s.weights, wall_impulse_[b]);
    }
  }

  BoundarySamples boundary_;
  NeighbourLists lists_, walls_;
  std::vector<Pair> pairs_, wall_pairs_;
  std::vector<double> diagonal_, warm_density_, warm_divergence_;  // the latter [Pa]
  std::vector<std::uint64_t> warm_id_;
  std::vector<Vec3> wall_velocity_, wall_impulse_, change_;
};

}  // namespace

std::unique_ptr<CouplingMethod> make_boundary_particle_method(const MethodSettings& settings) {
  return std::make_unique<BoundaryParticleMethod>(settings);
}

}  // namespace oilskin::study
