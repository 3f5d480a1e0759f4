/// One step of several worlds whose fluids touch the same surfaces (docs/architecture.md).
#pragma once

#include <map>
#include <memory>

#include "contact/context.h"
#include "world/joint_particles.h"
#include "world/world_impl.h"

namespace oilskin {

/// Each world has surfaces of its own, with what its effects keep there. Of the surfaces of one host, the
/// first one reads and writes the host: the original. The others copy its motion before contact, and its end
/// after it. In between all particles of all worlds have one contact pass on the originals.
class World::JointStep {
 public:
  /// Before anything changes: refuses worlds that cannot be stepped together.
  static Status check(Span<World* const> worlds);

  /// The worlds have passed check().
  JointStep(Span<World* const> worlds, double dt);
  ~JointStep();
  JointStep(const JointStep&) = delete;
  JointStep& operator=(const JointStep&) = delete;

  /// If it throws, the worlds are as they were.
  void run();
  /// After run(): the sum of the reports of the worlds.
  const StepReport& report() const { return sum_; }

 private:
  struct Member;

  void link(Member& member);
  void join_surfaces();
  void choose_substeps();
  void run_interval(int k);
  void solve();
  void give_pushes(const Member& member, std::vector<std::vector<Vec3>>& loads);
  std::vector<contact::HostSupport> find_hosts() const;
  std::vector<contact::Liquid> liquids() const;
  world::JointParticles join_particles();
  void part_particles(const world::JointParticles& all, const std::vector<Contact>& contacts);
  std::vector<std::vector<Vec3>> loads_of_others(const Member& member) const;
  void scatter();
  void finish();
  static void commit(Member& m);

  double dt_;  // [s]
  std::vector<std::unique_ptr<Member>> members_;
  std::map<const SurfaceHost*, world::Attachment*> original_of_host_;
  std::vector<world::Attachment*> originals_;                // in the order of the worlds
  world::ActiveSurfaces surfaces_;                           // the originals that take part
  std::map<const world::Attachment*, std::uint32_t> index_;  // of an original in surfaces_
  world::SurfacePaths paths_;
  contact::LiquidLoads loads_;  // of each world in this step, on still surfaces of contact alone
  int substeps_ = 1;
  StepReport sum_;
};

}  // namespace oilskin
