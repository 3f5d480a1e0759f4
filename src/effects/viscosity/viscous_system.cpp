#include "effects/viscosity/viscous_system.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/body_motion.h"

namespace oilskin::effects {

namespace {

/// Masses of nodes over that of a particle: a heavier node does not yield, a lighter one is taken as this.
constexpr double heaviest_node = 1e9, lightest_node = 1e-9;

/// (C.17): nearer to the wall the drag does not grow [dx].
constexpr double nearest = 0.25;

/// Slip length of the law [m], or nothing where the liquid slips freely or by dry friction.
std::optional<double> slip_length(const SurfaceMotion& surface, bool back) {
  const SlipSettings& slip = surface.slip_on(back);
  if (slip.model == SlipModel::sticking) return 0;
  if (slip.model == SlipModel::viscous_wall && std::isfinite(slip.slip_length)) return slip.slip_length;
  return std::nullopt;
}

/// The symmetric square root of a positive semidefinite matrix.
Eigen::Matrix3d root_of(const Eigen::Matrix3d& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> of(a);
  const Vec3 roots = of.eigenvalues().cwiseMax(0).cwiseSqrt();
  return of.eigenvectors() * roots.asDiagonal() * of.eigenvectors().transpose();
}

}  // namespace

void ViscousSystem::build(EffectForces& forces, double coefficient) {
  forces_ = &forces;
  particles_ = forces.id.size();
  const double ratio_of_support = forces.support_radius / forces.spacing;
  if (!drag_ || drag_->ratio() != ratio_of_support) drag_.emplace(ratio_of_support);
  start_.resize(particles_);
  weight_.resize(particles_);
  const ParticleMemory memory(forces);
  forces.for_each(particles_, [&](std::size_t i) {
    start_[i] =
        forces.velocity[i] + forces.dt * (forces.gravity + forces.acceleration[i] + memory.expected(i));
    weight_[i] = ratio(i);
  });
  find_pairs(coefficient);
  find_walls(coefficient);
  find_diagonals();
}

void ViscousSystem::find_pairs(double coefficient) {
  const EffectForces& f = *forces_;
  const double h = f.support_radius;
  const fluid::ViscousWeights weights = fluid::viscous_weights<fluid::CubicSpline>(h / f.spacing);
  pair_begin_.assign(1, 0);
  for (std::size_t i = 0; i < particles_; ++i) pair_begin_.push_back(pair_begin_[i] + f.neighbours(i).size());
  pairs_.resize(pair_begin_.back());
  f.for_each(particles_, [&](std::size_t i) {
    std::size_t k = pair_begin_[i];
    for (std::uint32_t j : f.neighbours(i)) {
      const Vec3 offset = (f.position[i] - f.position[j]) / h;
      const double size = 2 * coefficient * f.dt * viscous_shape(weights, offset.norm());
      pairs_[k++] = {std::sqrt(size) / h * offset, j};
    }
  });
}

std::uint32_t ViscousSystem::unknown_of(std::size_t surface, std::uint32_t node) {
  const SurfaceMotion& s = *forces_->surfaces[surface];
  const double mass = 1 / (s.inverse_mass[node] * forces_->particle_mass);
  if (!(mass < heaviest_node)) return none;
  std::vector<std::uint32_t>& unknown = node_unknown_[surface];
  if (unknown.empty()) unknown.assign(s.x_t1.size(), none);
  if (unknown[node] == none) {
    unknown[node] = static_cast<std::uint32_t>(size());
    weight_.push_back(std::max(mass, lightest_node));
    start_.push_back((s.x_t1[node] - s.x_t0[node]) / forces_->dt +
                     SupportMemory::given(*forces_, surface, node) /
                         (weight_.back() * forces_->particle_mass));
    free_nodes_.push_back({surface, node, unknown[node]});
  }
  return unknown[node];
}

std::uint32_t ViscousSystem::body_of(std::size_t surface) {
  const SurfaceMotion& s = *forces_->surfaces[surface];
  std::uint32_t& body = surface_body_[surface];
  if (body != none) return body;
  body = static_cast<std::uint32_t>(bodies_.size());
  const double mass = forces_->particle_mass;
  bodies_.push_back({surface, static_cast<std::uint32_t>(size()),
                     SupportMemory::expected_of_body(*forces_, surface),
                     (mass * s.body->inverse_mass).cwiseSqrt(), root_of(mass * s.body->inverse_inertia)});
  weight_.resize(size() + 2, 1);
  start_.resize(size(), Vec3::Zero());
  return body;
}

void ViscousSystem::find_velocity(WallTerm& term) {
  const VisibleWall& wall = *term.wall;
  const SurfaceMotion& s = *forces_->surfaces[wall.surface];
  if (s.body) {
    term.body = body_of(wall.surface);
    for (std::size_t k = 0; k < 3; ++k)
      term.arm += wall.weights[k] * (s.x_t0[wall.nodes[k]] - s.body->center_t0);
    const RigidVelocity& velocity = bodies_[term.body].velocity;
    term.base = velocity.linear + velocity.angular.cross(term.arm);
    return;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t node = wall.nodes[k];
    term.node[k] = unknown_of(wall.surface, node);
    if (term.node[k] == none) term.base += wall.weights[k] / forces_->dt * (s.x_t1[node] - s.x_t0[node]);
  }
}

void ViscousSystem::add_wall(const VisibleWall& wall, double coefficient) {
  const EffectForces& f = *forces_;
  const SurfaceMotion& s = *f.surfaces[wall.surface];
  const std::optional<double> length = slip_length(s, wall.back);
  if (!length) return;
  const double offset = std::max(0.0, s.thickness - 0.5 * f.spacing);
  const double z = std::max(wall.distance - offset, nearest * f.spacing);
  const WallDrag::Share drag = (*drag_)(z / f.support_radius);
  const double rate = 2 * coefficient * f.dt * wall.share / f.support_radius;
  WallTerm term{&wall, rate * drag.along / (z + *length), rate * drag.across / z, Vec3::Zero()};
  if (!(term.along > 0 || term.across > 0)) return;
  find_velocity(term);
  walls_.push_back(term);
}

void ViscousSystem::find_walls(double coefficient) {
  walls_.clear();
  free_nodes_.clear();
  wall_begin_.assign(1, 0);
  bodies_.clear();
  node_unknown_.assign(forces_->surfaces.size(), {});
  surface_body_.assign(forces_->surfaces.size(), none);
  for (std::size_t i = 0; i < particles_; ++i) {
    for (const VisibleWall& wall : forces_->walls(i)) add_wall(wall, coefficient);
    wall_begin_.push_back(walls_.size());
  }
}

void ViscousSystem::find_diagonals() {
  inverse_diagonal_.assign(size(), Eigen::Matrix3d::Identity());
  forces_->for_each(particles_, [&](std::size_t i) {
    Eigen::Matrix3d& d = inverse_diagonal_[i];
    for (std::size_t k = pair_begin_[i]; k < pair_begin_[i + 1]; ++k)
      d += weight_[pairs_[k].other] * pairs_[k].s * pairs_[k].s.transpose();
  });
  for (std::size_t i = 0; i < particles_; ++i)
    for (std::size_t w = wall_begin_[i]; w < wall_begin_[i + 1]; ++w) {
      const WallTerm& t = walls_[w];
      const Vec3& n = t.wall->normal;
      const Eigen::Matrix3d block =
          t.along * Eigen::Matrix3d::Identity() + (t.across - t.along) * n * n.transpose();
      inverse_diagonal_[i] += block;
      for (std::size_t k = 0; k < 3; ++k) {
        const double b = t.wall->weights[k];
        if (t.node[k] != none)
          inverse_diagonal_[t.node[k]] += weight_[i] / weight_[t.node[k]] * b * b * block;
      }
      if (t.body == none) continue;
      const FreeBody& body = bodies_[t.body];
      const Eigen::Matrix3d turning = body.angular * cross_matrix(t.arm);
      inverse_diagonal_[body.unknown] +=
          weight_[i] * body.linear.asDiagonal() * block * body.linear.asDiagonal();
      inverse_diagonal_[body.unknown + 1] += weight_[i] * turning * block * turning.transpose();
    }
  largest_diagonal_ = 1;
  for (Eigen::Matrix3d& d : inverse_diagonal_) {
    largest_diagonal_ = std::max(largest_diagonal_, d.trace());
    d = d.inverse().eval();
  }
}

Vec3 ViscousSystem::relative(const WallTerm& term, std::size_t i, const Vector& x, bool walls_move) const {
  Vec3 v = x[i];
  if (walls_move) v -= term.base;
  for (std::size_t k = 0; k < 3; ++k)
    if (term.node[k] != none) v -= term.wall->weights[k] * x[term.node[k]];
  if (term.body != none) v -= bodies_[term.body].change_at(term.arm, x);
  return v;
}

Vec3 ViscousSystem::traction(const WallTerm& term, std::size_t i, const Vector& x, bool walls_move) const {
  const Vec3 v = relative(term, i, x, walls_move), &n = term.wall->normal;
  return term.along * v + (term.across - term.along) * v.dot(n) * n;
}

void ViscousSystem::drag(const Vector& x, Vector& result, bool walls_move) const {
  result.assign(size(), Vec3::Zero());
  forces_->for_each(particles_, [&](std::size_t i) {
    Vec3 sum = Vec3::Zero();
    const Vec3& own = x[i];
    for (std::size_t k = pair_begin_[i]; k < pair_begin_[i + 1]; ++k) {
      const Pair& p = pairs_[k];
      sum += weight_[p.other] * p.s.dot(own - x[p.other]) * p.s;
    }
    for (std::size_t w = wall_begin_[i]; w < wall_begin_[i + 1]; ++w)
      sum += traction(walls_[w], i, x, walls_move);
    result[i] = sum;
  });
  if (size() == particles_) return;
  for (std::size_t i = 0; i < particles_; ++i)  // in fixed order: particles share nodes
    for (std::size_t w = wall_begin_[i]; w < wall_begin_[i + 1]; ++w) {
      const WallTerm& t = walls_[w];
      const Vec3 force = weight_[i] * traction(t, i, x, walls_move);
      for (std::size_t k = 0; k < 3; ++k)
        if (t.node[k] != none) result[t.node[k]] -= t.wall->weights[k] / weight_[t.node[k]] * force;
      if (t.body == none) continue;
      const FreeBody& body = bodies_[t.body];
      result[body.unknown] -= body.linear.cwiseProduct(force);
      result[body.unknown + 1] -= body.angular * t.arm.cross(force);
    }
}

void ViscousSystem::precondition(const Vector& x, Vector& result) const {
  result.resize(size());
  forces_->for_each(size(), [&](std::size_t i) { result[i] = inverse_diagonal_[i] * x[i]; });
}

double ViscousSystem::dot(const Vector& x, const Vector& y) const {
  products_.resize(size());
  forces_->for_each(size(), [&](std::size_t i) { products_[i] = weight_[i] * x[i].dot(y[i]); });
  double sum = 0;
  for (double p : products_) sum += p;
  return sum;
}

double ViscousSystem::scale() const {
  Vec3 mean = Vec3::Zero();
  double mass = 0;
  for (std::size_t i = 0; i < particles_; ++i) {
    mean += weight_[i] * start_[i];
    mass += weight_[i];
  }
  if (mass > 0) mean /= mass;
  double square = 0;
  for (std::size_t i = 0; i < particles_; ++i) {
    square += weight_[i] * (start_[i] - mean).squaredNorm();
    for (std::size_t w = wall_begin_[i]; w < wall_begin_[i + 1]; ++w)
      square += weight_[i] * walls_[w].wall->share * relative(walls_[w], i, start_, true).squaredNorm();
  }
  return std::sqrt(square);
}

double ViscousSystem::rounding() const {
  double square = 0;
  for (std::size_t i = 0; i < particles_; ++i) square += weight_[i] * start_[i].squaredNorm();
  return largest_diagonal_ * std::numeric_limits<double>::epsilon() * std::sqrt(square);
}

double ViscousSystem::work_of_walls(const Vector& x) const {
  double work = 0;
  for (std::size_t i = 0; i < particles_; ++i)
    for (std::size_t w = wall_begin_[i]; w < wall_begin_[i + 1]; ++w)
      work -= weight_[i] * walls_[w].base.dot(traction(walls_[w], i, x, true));
  return work;
}

void ViscousSystem::react(const Vector& x, const Vector& drag, double share) {
  for (std::size_t i = 0; i < particles_; ++i)
    for (std::size_t w = wall_begin_[i]; w < wall_begin_[i + 1]; ++w) {
      const WallTerm& t = walls_[w];
      const double size = share * forces_->mass(i) / forces_->dt;
      forces_->push(t.wall->surface, t.wall->nodes, t.wall->weights, size * traction(t, i, x, true));
    }
  for (const FreeNode& n : free_nodes_) {
    const double mass = weight_[n.unknown] * forces_->particle_mass;
    SupportMemory::record(*forces_, n.surface, n.node, -share * mass * drag[n.unknown]);
  }
  for (const FreeBody& b : bodies_)
    SupportMemory::record_of_body(
        *forces_, b.surface,
        {-share * b.linear.cwiseProduct(drag[b.unknown]), -share * (b.angular * drag[b.unknown + 1])});
}

}  // namespace oilskin::effects
