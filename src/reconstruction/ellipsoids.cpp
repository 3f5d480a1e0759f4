// Particles as ellipsoids [Yu2013], (R.35) to (R.38).
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/assert.h"
#include "reconstruction/nearest_triangle.h"
#include "reconstruction/particle_blocks.h"
#include "reconstruction/run.h"
#include "reconstruction/visibility.h"

namespace oilskin {

namespace {

using namespace reconstruction;  // NOLINT: the module of this file
using Eigen::Matrix3d;
using simd::F8;

constexpr double pi = 3.14159265358979323846;

/// The grid that sorts the particles [spacings].
constexpr double cell_of_spacing = 0.5;

/// Ellipsoids fill this fraction of the space up to the gap, so that rounding to float does not close it.
constexpr double used_space = 0.999;

/// Near obstacles a particle moves by this fraction of its distance from the gap at most.
constexpr double free_move = 0.5;

/// An obstacle flattens an ellipsoid to this fraction at most; then it becomes smaller.
constexpr double min_flatness = 0.1;

/// A centre and the matrix that maps the unit sphere to the ellipsoid [m].
struct Shape {
  Vec3 centre = Vec3::Zero();
  Matrix3d map = Matrix3d::Zero();
};

/// The neighbours of a particle that it sees.
struct Neighbourhood {
  std::vector<Vec3> offset;    // [m]
  std::vector<double> weight;  // (R.35)

  void clear() {
    offset.clear();
    weight.clear();
  }
  /// Sums (R.35): false without weight.
  bool moments(Vec3& mean, Matrix3d& covariance) const {
    double sum = 0;
    mean.setZero();
    covariance.setZero();
    for (std::size_t i = 0; i < weight.size(); ++i) {
      sum += weight[i];
      mean += weight[i] * offset[i];
    }
    if (!(sum > 0)) return false;
    mean /= sum;
    for (std::size_t i = 0; i < weight.size(); ++i)
      covariance += weight[i] / sum * (offset[i] - mean) * (offset[i] - mean).transpose();
    return true;
  }
};

class EllipsoidMaker {
 public:
  EllipsoidMaker(const ReconstructionInput& input, const EllipsoidOptions& options)
      : input_(input),
        options_(options),
        workers_(options.threads),
        cell_(cell_of_spacing * options.spacing),
        reach_(options.reach * options.spacing),
        obstacles_(input.obstacles) {
    sort_into_blocks(input, cell_, workers_, particles_);
    if (obstacles_.empty()) return;
    obstacles_.prepare_queries(workers_);
    obstacles_.prepare_normals(workers_);
  }

  std::vector<WaterEllipsoid> make() {
    std::vector<WaterEllipsoid> result(input_.positions.size(), none_at(Vec3::Zero()));
    // Those without water are not among the particles.
    for (std::size_t i = 0; i < input_.volumes.size(); ++i)
      if (input_.positions[i].allFinite()) result[i] = none_at(input_.positions[i]);
    workers_.for_chunks(particles_.blocks.size(), 16, [&](std::size_t from, std::size_t to, std::size_t) {
      NearParticles near;
      NearestTriangle triangles;
      Neighbourhood neighbours;
      for (std::size_t b = from; b < to; ++b) {
        near.gather(particles_, {}, particles_.blocks[b], 0, side, float(reach_ / cell_));
        prepare(b, triangles);
        triangles.set_planes();
        for (std::size_t p = particles_.begin[b]; p < particles_.begin[b + 1]; ++p) {
          const double distance = obstacles_.empty() ? std::numeric_limits<double>::infinity()
                                                     : triangles.find(place(p)).distance;
          neighbours.clear();
          if (!is_crowded(b)) collect(p, distance, near, triangles, neighbours);
          result[particles_.source[p]] = ellipsoid(p, distance, neighbours, triangles);
        }
      }
    });
    return result;
  }

