/// The attached surfaces: gather, scatter, and what happens when a surface is new.
#pragma once

#include "core/archive.h"
#include "core/parallel.h"
#include "fluid/particles.h"
#include "oilskin/report.h"
#include "oilskin/surface_motion.h"
#include "proximity/surface_tree.h"

namespace oilskin::world {

struct Attachment {
  std::uint64_t handle = 0;
  SurfaceHost* host = nullptr;
  SurfaceSettings settings;
  SurfaceMotion motion;         ///< between steps x_t1 is what the host stores; the next gather makes it x_t0
  std::vector<Vec3> certified;  ///< x_t1 as certified, to compare with what the host read back
  bool is_new = true;           ///< new id: particles near it are re-seeded before the next step
  bool teleported = false;      ///< reset_motion was called
  bool refused = false;         ///< left out, until a gather after reset_motion is accepted
};

/// Do the collision groups and masks of a fluid and a surface let them meet?
bool can_collide(const FluidSettings& fluid, const SurfaceSettings& surface);

class Attachments {
 public:
  Status attach(SurfaceHost& host, const SurfaceSettings& settings, const WorldSettings& world,
                std::uint64_t* handle);
  /// Returns the ids that contact may forget.
  std::uint64_t detach(std::uint64_t handle);
  Attachment* find(std::uint64_t handle);
  const Attachment* find(std::uint64_t handle) const;
  const std::vector<std::unique_ptr<Attachment>>& all() const { return list_; }

  /// Reads every host. Fills `active` with the surfaces that take part, in order of handle; `stale` with
  /// trace ids that are no more.
  void gather(double dt, const WorldSettings& world, const FluidSettings& fluid, StepReport& report,
              std::vector<SurfaceMotion*>& active, std::vector<std::uint64_t>& stale);
  void scatter(Span<SurfaceMotion* const> active, StepReport& report);

  /// Particles nearer than 2 δ to a fresh surface get a new place and a new id, or are removed: their path
  /// would not be certain. Counted in report.contact.reseeded.
  void relocate_particles(Span<SurfaceMotion* const> active, fluid::Particles& particles,
                          double particle_mass, std::uint64_t& next_id, const Workers& workers,
                          StepReport& report);

  /// Everything but hosts and handles; when reading, into attachments without hosts.
  void visit(Archive& archive);
  /// Takes over hosts and handles of `from`, whose surfaces must be as many and have the same meshes in the
  /// same order. A refusal changes nothing.
  Status take_hosts(Attachments& from);

 private:
  std::vector<std::unique_ptr<Attachment>> list_;  // in order of handle
  std::uint64_t next_handle_ = 1;
  std::uint64_t next_id_ = 1;
};

/// Is some triangle of the surfaces nearer than 2 δ to a point, at the stored start positions?
class ClearanceTest {
 public:
  ClearanceTest(Span<SurfaceMotion* const> surfaces, const Workers& workers)
      : surfaces_(surfaces), workers_(workers) {}
  /// blocked[i] = 1 where point i is not clear.
  void run(Span<const Vec3> points, std::vector<std::uint8_t>& blocked) const;

 private:
  Span<SurfaceMotion* const> surfaces_;
  const Workers& workers_;
};

}  // namespace oilskin::world
