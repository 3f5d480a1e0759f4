/// @file
/// The interface between contact and the simulation that owns a surface.
#pragma once

#include "oilskin/settings.h"
#include "oilskin/types.h"

namespace oilskin {

/// The numbers in which a host keeps positions. All predicates of contact read these *stored* numbers.
enum class Storage {
  /// IEEE single precision.
  float32,
  /// IEEE double precision.
  float64
};

/// The distance from 1 to the next number of a storage.
constexpr double epsilon_of(Storage storage) {
  return storage == Storage::float32 ? 0x1p-23 : 0x1p-52;
}

/// The dynamic rigid body whose hull a surface is. The host decides where the body goes in an interval;
/// impulses change how it goes on. Its nodes have the inverse mass 0.
struct BodyMotion {
  // --- input of an interval, filled by SurfaceHost::gather()
  /// Along the axes of the world [1/kg], ≥ 0; 0 = the host decides the motion along the axis.
  Vec3 inverse_mass = Vec3::Zero();
  /// Of the rotation about the centre of mass, in axes of the world [1/(kg m²)]: symmetric and positive
  /// semidefinite.
  Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Zero();
  /// The centre of mass that the host proposes for the end [m].
  Vec3 center_t1 = Vec3::Zero();
  /// Of the centre of mass [m/s].
  Vec3 velocity = Vec3::Zero();
  /// [rad/s]
  Vec3 angular_velocity = Vec3::Zero();
  /// With which the host will accelerate the body in its next step, but for contacts and joints [m/s²].
  Vec3 gravity = Vec3::Zero();
  /// The centre of mass at the start [m]. The caller fills it, as x_t0.
  Vec3 center_t0 = Vec3::Zero();
  /// The length of the host's next step [s], of which an interval may be a part; 0 = that of the interval.
  /// The caller fills it.
  double host_step = 0;

  // --- output, with the velocities as changed; the caller sets both to zero before the first interval
  /// The sum of all impulses [N s].
  Vec3 impulse = Vec3::Zero();
  /// The sum of their moments about the centre of mass [N m s].
  Vec3 angular_impulse = Vec3::Zero();
};

/// One attached surface over one interval. Cloth, the hull of a rigid body and a static level differ only in
/// inverse masses and in what the host does with impulses.
struct SurfaceMotion {
  // --- constant while attached (a change makes a new surface with a new id)
  /// Is given by the world; 0 = not attached.
  std::uint64_t id = 0;
  /// Degenerate and duplicate triangles are allowed.
  std::vector<Triangle> triangles;
  /// The host's numbers.
  Storage storage = Storage::float64;
  /// The thickness h [m].
  double thickness = 0.001;
  /// The minimum separation δ [m] of the certificate; see minimum_separation().
  double delta = 0;
  /// The slip law of the front: the side that the triangles' normals point to (right-hand rule).
  SlipSettings slip;
  /// The slip law of the back; absent = as the front.
  std::optional<SlipSettings> slip_back;
  /// As SurfaceSettings::smooth.
  bool smooth = false;
  /// Whether split repulsion may move free nodes. False for hosts that derive velocities from positions, such
  /// as Bullet's position-based solver: there the displacement of a node would add kinetic energy.
  bool nodes_movable = true;
  /// The triangles enclose a solid, as those of a convex shape do; see SurfaceSettings::solid.
  bool solid = false;

  // --- input of an interval, one value per node; filled by SurfaceHost::gather()
  /// Stored positions at the start [m]: where contact left the nodes.
  std::vector<Vec3> x_t0;
  /// Stored positions that the host proposes for the end [m].
  std::vector<Vec3> x_t1;
  /// The host's velocities [m/s].
  std::vector<Vec3> velocity;
  /// With smooth: velocities in which contact left the nodes [m/s]; empty = as `velocity`. The caller
  /// fills them, as x_t0.
  std::vector<Vec3> velocity_t0;
  /// [1/kg], ≥ 0; 0 = prescribed: the host decides where the node goes.
  std::vector<double> inverse_mass;
  /// 1 = a prescribed node that contact may hold for an interval (a pin).
  std::vector<std::uint8_t> holdable;
  /// The part of `carried_mass` that the host adds to the node for this interval [kg], less than
  /// 1/inverse_mass; empty = none. `inverse_mass` is then 1/(own + added mass).
  std::vector<double> added_mass;
  /// The rigid body that the nodes belong to; absent = none. Then all inverse masses are 0. Where nodes are
  /// holdable, contact may hold the body, or carry it with a heavier one: x_t1 is then x_t0 moved rigidly.
  std::optional<BodyMotion> body;

  // --- output of contact, with x_t1 and velocity as corrected
  /// The sum of the impulses given to each node [N s]; at prescribed nodes the reaction. What impact zones
  /// give to a body acts at its centre of mass and is in BodyMotion::impulse alone.
  std::vector<Vec3> impulse;
  /// The sum of the moments of `impulse` about the origin [N m s], with the nodes where they were at the
  /// starts of the sub-steps in which they got them.
  Vec3 angular_impulse = Vec3::Zero();
  /// 1 = contact changed x_t1 of the node.
  std::vector<std::uint8_t> moved;
  /// Ascending: the nodes with an impulse or with `moved`, at least. All others have neither.
  std::vector<std::uint32_t> touched;

