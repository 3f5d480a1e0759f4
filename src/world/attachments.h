/// The attached surfaces: one store per surface, gather and scatter.
#pragma once

#include "contact/surface_geometry.h"
#include "core/archive.h"
#include "oilskin/report.h"
#include "oilskin/surface_motion.h"
#include "world/clearance.h"

namespace oilskin::world {

/// Liquid that passes from node to node [kg].
struct Passage {
  std::uint32_t from = 0, to = 0;
  double mass = 0;
};

/// What effects changed of the liquid in a surface within a step; empty = nothing.
struct LiquidChange {
  std::vector<double> before;  ///< in each node at the start [kg]
  std::vector<double> mass;    ///< that each node absorbed from the fluid [kg]
  std::vector<Vec3> momentum;  ///< of it [N s]
  std::vector<Passage> passages;
};

/// Of an attachment, before the step under way.
struct SavedState {
  SurfaceMotion motion;
  std::vector<Vec3> mean_load;
  std::vector<std::vector<double>> values;
  bool is_new = false, teleported = false, refused = false;
  std::uint64_t still = 0;  ///< whose arrays `motion` has; 0 = they must be copied
};

struct Attachment;

/// In a step of several worlds: what the attachments of one host have to do with each other. The first one,
/// the original, reads and writes the host; the others are copies.
struct Sharing {
  Attachment* original = nullptr;   ///< of a copy; null = none
  std::vector<Attachment*> copies;  ///< of an original
  double thickness = 0;             ///< the smallest of all [m]; 0 = its own
  double reach = 0;                 ///< the largest coordinate of their kill boxes [m]
  bool mesh_changed = false;        ///< the host gave the original another mesh in this step
  bool teleported = false;          ///< or its motion was a teleport
};

/// All that a world keeps of a surface, but for the load that the fluid's boundary terms remember by id.
struct Attachment {
  std::uint64_t handle = 0;
  SurfaceHost* host = nullptr;
  SurfaceSettings settings;

  // State, saved with the world.
  // Between steps motion.x_t1 is what the host stores; the next gather makes it x_t0.
  SurfaceMotion motion;
  bool is_new = true;           // new id: particles near it are relocated before the next interval
  bool teleported = false;      // the next gather makes it a new surface
  bool refused = false;         // left out, until a gather after reset_motion is accepted
  std::vector<Vec3> mean_load;  // of each node [N] (C.30); empty = none yet
  std::vector<std::vector<double>> values;  // of effects: per kind of value, one per node

  LiquidChange liquid_change;  // of the step under way
  Sharing sharing;             // of a step of several worlds
  SavedState saved;            // by checkpoint()

  // Derived from the motion
  contact::SurfaceGeometry geometry;
};

/// The surfaces that take part in a step, in order of attachment: arrays of one length.
struct ActiveSurfaces {
  std::vector<Attachment*> attachment;
  std::vector<SurfaceMotion*> motion;
  std::vector<contact::SurfaceGeometry*> geometry;
  std::vector<const MeshTopology*> topology;

  std::size_t size() const { return attachment.size(); }
  void add(Attachment& a);
  /// At x_t0.
  std::vector<StandingSurface> at_start() const;
  /// At x_t1.
  std::vector<StandingSurface> at_end() const;
};

/// The largest coordinate that δ covers [m].
double max_coordinate(const Box& kill_box);

/// Whether the second one has a number SurfaceMotion::still that holds for the first one, too.
bool stand_alike(const SurfaceMotion& m, const SurfaceMotion& still);

/// Do the collision groups and masks of a fluid and a surface let them collide?
bool can_collide(const FluidSettings& fluid, const SurfaceSettings& surface);

class Attachments {
 public:
  Status attach(SurfaceHost& host, const SurfaceSettings& settings, const WorldSettings& world,
                std::uint64_t* handle);
  void detach(std::uint64_t handle);
  Attachment* find(std::uint64_t handle);
  const Attachment* find(std::uint64_t handle) const;
  const std::vector<std::unique_ptr<Attachment>>& all() const { return list_; }

  /// Reads every host. A surface whose host gave what a step cannot take is left out, and reported.
  ActiveSurfaces gather(double dt, const WorldSettings& world, const FluidSettings& fluid,
                        StepReport& report);
  static void scatter(const ActiveSurfaces& active, StepReport& report);

  /// The surfaces that collide with the fluid, where they stand between steps: at x_t1.
  std::vector<StandingSurface> between_steps(const FluidSettings& fluid) const;

  /// For a step that may fail: checkpoint() copies the state of every surface, roll_back() puts it back.
  /// Nothing may be attached or detached in between. Of a still surface only what steps change is copied.
  void checkpoint();
  void roll_back() noexcept;
  /// The motion of an active surface as checkpoint() found it; if it was refused then, as it is now.
  static const SurfaceMotion& before(const Attachment& a);

  /// The surfaces are elsewhere by `offset` [m], without a motion, as their hosts are already. A refusal
  /// changes nothing.
  Status translate(const Vec3& offset, const Box& kill_box);

  /// Everything but hosts and handles; when reading, into attachments without hosts.
  void visit(Archive& archive);
  /// Takes over hosts and handles of `from`, whose surfaces must be as many and have the same meshes in the
  /// same order. A refusal changes nothing.
  Status take_hosts(Attachments& from);
  /// After take_hosts(): also what was derived from the meshes, and the numbers of surfaces that stand where
  /// they did.
  void take_geometry(Attachments& from);

 private:
  void note_stillness(SurfaceMotion& m);
  Status gather_surface(Attachment& a, double dt, const Box& kill_box, StepReport& report);
  Status take_motion(Attachment& a, bool new_surface, std::size_t nodes_before, const Box& kill_box,
                     StepReport& report);

  std::vector<std::unique_ptr<Attachment>> list_;  // in order of handle
  std::vector<Triangle> triangles_before_;         // memory of gather_surface()
  std::uint64_t next_handle_ = 1;
  std::uint64_t next_id_ = 1;
  std::uint64_t next_still_ = 1;  // is never put back: what depends on a number is found by it
  std::uint64_t saved_next_id_ = 1;
};

}  // namespace oilskin::world
