/// Sub-steps: their number, and the positions of surfaces between them.
#pragma once

#include <optional>

#include "core/body_path.h"
#include "core/parallel.h"
#include "oilskin/surface_motion.h"

namespace oilskin::world {

/// What decides how long a step may be; speeds [m/s].
struct Speeds {
  double fluid = 0;     ///< of the fastest particle, live or due to start
  double gravity = 0;   ///< |g| [m/s²]
  double surfaces = 0;  ///< of the fastest node that may touch the fluid
  double change = 0;    ///< largest change per second by the fluid's own forces, in the last interval [m/s²]
  double height = 0;    ///< of the tallest water along gravity [m]; volumes that are due count
  bool has_water = false;  ///< particles, or a volume that is due
  bool has_cloth = false;  ///< a surface near the water has nodes that yield on their own
};

/// The number of equal parts of a step of dt [s] such that no displacement in a part exceeds `distance` [m]
/// (Courant–Friedrichs–Lewy), even if the last interval's change of speed goes on in one part; at most
/// `maximum` (F.43), (F.67).
int substep_count(const Speeds& speeds, double dt, double distance, int maximum);

/// The number of equal parts of a step of dt [s] such that none is longer than `longest` [s], as a real
/// number: it may exceed every integer.
double parts_needed(double dt, double longest);

/// The longest dt [s] without a displacement above `distance` [m]; infinity where nothing moves.
double longest_step(const Speeds& speeds, double distance);

/// Whether a node may move by the fluid's load, other than with a body: of a surface whose box comes into the
/// box `water`.
bool has_free_nodes(Span<SurfaceMotion* const> surfaces, const Box& water);

/// The longest part along the unit vector `up` of points and of a box, in which gaps are no longer than `gap`
/// [m], to a quarter of that or more. Points beyond `bounds` do not count.
double tallest_part(Span<const Vec3> points, const Box& box, const Box& bounds, const Vec3& up, double gap,
                    const Workers& workers);

/// The largest speed of a node whose triangle sweeps through the box `water` in a step of dt [s].
double fastest_node(Span<SurfaceMotion* const> surfaces, const Box& water, double dt, const Workers& workers);

/// Moves the surfaces through the parts of a step. In each part a node moves on the straight line from its
/// certified position to the host's proposal for the end of the step; the last part ends exactly there. So a
/// node that contact moved or held in one part catches up in the next ones. The nodes of a rigid body, and of
/// a prescribed surface that turns as a whole, turn with it from part to part.
class SurfacePaths {
 public:
  /// A step of `parts` parts of `length` [s] each. With one part all calls do nothing.
  void begin(Span<SurfaceMotion* const> surfaces, int parts, double length);
  /// Sets the motion of each surface to that of the next part.
  void next();
  /// The motion of the k-th surface in the part before: nodes and id alone. Null in the first part, and where
  /// it is as fast as now.
  const SurfaceMotion* part_before(std::size_t k) const;
  /// In the first part: `before`, as the step before, of length dt, left it; of a surface that turns now,
  /// with the speeds of the last part of that step.
  const SurfaceMotion* step_before(std::size_t k, const SurfaceMotion& before, double dt);
  /// Sets it to that of the whole step: start and end, the sum of the impulses, and `moved` where the end
  /// differs from the host's proposal.
  void end();

 private:
  /// Of a still surface only the impulses.
  struct Path {
    SurfaceMotion* motion = nullptr;
    std::vector<Vec3> start, target;                       ///< of the step, stored [m]
    std::vector<Vec3> velocity;                            ///< the host's [m/s]
    std::vector<std::pair<std::uint32_t, Vec3>> impulses;  ///< of the completed parts, by node [N s]
    Vec3 moment = Vec3::Zero();                            ///< of the completed parts [N m s]
    Vec3 center = Vec3::Zero(),
         center_target = Vec3::Zero();  ///< of the body: at the start, and proposed [m]
    std::optional<BodyPath> turn;       ///< of a prescribed surface that turns as a whole
    SurfaceMotion before;               ///< its last part: nodes and id
  };
  void sum_impulses(Path& path) const;
  void end(Path& path) const;
  void move_body(const Path& path) const;
  void turn(Path& path) const;
  void continue_from_certified(Path& path) const;
  static void stop_turning(Path& path);

  std::vector<Path> paths_;
  int parts_ = 0, left_ = 0;  ///< left_: parts that have not begun
  double length_ = 0;
};

}  // namespace oilskin::world