  // --- what stands still costs nothing: see SurfaceHost::gather()
  /// The host's own number of what it filled in last; 0 = none. The world sets it to 0 where the arrays no
  /// longer hold that, or where they do not stand still.
  std::uint64_t revision = 0;
  /// Is given by the world. 0 = nodes may move. Else all nodes are prescribed, x_t1 is x_t0 bit for bit, the
  /// velocities are 0 and no mass is added; as long as the number stays the same, so do these arrays and the
  /// triangles.
  std::uint64_t still = 0;

  // --- output of the world for the host's next gather()
  /// The mass of water that a free node carries under its load [kg], ≥ 0 (C.29); empty = none. A host whose
  /// constraints stop a loaded node within a step, whatever its load, may set `added_mass`: then the
  /// load moves the node no farther than such constraints can bring it back. To ignore it changes nothing.
  std::vector<double> carried_mass;
  /// The mass of liquid that each node has absorbed [kg], ≥ 0; empty = none. A host gives its nodes the
  /// inverse mass 1/(own mass + absorbed) from the next step on; a host that ignores it has cloth that stays
  /// as light as it is dry.
  std::vector<double> absorbed_mass;

  /// The slip law of one side.
  const SlipSettings& slip_on(bool back) const { return back && slip_back ? *slip_back : slip; }
  /// Whether one side has friction without a viscosity: Coulomb's, or sticking.
  bool has_dry_friction() const {
    const auto is_dry = [](SlipModel m) { return m == SlipModel::coulomb || m == SlipModel::sticking; };
    return is_dry(slip_on(false).model) || is_dry(slip_on(true).model);
  }
  /// Adds j [N s] to the node's impulse. `touched` is not in order until the end of the interval.
  void add_impulse(std::uint32_t node, const Vec3& j) {
    Vec3& sum = impulse[node];
    if (sum[0] == 0 && sum[1] == 0 && sum[2] == 0) touched.push_back(node);
    sum += j;
  }
};

/// δ = max(10⁻³ h, 64 ε R) (C.1), with the thickness h [m] > 0, ε = 2⁻²³ or 2⁻⁵² by storage, and R =
/// `max_coordinate` [m] > 0, the largest absolute coordinate. A thickness below 4 δ is refused.
double minimum_separation(double thickness, double max_coordinate, Storage storage);

/// The number that the host keeps when it is given `x`.
inline Vec3 stored(const Vec3& x, Storage storage) {
  if (storage == Storage::float64) return x;
  // Volatile: GCC 12 at -O3 drops pairs of vectorised double → float → double conversions where it inlines
  // them. The certificate would then hold for numbers that the host does not keep.
  const auto round = [](double v) {
    volatile float f = static_cast<float>(v);
    return static_cast<double>(f);
  };
  return Vec3(round(x.x()), round(x.y()), round(x.z()));
}

/// The handle of an attached surface.
struct SurfaceId {
  /// 0 = none.
  std::uint64_t value = 0;
  /// Whether it is the handle of a surface.
  explicit operator bool() const { return value != 0; }
  /// Whether two handles are the same.
  bool operator==(SurfaceId o) const { return value == o.value; }
};

/// What SurfaceHost::gather() returns.
struct Gathered {
  /// Refused: the surface is left out of this step and of all later ones, and reported.
  Status status;
  /// The topology or the order of nodes changed, or the motion is a teleport: the surface gets a new id, and
  /// particles close to it are relocated.
  bool new_surface = false;
  /// The host left `motion` alone, as it would have filled in the same again. Only where motion.revision was
  /// the host's own, not 0.
  bool unchanged = false;
};

/// Is implemented by adapters: of a Bullet soft body, a collision object, another simulation.
class SurfaceHost {
 public:
  virtual ~SurfaceHost() = default;

  /// Fills the input of an interval: x_t1, velocity, inverse_mass, holdable; if it returns new_surface also
  /// triangles, storage, nodes_movable and solid. dt [s] is the length of the step, 0 when the surface is
  /// attached. The caller fills x_t0.
  ///
  /// A host of many triangles that mostly stand still gives what it fills in a number, motion.revision, ≥ 1:
  /// another one whenever nodes, masses or triangles change. Where it finds its present number in
  /// motion.revision, it may leave `motion` as it is and return `unchanged`. Such a surface costs a step
  /// nothing but for the triangles near the fluid. A host that sets no number is asked for everything in
  /// each step.
  virtual Gathered gather(double dt, SurfaceMotion& motion) = 0;

  /// Takes the result: adds inverse_mass × impulse to velocities, changes positions only where `moved`, and
  /// then sets x_t1 to what the host stores now. Only nodes in `touched` have impulses or moved. With
  /// motion.still the host changes x_t1 of no other node.
  virtual void scatter(SurfaceMotion& motion) = 0;
};

}  // namespace oilskin
