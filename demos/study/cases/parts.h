/// Pieces of the scenes of validation cases.
#pragma once

#include "checks/check.h"
#include "oilskin/world.h"
#include "scene/scene.h"

namespace oilskin::demo {

constexpr double earth = 9.81;          // [m/s²]
constexpr double water_density = 1000;  // [kg/m³]

/// A scene of water alone: mock host, contact verified, no pictures, steps of a fifth of a second per metre
/// of spacing (1 ms at 5 mm) [s].
Scene empty_scene(double spacing, double duration);

/// A box of water at rest.
FilledBox water_box(const Vec3& low, const Vec3& high);

/// A tank without friction, open at the top.
Body tank_body(const Vec3& low, const Vec3& high);

/// The parallelogram corner + s u + t v of nu × nv cells of two triangles each; its front is along u × v.
Mesh sheet_mesh(const Vec3& corner, const Vec3& u, const Vec3& v, int nu = 1, int nv = 1);
/// Adds the triangles of `part` to `mesh`, with nodes of their own.
void append(Mesh& mesh, const Mesh& part);
Body mesh_body(Mesh mesh);

/// True at the first step, and then every `interval` seconds.
class Every {
 public:
  explicit Every(double interval) : interval_(interval) {}

  bool reached(const Moment& now) {
    if (now.t < next_) return false;
    next_ = now.t + interval_;
    return true;
  }

 private:
  double interval_, next_ = 0;
};

/// The sum of the impulses on a surface in the last step [N s].
Vec3 impulse_on(const SurfaceMotion* surface);
/// The mean position of the particles [m], and the largest speed of motions() [m/s].
Vec3 mean_position(const World& world);
double largest_speed(const World& world);

}  // namespace oilskin::demo
