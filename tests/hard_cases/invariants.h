/// What must hold in every hard case, whatever its input: the one place where it is checked.
///
///   finite        no state holds a NaN or an infinity
///   no crossing   the outside auditor's exact arithmetic finds no path that touches a triangle
///   separation    … and no live particle nearer than δ (1 − 1e-12) at the end of an interval
///   momentum      of particles, free nodes, removals and reactions: 1e-10 of Σ|p| per interval
///   energy        contact adds none beyond the work of prescribed nodes: 1e-12 (inelastic repulsion only)
///   bounded work  the loops end within the rounds that they are granted
///   determinism   one and two threads give the same bits
#pragma once

#include <functional>
#include <memory>

#include "audit/trace_auditor.h"
#include "oilskin/world.h"
#include "support/particle_arrays.h"

namespace oilskin::test {

/// How a host stores its nodes and whether they are free.
struct HostKind {
  const char* name;
  Storage storage;
  bool free;
};
constexpr HostKind host_kinds[] = {{"float_pinned", Storage::float32, false},
                                   {"float_free", Storage::float32, true},
                                   {"double_pinned", Storage::float64, false},
                                   {"double_free", Storage::float64, true}};

constexpr double particle_mass = 1.25e-4;  ///< of 5 mm of water [kg]
constexpr double node_mass = 1e-4;         ///< of free nodes [kg]
inline double mass_of_nodes(const HostKind& host) {
  return host.free ? node_mass : 0;
}

/// A square sheet in the plane y = 0 around the origin, h = 1 mm.
inline SurfaceMotion square_sheet(const HostKind& host, double size = 0.04, std::uint32_t nodes = 5) {
  return make_grid(nodes, nodes, Vec3(-size / 2, 0, -size / 2), Vec3(size, 0, 0), Vec3(0, 0, size),
                   mass_of_nodes(host), 0.001, 2, host.storage);
}

/// Nodes and triangles as a surface at rest. `node_mass` 0 = prescribed; R the largest coordinate for δ.
SurfaceMotion mesh_surface(const std::vector<Vec3>& nodes, const std::vector<Triangle>& triangles,
                           Storage storage, double node_mass, double thickness = 0.001, double r = 10,
                           std::uint64_t id = 1);

/// Sums and extremes over the intervals of a case.
struct Found {
  ContactReport total;
  audit::Summary audit;
  std::uint64_t intervals = 0;
  double momentum_error = 0;  ///< largest, relative to Σ|p| of an interval
  double energy_gain = 0;     ///< largest, relative; 0 = none
  double speed = 0;           ///< largest of particles and free nodes after contact [m/s]
  double impulse = 0;         ///< largest on a node in an interval [N s]

  void add(const Found& o);
};

inline std::string count(std::uint64_t n) {
  return std::to_string(n);
}

/// What every case is held to, per interval: relative to Σ|p|, and to the energy and work.
constexpr double max_momentum_error = 1e-10, max_energy_gain = 1e-12;

double max_speed(const std::vector<Vec3>& velocities);

/// Contact alone. Fill particles and surfaces; x_t1 and velocity of both are the proposal.
struct ContactScene {
  std::vector<SurfaceMotion> surfaces;
  ParticleArrays particles;
  ContactSettings settings;
  double dt = 1e-3;  ///< [s]
  double spacing = 0.005;

  std::vector<SurfaceMotion*> surface_list();
  Vec3 momentum() const;  ///< of particles that are not removed, and of free nodes
  /// x_t1 = stored(x_t0 + dt v), of particles and nodes.
  void move();
};

/// Resolves intervals of a scene one after another and checks all of the above in each.
class CheckedContact {
 public:
  explicit CheckedContact(ContactScene s);

  /// One interval for the proposal that stands in `scene`. Particles that policy `allow` lets pass are
  /// expected in the audit.
  void resolve();
  /// What was certified is where the next interval starts; removed particles are dropped.
  void advance();
  /// move(), resolve(), advance(), `steps` times.
  void run(int steps);

  ContactScene scene;
  Found found;
  ContactReport report;  ///< of the last interval
  std::vector<Contact> contacts;

 private:
  void check_finite() const;
  void check_same_bits(const ContactScene& other) const;
  void audit_interval();
  void check_energy(double before, double work);

  ContactSolver one_, two_;
  std::unique_ptr<audit::Auditor> auditor_;
  std::uint64_t number_ = 0, jumps_ = 0;
};

/// Relative velocity along the normal of a contact: < 0 approaches [m/s].
double normal_speed(const ContactScene& scene, const Contact& contact);
/// Moves the nodes by y upwards.
void lift(SurfaceMotion& s, double y);

/// One scene, one interval, checked.
Found resolve_checked(ContactScene& scene);

/// A world and the hosts that live with it.
class WorldScene {
 public:
  virtual ~WorldScene() = default;
  virtual World& world() = 0;
  virtual void before_step(int) {}
  virtual void after_step(int) {}
};

/// Runs a scene with one thread, checked in every interval, and again with two for the same bits.
/// `make(threads)` builds it. Also checks the ledger of mass. Returns what was found on one thread.
Found run_checked(const std::function<std::unique_ptr<WorldScene>(int)>& make, int steps, double dt);

}  // namespace oilskin::test
