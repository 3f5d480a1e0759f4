/// A step cut into sub-steps: how many there are, and where the surfaces are in between.
#pragma once

#include "oilskin/surface_motion.h"

namespace oilskin::world {

/// Speeds that decide how long a step may be [m/s].
struct Speeds {
  double fluid = 0;     ///< of the fastest particle, live or due to start
  double gravity = 0;   ///< what gravity adds to it per second [m/s²]
  double surfaces = 0;  ///< of the fastest node that may meet the fluid
};

/// In how many equal parts a step of dt [s] falls so that nothing goes farther than `way` [m] in one of them
/// (Courant–Friedrichs–Lewy); at most `most`.
int substep_count(const Speeds& speeds, double dt, double distance, int maximum);

/// The longest dt [s] in which nothing goes farther than `way` [m]; infinity where nothing moves.
double longest_step(const Speeds& speeds, double distance);

/// Speed of the fastest node of all triangles that sweep through the box `water` in a step of dt [s].
double fastest_node(Span<SurfaceMotion* const> surfaces, const Box& water, double dt);

/// Leads the surfaces through the parts of a step. In each part a node goes along the straight line from
/// where contact has left it to where the host wants it at the end of the step; the last part ends exactly
/// there. So a node that contact moved aside or held in one part catches up in the following ones.
class SurfacePaths {
 public:
  /// The step in `parts` of `length` [s] each. With one part nothing is kept and nothing changed.
  void begin(Span<SurfaceMotion* const> surfaces, int parts, double length);
  /// Makes each surface's motion that of the next part.
  void next();
  /// Makes it that of the whole step again: start and end, the sum of the impulses, and `moved` where the end
  /// is not what the host proposed.
  void end();

 private:
  struct Path {
    SurfaceMotion* motion = nullptr;
    std::vector<Vec3> start, target;  ///< of the step, as stored [m]
    std::vector<Vec3> velocity;       ///< the host's [m/s]
    std::vector<Vec3> impulse;        ///< of the parts that are done [N s]
  };
  void continue_from_certified(Path& path) const;

  std::vector<Path> paths_;
  int parts_ = 0, left_ = 0;  ///< left_: parts that have not begun
  double length_ = 0;
};

}  // namespace oilskin::world
