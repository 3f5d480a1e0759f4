/// The contact loop of one interval.
#pragma once

#include "contact/candidates.h"
#include "contact/contacts.h"
#include "contact/detection.h"
#include "contact/near_triangle_lists.h"

namespace oilskin::contact {

/// Arrays that a pass fills. They are kept between passes for their capacity alone.
struct ContactBuffers {
  CandidateSet candidates;
  ContactSet contacts;
  NearTriangleLists near;
};

/// One interval: find() → (a fluid decides where to go) → solve(). It refers to the arguments of its
/// constructor, which must outlive it; the arrays behind `particles` and the surfaces must not move. If an
/// exception leaves find() or solve(), those arrays hold no meaningful end state.
class ContactPass {
 public:
  /// Surfaces need id, δ, thickness, x_t0, x_t1, velocity and inverse_mass. `geometry` has one entry per
  /// surface, analysed for it.
  ContactPass(double dt, const ContactSettings& settings, const Workers& workers, ParticleMotion& particles,
              Span<SurfaceMotion* const> surfaces, Span<SurfaceGeometry* const> geometry,
              ContactBuffers& buffers, ContactReport& report, StageSeconds& seconds);
  ContactPass(const ContactPass&) = delete;
  ContactPass& operator=(const ContactPass&) = delete;

  /// The particles are of several liquids: `index` has that of each one. Without it all are of one liquid, as
  /// the particles say.
  void set_liquids(std::vector<Liquid> liquids, Span<const std::uint8_t> index) {
    context_.liquids = std::move(liquids);
    context_.liquid_index = index;
  }

  /// `loads` gets what solve() adds to it.
  void record_loads(LiquidLoads& loads) { context_.loads = &loads; }

  /// Collects candidates and contacts for the predicted x_t1. Sets impulse and moved of the surfaces to zero.
  void find();

  /// After find(): per surface, ascending, at least the triangles that have a point within `reach` [m] of one
  /// of the boxes at x_t0.
  Span<const std::vector<std::uint32_t>> find_triangles_near(Span<const Box> boxes, double reach) {
    return near_.find(context_.geometry, boxes, reach, *context_.workers);
  }

  /// Of the particles at the start, before this interval's forces; without them, their present velocities
  /// count as such.
  void set_start_velocity(Span<const Vec3> velocity) { context_.start_velocity = velocity; }
  /// What friction may expect of the hosts, one per surface, until the end of solve().
  void set_hosts(Span<const HostSupport> hosts) { context_.hosts = hosts; }
  /// Boundary terms have acted: what they gave to the particles, ordered by particle, and per particle what
  /// the last interval left for friction, which solve() replaces.
  void set_wall_impulses(Span<const fluid::WallImpulse> impulses, Span<Vec3> spare_load) {
    context_.boundary_terms = true;
    context_.wall_impulses = impulses;
    context_.spare_load = spare_load;
  }

  /// Contacts that act for the present x_t1, ordered by particle, surface and triangle.
  const std::vector<Contact>& select_contacts();

  /// Impulses, impacts, zones, certificate, for the present x_t1: the caller may have changed it since
  /// find(). Particles that are marked `removed` by then take no part.
  void solve();

  /// Those of the last select_contacts(), which solve() calls.
  std::vector<Contact> take_contacts() { return std::move(active_); }

 private:
  void reset_surfaces();
  void update_contacts();
  void solve_contacts();
  bool solve_impacts();
  void solve_impacts_of_round(const std::vector<Violation>& violations, int round);
  double kinetic_energy() const;
  double body_energy_change() const;
  void record_impulses();

  Context context_;
  CandidateSet& candidates_;
  ContactSet& contacts_;
  NearTriangleLists& near_;
  std::vector<Contact> active_;
  std::vector<std::optional<BodyMotion>> bodies_before_;  // per surface, as solve() found them
};

}  // namespace oilskin::contact
