/// Surfaces without an engine: cloth by position-based dynamics, and meshes that move as prescribed.
#pragma once

#include "hosts/grip.h"
#include "oilskin/surface_motion.h"
#include "scene/cloth_model.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// Masses and links in double precision; each sub-step predicts, projects the links in order, and takes
/// velocities from positions, as Bullet does [Mueller2007].
class MockCloth : public SurfaceHost {
 public:
  MockCloth(const Cloth& settings, ClothModel model);

  /// From t to t + dt [s]. `grip`: what holds this cloth; null = nothing.
  void advance(double t, double dt, const Vec3& gravity, Grip* grip = nullptr);

  const std::vector<Vec3>& positions() const { return x_; }
  /// Per node: moves as the scene prescribes.
  std::vector<bool> follows() const;
  /// Frees the nodes that a grip held, but for pins of the scene, which stay where they are.
  void let_go(const Grip& grip);

  Gathered gather(double dt, SurfaceMotion& motion) override;
  void scatter(SurfaceMotion& motion) override;

 private:
  void prescribe(double t);
  void hold(const Grip& grip);
  void project_links();
  void add_carried_mass(SurfaceMotion& motion) const;
  double wet_mass(std::size_t node) const {
    return model_.mass[node] + (absorbed_.empty() ? 0 : absorbed_[node]);
  }

  ClothModel model_;
  int substeps_, iterations_;
  std::vector<Vec3> x_, v_;
  std::vector<double> inverse_mass_, rest_length_;
  std::vector<double> absorbed_;       ///< liquid in each node [kg]; empty = none
  std::vector<bool> held_, released_;  ///< per group of pins
  bool fresh_ = true;
};

/// A mesh that stands still or follows a Motion.
class MockBody : public SurfaceHost {
 public:
  explicit MockBody(const Body& body, const Box& kill_box);

  void advance(double t);
  /// In the next step, of dt [s], it moves with this velocity [m/s] as well.
  void displace(const Vec3& velocity, double dt);

  Gathered gather(double dt, SurfaceMotion& motion) override;
  void scatter(SurfaceMotion& motion) override;

 private:
  Mesh mesh_;
  bool solid_;
  Motion prescribed_;
  Vec3 displaced_ = Vec3::Zero(), pull_ = Vec3::Zero();  ///< [m], [m/s]
  bool was_pulled_ = false;
  std::uint64_t revision_ = 1;  ///< of its places
  std::vector<Vec3> x_, v_;
  bool fresh_ = true;
};

/// The surface of a body as triangles; a plane ends where the kill box does.
Mesh tessellate(const Body& body, const Box& kill_box);

}  // namespace oilskin::demo
