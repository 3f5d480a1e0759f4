/// Methods that couple water to triangle meshes, behind one interface: the library and those that were
/// published. All take the same settings, hosts and particles, so that one experiment serves all of them.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "oilskin/world.h"

namespace oilskin::study {

/// What each of them is, its source and its limits: docs/validation/comparators.md.
enum class Method {
  /// The library with its default settings.
  oilskin,
  /// [Huber2013]: PCISPH, repulsion, continuous test.
  paper,
  /// The same without the continuous test.
  repulsion,
  /// Springs and dampers between particles and triangles [Moore1988].
  penalty,
  /// DFSPH with particles on the triangles [Akinci2012].
  boundary_particles,
  /// Position based fluids, particles projected out of triangles [Macklin2013].
  position_based,
};

/// All of them.
constexpr std::array<Method, 6> all_methods = {
    Method::oilskin,       Method::paper, Method::repulsion, Method::penalty, Method::boundary_particles,
    Method::position_based};

/// As in tables: the name of the enumerator.
const char* name_of(Method method);

/// How far from a wall the centre of the first layer of water at rest is, over dx, to about 0.1. A tank for
/// one volume of water has its walls so far from it.
double wall_distance(Method method);

/// What all methods have in common.
struct MethodSettings {
  /// The rest distance dx of particles [m], > 0.
  double spacing = 0.005;
  /// ρ0 [kg/m³], > 0.
  double rest_density = 1000;
  /// ν [m²/s], ≥ 0.
  double viscosity = 1e-6;
  /// XSPH rate [1/s], ≥ 0; absent: default_xsph_rate(). Every method smooths at this rate.
  std::optional<double> xsph_rate;
  /// The mean density error, relative, at which the iterations of SPH end, > 0.
  double tolerance = 1e-3;
  /// The thickness of every surface [m], > 0.
  double thickness = 0.001;
  /// [m/s²]
  Vec3 gravity = Vec3(0, -9.81, 0);
  /// Particles that leave it are removed.
  Box kill_box = {Vec3::Constant(-10), Vec3::Constant(10)};
  /// A step in which a particle moves more than a spacing is cut into up to so many, 1 … 1000. Absent: 8 for
  /// the library, as by default, and 1 for all others, as published.
  std::optional<int> max_substeps;
  /// Of the methods that are made of the library; the others have one thread.
  int threads = 1;
};

/// Water that one method couples to surfaces.
class CouplingMethod {
 public:
  virtual ~CouplingMethod() = default;

  /// The host must outlive the method. `surface`: its index; null = not wanted.
  virtual Status attach(SurfaceHost& host, std::size_t* surface = nullptr) = 0;
  /// Particles, which nothing removes or moves where they are too close to a surface or to each other.
  virtual Status add_particles(Span<const Vec3> positions, Span<const Vec3> velocities) = 0;
  /// One coupled step of dt [s] > 0: reads all hosts, moves water and surfaces, writes all hosts.
  virtual Status step(double dt) = 0;

  /// Unique numbers of the particles, in the order of all that follows, which may change in every step.
  virtual Span<const std::uint64_t> ids() const = 0;
  /// [m]
  virtual Span<const Vec3> positions() const = 0;
  /// [m/s]
  virtual Span<const Vec3> velocities() const = 0;
  /// [kg/m³], as the method computes them, at the start of the last step.
  virtual Span<const double> densities() const = 0;
  /// [Pa], of the last step.
  virtual Span<const double> pressures() const = 0;
  /// [kg]
  virtual double particle_mass() const = 0;
  /// As the last step left it, with the impulse on each node.
  virtual const SurfaceMotion& surface(std::size_t index) const = 0;

  /// Is called with every straight motion of particles and surfaces; not owned, null = none.
  virtual void set_observer(IntervalObserver* observer) = 0;

  /// Σ m v of the particles [kg m/s].
  Vec3 momentum() const;
};

/// Throws std::invalid_argument for settings that are out of range.
std::unique_ptr<CouplingMethod> make_method(Method method, const MethodSettings& settings);

}  // namespace oilskin::study