 private:
  static WaterEllipsoid none_at(const Vec3& x) {
    WaterEllipsoid e{};
    e.position = {float(x.x()), float(x.y()), float(x.z())};
    for (std::size_t k = 0; k < 3; ++k) e.axes[k][k] = 1;
    return e;
  }
  const Vec3& place(std::size_t p) const { return input_.positions[particles_.source[p]]; }
  double volume(std::size_t p) const {
    return input_.volumes.empty() ? std::pow(options_.spacing, 3) : input_.volumes[particles_.source[p]];
  }
  /// An ellipsoid of one particle is not larger than this [m].
  double largest(std::size_t p) const {
    const double widened = 1 / std::sqrt(min_flatness);
    return radius(p) * std::pow(options_.max_stretch, 2.0 / 3) * widened;
  }
  double radius(std::size_t p) const { return std::cbrt(0.75 / pi * volume(p)); }

  /// The triangles that matter for the particles of a block.
  void prepare(std::size_t b, NearestTriangle& triangles) const {
    if (obstacles_.empty()) return;
    Box box;
    double farthest = reach_;
    for (std::size_t p = particles_.begin[b]; p < particles_.begin[b + 1]; ++p) {
      box.add(place(p));
      farthest = std::max(farthest, reach_ + largest(p) + options_.gap);
    }
    triangles.set(obstacles_, box, farthest);
  }
  /// Far too many particles in a block (a wrong spacing): without neighbours, since the work is quadratic.
  bool is_crowded(std::size_t b) const { return particles_.begin[b + 1] - particles_.begin[b] > 4096; }
  /// No obstacle touches the segment between two particles. `free`: of p from obstacles, up to that of
  /// prepare() [m].
  bool sees(std::size_t p, std::size_t q, double distance, double free,
            const NearestTriangle& triangles) const {
    if (distance < free) return true;
    return !triangles.is_any_between(place(p), place(q), [&](std::uint32_t t) {
      return hides_segment(place(p), place(q), obstacles_.corners(t), obstacles_.indices(t));
    });
  }
  void collect(std::size_t p, double free, const NearParticles& near, const NearestTriangle& triangles,
               Neighbourhood& out) const {
    const F8 x = particles_.x[p], y = particles_.y[p], z = particles_.z[p];
    const auto reach = static_cast<float>(1.0001 * reach_ / cell_);
    for (std::size_t c = 0; c < near.padded(); c += 8) {
      const F8 dx = F8::load(&near.x[c]) - x, dy = F8::load(&near.y[c]) - y, dz = F8::load(&near.z[c]) - z;
      for (std::uint32_t bits = greater_mask(reach * reach, dx * dx + dy * dy + dz * dz); bits != 0;
           bits &= bits - 1)
        add(p, near.particle[c + std::size_t(__builtin_ctz(bits))], free, triangles, out);
    }
  }
  /// Adds a neighbour in reach that p sees.
  void add(std::size_t p, std::size_t q, double free, const NearestTriangle& triangles,
           Neighbourhood& out) const {
    const Vec3 offset = place(q) - place(p);
    const double distance = offset.norm(), share = distance / reach_;
    if (!(share < 1) || (q != p && !sees(p, q, distance, free, triangles))) return;
    out.offset.push_back(offset);
    out.weight.push_back(1 - share * share * share);
  }

