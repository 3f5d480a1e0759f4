/// The surfaces of the methods that do not use World: what hosts propose, cut into intervals, and the
/// impulses that they get back.
#pragma once

#include <memory>

#include "oilskin/surface_motion.h"

namespace oilskin::study {

class SurfaceSet {
 public:
  /// Reads the host once. `index` = null: not wanted.
  Status attach(SurfaceHost& host, double thickness, std::size_t* index);

  /// Reads all hosts for a step of dt [s]. Impulses start at zero.
  Status gather(double dt);
  /// The next of `remaining` intervals of the step, all of one length: x_t0 … x_t1 on straight lines to what
  /// the hosts propose.
  void begin_interval(int remaining);
  /// Takes x_t1 as it is now. What displaced a node against the host's path displaces the rest of its path.
  void end_interval();
  /// Gives impulses and displaced nodes to the hosts.
  void scatter();

  /// An impulse [N s] on a point of a surface; `weights` barycentric.
  void push(std::size_t surface, const Triangle& nodes, const std::array<double, 3>& weights,
            const Vec3& impulse);

  std::size_t size() const { return motions_.size(); }
  SurfaceMotion& operator[](std::size_t surface) { return *motions_[surface]; }
  const SurfaceMotion& operator[](std::size_t surface) const { return *motions_[surface]; }
  Span<SurfaceMotion* const> motions() const { return pointers_; }

 private:
  Status read(std::size_t surface, double dt);

  std::vector<SurfaceHost*> hosts_;
  std::vector<std::unique_ptr<SurfaceMotion>> motions_;
  std::vector<SurfaceMotion*> pointers_;
  std::vector<std::vector<Vec3>> now_, target_, planned_;
};

/// A particle close to a triangle.
struct Near {
  std::size_t particle = 0, surface = 0;
  Triangle nodes{};
  std::array<double, 3> weights{};  ///< of the closest point
  Vec3 normal = Vec3::Zero();       ///< from there to the particle, unit
  double distance = 0;              ///< [m]
};

/// Which ends of the interval are looked at.
enum class At { start, end };

/// Particles closer to a surface than `reach` [m]. Of the triangles of a surface those count that lie in
/// different directions, by more than 25°: the nearest of a flat sheet, two or three in a corner. By
/// particle, nearest first.
std::vector<Near> find_near(Span<const Vec3> particles, const SurfaceSet& surfaces, double reach, At at);

/// The barycentric weights of the closest point of a triangle; of its nearest edge, where it has no area.
std::array<double, 3> closest_weights(const Vec3& p, const std::array<Vec3, 3>& corner);

}  // namespace oilskin::study
