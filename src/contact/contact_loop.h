/// The contact loop of one interval, in two halves so that a fluid can see its contacts before it decides
/// where to go: begin() → (pressure) → run().
#pragma once

#include <map>

#include "contact/candidates.h"
#include "contact/contacts.h"

namespace oilskin::contact {

class ContactLoop {
 public:
  explicit ContactLoop(std::shared_ptr<Workers> workers) : workers_(std::move(workers)) {}

  /// Collects candidates and records for the predicted x_t1. The arrays behind `particles` and the surfaces
  /// must stay where they are until run() returns. Surfaces need x_t0, x_t1, velocity, inverse_mass; impulse
  /// and moved are reset here.
  void begin(double dt, const ContactSettings& settings, ParticleMotion& particles,
             Span<SurfaceMotion* const> surfaces, ContactReport& report, StageSeconds& seconds);

  /// Records that act for the present x_t1, ordered by particle, surface and triangle.
  const std::vector<Contact>& select_contacts();

  /// Impulses, meetings, zones, certificate, for the present x_t1 (the caller may have changed it since
  /// begin()). Particles that are marked `removed` by now take no part.
  void run();

  const std::vector<Contact>& contacts() const { return active_; }
  /// Of the surfaces of begin(), in their order.
  std::vector<const MeshTopology*> topologies() const;
  void forget(std::uint64_t surface_id) { caches_.erase(surface_id); }

 private:
  void prepare_surfaces();
  double kinetic_energy() const;
  void book_impulses();

  std::shared_ptr<Workers> workers_;
  std::map<std::uint64_t, SurfaceCache> caches_;  // by surface id
  Context context_;
  CandidateSet candidates_;
  ContactSet contacts_;
  std::vector<Contact> active_;
};

}  // namespace oilskin::contact
