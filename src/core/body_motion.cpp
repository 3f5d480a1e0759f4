#include "core/body_motion.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/body_path.h"
#include "core/inverse_mass.h"
#include "core/refuse.h"

namespace oilskin {

namespace {

constexpr double max_number = 1e15;

bool is_in_range(const Vec3& x) {
  return (x.array().abs() < max_number).all();
}

/// Eigenvalues below this part of the largest are rounding.
constexpr double rounding = 1e-10;

Status check_inertia(const Eigen::Matrix3d& inverse) {
  const double largest = inverse.cwiseAbs().maxCoeff();
  if (!inverse.allFinite() || !(largest < 1e200))
    return refuse("the inverse inertia of the body is not finite, or above 1e200");
  if ((inverse - inverse.transpose()).cwiseAbs().maxCoeff() > rounding * largest)
    return refuse("the inverse inertia of the body is not symmetric");
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> of(inverse, Eigen::EigenvaluesOnly);
  if (of.eigenvalues().minCoeff() < -rounding * largest)
    return refuse("the inverse inertia of the body is not positive semidefinite");
  return {};
}

}  // namespace

Eigen::Matrix3d cross_matrix(const Vec3& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

Eigen::Matrix3d inverse_mass_at(const BodyMotion& body, const Vec3& arm) {
  const Eigen::Matrix3d r = cross_matrix(arm);
  Eigen::Matrix3d a = r * body.inverse_inertia * r.transpose();
  a.diagonal() += body.inverse_mass;
  return a;
}

double largest_across(const Eigen::Matrix3d& a, const Vec3& n) {
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  const double uu = u.dot(a * u), vv = v.dot(a * v), uv = u.dot(a * v);
  return 0.5 * (uu + vv + std::hypot(uu - vv, 2 * uv));
}

void set_node_velocities(SurfaceMotion& s) {
  if (!s.body) return;
  for (std::size_t i = 0; i < s.velocity.size(); ++i)
    s.velocity[i] = velocity_at(*s.body, s.x_t0[i] - s.body->center_t0);
}

Eigen::Matrix3d inertia_of(const BodyMotion& body) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> of(body.inverse_inertia);
  const double least = rounding * of.eigenvalues().cwiseAbs().maxCoeff();
  Vec3 inertia = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    if (of.eigenvalues()[k] > least) inertia[k] = 1 / of.eigenvalues()[k];
  return of.eigenvectors() * inertia.asDiagonal() * of.eigenvectors().transpose();
}

bool is_free(const BodyMotion& body) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> of(body.inverse_inertia, Eigen::EigenvaluesOnly);
  return (body.inverse_mass.array() > 0).all() &&
         of.eigenvalues().minCoeff() > rounding * of.eigenvalues().maxCoeff();
}

void start_body(SurfaceMotion& m, const std::optional<BodyMotion>& before, bool is_new, double dt) {
  if (!m.body) return;
  m.body->host_step = dt;
  if (is_new)
    m.body->center_t0 = m.body->center_t1;
  else
    m.body->center_t0 = before ? before->center_t1 : center_at_start(m);
  m.body->impulse.setZero();
  m.body->angular_impulse.setZero();
}

Status check_body(const SurfaceMotion& s) {
  if (!s.body) return {};
  const BodyMotion& body = *s.body;
  for (const Vec3* x : {&body.center_t1, &body.velocity, &body.angular_velocity, &body.gravity})
    if (!is_in_range(*x))
      return refuse("the centre, a velocity or the gravity of the body is not finite, or beyond 1e15");
  for (int k = 0; k < 3; ++k)
    if (!is_inverse_mass(body.inverse_mass[k]))
      return refuse("an inverse mass of the body is ", body.inverse_mass[k], "; it must be ",
                    inverse_mass_range);
  if (std::any_of(s.inverse_mass.begin(), s.inverse_mass.end(), [](double u) { return u != 0; }))
    return refuse("the nodes of a body must have the inverse mass 0");
  return check_inertia(body.inverse_inertia);
}

}  // namespace oilskin
