/// The seam between contact and whoever simulates a surface: one step of a triangle mesh, and two verbs.
#pragma once

#include "oilskin/settings.h"
#include "oilskin/types.h"

namespace oilskin {

/// What a host keeps its positions in. Every predicate of contact reads *stored* numbers only.
enum class Storage { float32, float64 };

/// One attached surface over one interval. A triangle mesh is all that contact needs: cloth, a rigid body's
/// hull and a static level differ only in inverse masses and in what the host does with impulses.
struct SurfaceMotion {
  // --- fixed from attach on (a change is a new surface with a new id)
  std::uint64_t id = 0;             ///< given by the world; 0 = not attached
  std::vector<Triangle> triangles;  ///< degenerate and duplicate triangles are allowed
  Storage storage = Storage::float64;
  double thickness = 0.001;  ///< h [m]
  double delta = 0;   ///< δ [m], the distance that the certificate speaks of; see minimum_separation()
  SlipSettings slip;  ///< of the front, the side that the triangles' normals point to (right-hand rule) …
  std::optional<SlipSettings> slip_back;  ///< … and of the back; absent = as the front
  /// Position rows (split repulsion) may move free nodes. False for hosts that derive velocities from
  /// positions, such as Bullet's position-based solver: there a moved node returns as kinetic energy.
  bool nodes_movable = true;

  // --- input of a step, V values each; filled by gather()
  std::vector<Vec3> x_t0;            ///< stored positions at the start: what contact left behind [m]
  std::vector<Vec3> x_t1;            ///< stored positions that the host proposes for the end [m]
  std::vector<Vec3> velocity;        ///< the host's velocities [m/s]
  std::vector<double> inverse_mass;  ///< [1/kg]; 0 = prescribed, the host decides where the node goes
  std::vector<std::uint8_t>
      holdable;  ///< 1 = a prescribed node that contact may hold for an interval (a pin)

  // --- output of contact: x_t1 and velocity as corrected, and
  std::vector<Vec3> impulse;  ///< sum of impulses given to each node [N s]; for prescribed nodes the reaction
  std::vector<std::uint8_t> moved;  ///< 1 = contact changed x_t1 of the node

  const SlipSettings& slip_on(bool back) const { return back && slip_back ? *slip_back : slip; }
};

/// δ = max(1e-3 h, 64 ε R) (C.1): ε = 2⁻²³ or 2⁻⁵² by storage, R the largest |coordinate| [m]. A thickness
/// below 4 δ is refused. h, R > 0.
double minimum_separation(double thickness, double max_coordinate, Storage storage);

/// The number that the host will keep when it is given `x`.
inline Vec3 stored(const Vec3& x, Storage storage) {
  if (storage == Storage::float64) return x;
  // Volatile: GCC 12 at -O3 drops pairs of vectorised double → float → double conversions where it inlines
  // them, and then a certificate would speak of numbers that the host does not keep.
  const auto round = [](double v) {
    volatile float f = static_cast<float>(v);
    return static_cast<double>(f);
  };
  return Vec3(round(x.x()), round(x.y()), round(x.z()));
}

struct Gathered {
  Status status;  ///< refused: the surface is left out of this step and of the ones after, and reported
  bool new_surface =
      false;  ///< topology or node order changed, or a teleport: new id, particles near it re-seeded
};

/// Implemented by adapters: a Bullet soft body, a collision object, a mock cloth.
class SurfaceHost {
 public:
  virtual ~SurfaceHost() = default;

  /// Fills the input of a step: x_t1, velocity, inverse_mass, holdable; where new_surface is returned also
  /// triangles, storage and nodes_movable. dt [s] is the length of the step, 0 at attach. x_t0 is the
  /// caller's.
  virtual Gathered gather(double dt, SurfaceMotion& motion) = 0;

  /// Takes the result: velocities change by inverse_mass × impulse (added, never assigned), positions only
  /// where `moved`; then sets x_t1 to what the host stores now.
  virtual void scatter(SurfaceMotion& motion) = 0;
};

}  // namespace oilskin
