// Position based fluids [Macklin2013]; particles are projected out of triangles within the iterations.
#include <algorithm>
#include <cmath>

#include "study/comparators/make_methods.h"
#include "study/comparators/particle_method.h"

namespace oilskin::study {
namespace {

/// Density iterations a step: more than the two to four that games take, so that the density is that of
/// water.
constexpr int iterations = 10;
/// ε of [Macklin2013] Eq. 11, over the sum of a full neighbourhood.
constexpr double relaxation = 0.01;
/// c of [Macklin2013] Eq. 17, per interval: the common rate is less below 1.1 ms at dx = 5 mm.
constexpr double least_smoothing = 0.01;

class PositionBasedMethod : public ParticleMethod {
 public:
  explicit PositionBasedMethod(const MethodSettings& s)
      : ParticleMethod(s, 1 / lattice_sum(poly6, s.spacing, 2 * s.spacing), least_smoothing),
        radius_(0.5 * s.spacing),
        full_(lattice_sum(slope_square, s.spacing, support_) * volume_ * volume_) {}

 protected:
  void advance(double dt) override {
    if (x_.empty()) return;
    predicted_.resize(x_.size());
    for (std::size_t i = 0; i < x_.size(); ++i) predicted_[i] = x_[i] + dt * (v_[i] + dt * settings_.gravity);
    lists_.search(predicted_, predicted_, support_ + 0.5 * settings_.spacing, true);
    near_ = find_near(predicted_, surfaces_, 2 * radius_, At::end);
    pressure_.assign(x_.size(), 0);
    for (int k = 0; k < iterations; ++k) {
      find_multipliers(k == 0, dt);
      correct_positions();
      project(dt);
    }
    for (std::size_t i = 0; i < x_.size(); ++i) {
      v_[i] = (predicted_[i] - x_[i]) / dt;
      x_[i] = predicted_[i];
    }
    smooth(lists_, x_, dt);
  }

 private:
  static double slope_square(double r, double h) { return std::pow(r * spiky_slope(r, h), 2); }

  /// λ, [Macklin2013] Eq. 11 [m²]. Only compression counts: with tension, lone particles form clumps, which
  /// the artificial pressure of its section 4 prevents at one length of step alone.
  void find_multipliers(bool first, double dt) {
    lambda_.resize(x_.size()), slope_.resize(lists_.begin(x_.size()));
    for (std::size_t i = 0; i < x_.size(); ++i) {
      double density = volume_ * poly6(0, support_), squares = 0;
      Vec3 own = Vec3::Zero();
      std::size_t pair = lists_.begin(i);
      for (std::uint32_t j : lists_.of(i)) {
        Vec3& slope = slope_[pair++];
        slope.setZero();
        const Vec3 offset = predicted_[i] - predicted_[j];
        const double r2 = offset.squaredNorm();
        if (r2 >= support_ * support_) continue;
        const double r = std::sqrt(r2);
        density += volume_ * poly6(r, support_);
        slope = volume_ * spiky_slope(r, support_) * offset;
        own += slope;
        squares += slope.squaredNorm();
      }
      if (first) density_[i] = settings_.rest_density * density;
      lambda_[i] = -std::max(density - 1, 0.0) / (squares + own.squaredNorm() + relaxation * full_);
      pressure_[i] -= lambda_[i] * settings_.rest_density / (dt * dt);
    }
  }
  /// [Macklin2013] Eq. 12. Equal and opposite.
  void correct_positions() {
    change_.assign(x_.size(), Vec3::Zero());
    for (std::size_t i = 0; i < x_.size(); ++i) {
      std::size_t pair = lists_.begin(i);
      for (std::uint32_t j : lists_.of(i)) change_[i] += (lambda_[i] + lambda_[j]) * slope_[pair++];
    }
    for (std::size_t i = 0; i < x_.size(); ++i) predicted_[i] += change_[i];
  }
  /// Each particle to its radius from the planes that it was found near, on the side where it was found.
  /// Nodes move by their inverse masses, and get the impulse of what they moved.
  void project(double dt) {
    const double inverse_mass = 1 / particle_mass();
    for (const Near& n : near_) {
      SurfaceMotion& m = surfaces_[n.surface];
      double weight = inverse_mass;
      Vec3 offset = predicted_[n.particle];
      for (std::size_t k = 0; k < 3; ++k) {
        weight += n.weights[k] * n.weights[k] * m.inverse_mass[n.nodes[k]];
        offset -= n.weights[k] * m.x_t1[n.nodes[k]];
      }
      const double depth = radius_ - offset.dot(n.normal);
      if (depth <= 0) continue;
      const Vec3 push = depth / weight * n.normal;  // [kg m]
      predicted_[n.particle] += inverse_mass * push;
      for (std::size_t k = 0; k < 3; ++k)
        m.x_t1[n.nodes[k]] -= m.inverse_mass[n.nodes[k]] * n.weights[k] * push;
      surfaces_.push(n.surface, n.nodes, n.weights, -push / dt);
    }
  }

  double radius_, full_;  // [m], Σ|∇C|² of the lattice [1/m²]
  NeighbourLists lists_;
  std::vector<Near> near_;
  std::vector<Vec3> predicted_, change_, slope_;  // slope_: V ∇W of each pair [1/m]
  std::vector<double> lambda_;
};

}  // namespace

std::unique_ptr<CouplingMethod> make_position_based_method(const MethodSettings& settings) {
  return std::make_unique<PositionBasedMethod>(settings);
}

}  // namespace oilskin::study