  WaterEllipsoid ellipsoid(std::size_t p, double free, const Neighbourhood& neighbours,
                           const NearestTriangle& triangles) const {
    const double r = radius(p);
    if (!(r > 0)) return none_at(place(p));
    Shape shape;
    shape.centre = place(p);
    shape.map = r * Matrix3d::Identity();
    Vec3 mean;
    Matrix3d covariance;
    if (neighbours.moments(mean, covariance)) {
      const double length = options_.smoothing * mean.norm(),
                   most = free_move * std::max(0.0, free - options_.gap);
      shape.centre += options_.smoothing * std::min(1.0, length > 0 ? most / length : 1.0) * mean;
      // The particle is among its neighbours.
      if (int(neighbours.weight.size()) > options_.min_neighbours) shape.map = stretched(covariance, r);
    }
    if (!obstacles_.empty() && !fit(shape, r, largest(p), triangles)) return none_at(shape.centre);
    return rounded(shape);
  }
  /// (R.36)
  Matrix3d stretched(const Matrix3d& covariance, double r) const {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance);
    Vec3 length = solver.eigenvalues();
    length = length.cwiseMax(length.maxCoeff() / options_.max_stretch);
    if (!(length.minCoeff() > 0)) return r * Matrix3d::Identity();
    length *= r / std::cbrt(length.prod());
    return solver.eigenvectors() * length.asDiagonal();
  }
  /// Makes the ellipsoid end at the gap. A sphere that does so takes its place if it is larger. False if
  /// there is no space.
  bool fit(Shape& shape, double r, double farthest, const NearestTriangle& triangles) const {
    const ClosestPoint nearest = triangles.find(shape.centre);
    const double space = used_space * (nearest.distance - options_.gap), sphere = std::min(r, space);
    if (!(space > 0)) return false;
    flatten(shape, nearest.offset / nearest.distance, space);
    shape.map *= free_scale(shape, farthest, triangles);
    if (std::abs(shape.map.determinant()) < std::pow(sphere, 3)) shape.map = sphere * Matrix3d::Identity();
    return true;
  }
  /// The factor by which the ellipsoid ends at the gap (R.38), 0 … 1.
  double free_scale(const Shape& shape, double farthest, const NearestTriangle& triangles) const {
    double scale = 1;
    const Matrix3d inverse = shape.map.inverse();
    // No point of an ellipsoid is farther from its centre than the norm of its matrix.
    const double reach = std::min(farthest, shape.map.norm()) + options_.gap;
    triangles.for_within(shape.centre, reach, [&](std::uint32_t t) {
      Corners c = obstacles_.corners(t);
      for (Vec3& x : c) x = inverse * (x - shape.centre);
      const ClosestPoint at = closest_point(Vec3::Zero(), c[0], c[1], c[2]);
      if (at.distance > 0) {
        // The plane through this point that touches the scaled ellipsoid has this normal.
        const Vec3 normal = (inverse.transpose() * at.offset).normalized();
        const double support = (shape.map.transpose() * normal).norm();
        scale = std::min(scale, used_space * (at.distance - options_.gap / support));
      } else {
        scale = 0;
      }
    });
    return std::max(0.0, scale);
  }
  /// (R.37): from an obstacle below it, `space` away.
  static void flatten(Shape& shape, const Vec3& normal, double space) {
    const double extent = (shape.map.transpose() * normal).norm();
    if (!(extent > space)) return;
    const double flatness = std::max(space / extent, min_flatness), wide = 1 / std::sqrt(flatness);
    shape.map = (wide * Matrix3d::Identity() + (flatness - wide) * normal * normal.transpose()) * shape.map;
  }
  static WaterEllipsoid rounded(const Shape& shape) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(shape.map * shape.map.transpose());
    WaterEllipsoid e = none_at(shape.centre);
    Matrix3d axes = solver.eigenvectors().rowwise().reverse();
    if (axes.determinant() < 0) axes.col(2) *= -1;
    for (int k = 0; k < 3; ++k) {
      for (int a = 0; a < 3; ++a) e.axes[std::size_t(k)][std::size_t(a)] = static_cast<float>(axes(a, k));
      e.radii[std::size_t(k)] = static_cast<float>(std::sqrt(std::max(0.0, solver.eigenvalues()[2 - k])));
    }
    e.thickness = static_cast<float>(4.0 / 3) * e.radii[2];
    return e;
  }

  const ReconstructionInput& input_;
  const EllipsoidOptions& options_;
  Workers workers_;
  double cell_, reach_;
  Obstacles obstacles_;
  ParticleBlocks particles_;
};

}  // namespace

Status make_ellipsoids(const ReconstructionInput& input, const EllipsoidOptions& options,
                       std::vector<WaterEllipsoid>* ellipsoids) {
  OILSKIN_ASSERT(ellipsoids != nullptr);
  if (Status s = options.validate(); !s.ok()) return s;
  if (Status s = validate_input(input, options.spacing); !s.ok()) return s;
  *ellipsoids = EllipsoidMaker(input, options).make();
  return {};
}

}  // namespace oilskin
