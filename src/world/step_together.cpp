/// One step of several worlds whose fluids touch the same surfaces.
#include <algorithm>
#include <limits>
#include <optional>

#include "contact/contact_pass.h"
#include "core/assert.h"
#include "core/body_motion.h"
#include "world/absorption.h"
#include "world/carried_mass.h"
#include "world/joint_step.h"
#include "world/numeric_range.h"
#include "world/roll_back.h"
#include "world/sharing.h"

namespace oilskin {

using world::Attachment;
using world::Attachments;
using world::for_all_of;
using world::IntervalContext;
using world::original_of;
using world::StepContext;

namespace {

constexpr std::size_t most_worlds = 255;  // Context::liquid_index has a byte

/// Of a surface within an interval, before contact: by boundary terms and effects.
struct Push {
  std::uint32_t node = 0;
  Vec3 impulse = Vec3::Zero();
};

std::vector<Push> pushes_on(const SurfaceMotion& s) {
  std::vector<std::uint32_t> nodes = s.touched;
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::vector<Push> pushes;
  for (std::uint32_t node : nodes)
    if (!s.impulse[node].isZero(0)) pushes.push_back({node, s.impulse[node]});
  return pushes;
}

void add_loads(const std::vector<Push>& pushes, std::size_t nodes, std::vector<Vec3>& load) {
  if (pushes.empty()) return;
  if (load.empty()) load.assign(nodes, Vec3::Zero());
  for (const Push& push : pushes) load[push.node] += push.impulse;
}

}  // namespace

/// One of the worlds of a step.
struct World::JointStep::Member {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  Member(Impl& w, double dt)
      : impl(w), step(dt, w.fluid->particle_mass(), w.state.energy, w.settings.gravity) {
    w.start_report(step.report, dt);
  }

  Impl& impl;
  StepContext step;
  std::optional<world::RollBack<Impl>> roll_back_on_exception;
  std::vector<std::uint32_t> joint_index;   // of each of its active surfaces, in JointStep::surfaces_
  std::vector<std::uint32_t> active_index;  // of each of those, among its active ones, or `none`

  // Of the interval
  std::optional<IntervalContext> interval;
  ParticleMotion motion;
  std::vector<std::vector<Push>> pushes;  // on each active surface
  std::size_t first = 0;                  // of its particles in JointParticles
};

World::JointStep::JointStep(Span<World* const> worlds, double dt) : dt_(dt) {
  for (World* w : worlds) members_.push_back(std::make_unique<Member>(*w->impl_, dt));
}

World::JointStep::~JointStep() {
  for (const auto& m : members_)
    for (const auto& a : m->impl.attachments.all()) a->sharing = {};
}

/// Finds what has the host of an earlier surface.
void World::JointStep::link(Member& member) {
  for (const auto& a : member.impl.attachments.all()) {
    const auto [known, is_first] = original_of_host_.emplace(a->host, a.get());
    if (is_first) {
      originals_.push_back(a.get());
      continue;
    }
    a->sharing.original = known->second;
    known->second->sharing.copies.push_back(a.get());
  }
}

Status World::JointStep::check(Span<World* const> worlds) {
  const auto wrong = [](std::size_t k, const std::string& why) {
    return Status::refused("world " + std::to_string(k + 1) + " of the step " + why);
  };
  if (worlds.empty()) return Status::refused("there is no world to step");
  if (worlds.size() > most_worlds)
    return Status::refused("there are " + std::to_string(worlds.size()) + " worlds; at most " +
                           std::to_string(most_worlds) + " can be stepped together");
  for (std::size_t k = 0; k < worlds.size(); ++k) {
    if (worlds[k] == nullptr) return wrong(k, "is null");
    if (std::find(worlds.begin(), worlds.begin() + k, worlds[k]) != worlds.begin() + k)
      return wrong(k, "is there twice");
    if (!worlds[k]->status().ok())
      return wrong(k, "has settings that were refused: " + worlds[k]->status().message);
    const Impl &first = *worlds[0]->impl_, &w = *worlds[k]->impl_;
    if (w.fluid_settings.boundary != first.fluid_settings.boundary)
      return wrong(k, "has another fluid.boundary than the first");
  }
  return {};
}

void World::JointStep::run() {
  for (const auto& m : members_) link(*m);  // the destructor takes it back, whatever throws
  for (const auto& m : members_) {
    m->roll_back_on_exception.emplace(m->impl);
    m->step.contact = &members_[0]->impl.contact_settings;
  }
  double reach = 0;
  for (const auto& m : members_) reach = std::max(reach, world::max_coordinate(m->impl.settings.kill_box));
  for (Attachment* a : originals_) world::share_thickness(*a, reach);
  for (const auto& m : members_) m->impl.begin_step(m->step);
  join_surfaces();
  choose_substeps();
  for (int k = 0; k < substeps_; ++k) run_interval(k);
  paths_.end();
  scatter();
  finish();
  sum_ = members_[0]->step.report;
  for (std::size_t k = 1; k < members_.size(); ++k) sum_.add_world(members_[k]->step.report);
  for (const auto& m : members_) commit(*m);  // nothing throws from here on
}

void World::JointStep::commit(Member& m) {
  m.roll_back_on_exception->dismiss();
  m.impl.emission->commit(m.impl.state.time);
  m.impl.contacts.swap(m.step.contacts);
  m.impl.contact_surfaces.swap(m.step.contact_surfaces);
  std::swap(m.impl.report, m.step.report);
}

/// A surface takes part if it does in one of the worlds.
void World::JointStep::join_surfaces() {
  for (const auto& m : members_)
    for (const Attachment* a : m->step.surfaces.attachment) index_.emplace(original_of(*a), 0);
  for (Attachment* original : originals_) {
    const auto found = index_.find(original);
    if (found == index_.end()) continue;
    OILSKIN_ASSERT(!original->refused);
    found->second = static_cast<std::uint32_t>(surfaces_.size());
    surfaces_.add(*original);
  }
  for (const auto& m : members_) {
    m->active_index.assign(surfaces_.size(), Member::none);
    for (const Attachment* a : m->step.surfaces.attachment) {
      const std::uint32_t joint = index_.at(original_of(*a));
      m->active_index[joint] = static_cast<std::uint32_t>(m->joint_index.size());
      m->joint_index.push_back(joint);
    }
  }
  loads_.assign(members_.size(), std::vector<std::vector<Vec3>>(surfaces_.size()));
  members_[0]->step.count(surfaces_);
}

void World::JointStep::choose_substeps() {
  substeps_ = 1;
  for (const auto& m : members_) {
    m->impl.choose_substeps(m->step);
    substeps_ = std::max(substeps_, m->step.report.substeps);
  }
  std::vector<SurfaceMotion*> motions = surfaces_.motion;
  for (const auto& m : members_) {
    m->step.report.substeps = substeps_;
    for (Attachment* a : m->step.surfaces.attachment)
      if (a->sharing.original) motions.push_back(&a->motion);
    m->impl.emission->begin_step(m->impl.state.time, dt_);
  }
  paths_.begin(motions, substeps_, dt_ / substeps_);
}

void World::JointStep::run_interval(int k) {
  const double part = dt_ / substeps_;
  paths_.next();
  members_[0]->step.count_before(paths_, k == 0, members_[0]->impl.state.last_dt);
  for (const auto& m : members_) {
    Impl& w = m->impl;
    m->interval.emplace(m->step, w.state.time + k * part, part, k);
    w.begin_interval(*m->interval);
    m->motion = w.motion_of(*m->interval);
    contact::ContactPass pass(part, *m->step.contact, *w.workers, m->motion, m->step.surfaces.motion,
                              m->step.surfaces.geometry, w.contact_buffers, m->interval->report,
                              m->step.report.seconds);
    pass.find();
    w.propose(*m->interval, pass);
    m->interval->report = {};
    m->pushes.clear();
    for (const SurfaceMotion* s : m->step.surfaces.motion) m->pushes.push_back(pushes_on(*s));
  }
  solve();
  for (Attachment* a : surfaces_.attachment) world::copy_end(*a);
  for (const auto& m : members_) {
    for (const auto& other : members_) m->step.energy.share_limits(other->step.energy);
    m->impl.end_interval(*m->interval, m->motion);
  }
}

/// Contact of all particles at once: no surface moves after its certificate.
void World::JointStep::solve() {
  Member& first = *members_[0];
  Impl& w = first.impl;
  const bool has_walls = w.fluid_settings.boundary == BoundaryModel::mirrored;
  if (has_walls)
    for (const auto& m : members_) m->impl.state.particles.let_load_be_spared();
  world::JointParticles all = join_particles();
  ParticleMotion motion = first.motion;
  motion.id = all.id;
  motion.x_t0 = all.x_t0;
  motion.x_t1 = all.x_t1;
  motion.velocity = all.velocity;
  motion.inverse_mass = all.inverse_mass;
  motion.removed = all.removed;
  contact::ContactPass pass(first.interval->dt, w.contact_settings, *w.workers, motion, surfaces_.motion,
                            surfaces_.geometry, w.joint_buffers, first.interval->report,
                            first.step.report.seconds);
  pass.set_liquids(liquids(), all.liquid_index);
  pass.find();  // forgets the impulses on its surfaces
  for (std::size_t k = 0; k < members_.size(); ++k) give_pushes(*members_[k], loads_[k]);
  pass.record_loads(loads_);
  pass.set_start_velocity(all.start_velocity);
  if (has_walls) pass.set_wall_impulses(all.wall_impulses, all.spare_load);
  const std::vector<contact::HostSupport> hosts = find_hosts();
  pass.set_hosts(hosts);
  pass.solve();
  part_particles(all, pass.take_contacts());
}

/// What walls and effects gave to the surfaces of a member; an original moves with it already.
void World::JointStep::give_pushes(const Member& member, std::vector<std::vector<Vec3>>& loads) {
  for (std::size_t s = 0; s < member.pushes.size(); ++s) {
    const std::uint32_t joint = member.joint_index[s];
    const bool is_copy = member.step.surfaces.attachment[s] != surfaces_.attachment[joint];
    SurfaceMotion& motion = *surfaces_.motion[joint];
    for (const Push& push : member.pushes[s])
      if (is_copy)
        push_node(motion, push.node, push.impulse);
      else
        motion.add_impulse(push.node, push.impulse);
    if (is_copy) set_node_velocities(motion);
    if (motion.still == 0) add_loads(member.pushes[s], motion.x_t0.size(), loads[joint]);
  }
}

/// Each world remembers the loads of all of them.
std::vector<contact::HostSupport> World::JointStep::find_hosts() const {
  std::vector<contact::HostSupport> hosts(surfaces_.size());
  for (const auto& m : members_) {
    m->impl.find_hosts(*m->interval);
    for (std::size_t s = 0; s < m->joint_index.size(); ++s) {
      contact::HostSupport& host = hosts[m->joint_index[s]];
      if (host.carried.empty()) host = m->step.hosts[s];
    }
  }
  return hosts;
}

std::vector<contact::Liquid> World::JointStep::liquids() const {
  std::vector<contact::Liquid> liquids;
  for (const auto& m : members_) {
    contact::Liquid& liquid = liquids.emplace_back(m->motion);
    liquid.collides.assign(surfaces_.size(), 0);
    for (std::uint32_t s : m->joint_index) liquid.collides[s] = 1;
  }
  return liquids;
}

world::JointParticles World::JointStep::join_particles() {
  world::JointParticles all;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    Member& m = *members_[k];
    m.first = all.id.size();
    all.add(static_cast<std::uint8_t>(k), m.impl.state.particles, *m.interval);
    for (fluid::WallImpulse impulse : m.impl.fluid->wall_impulses()) {
      impulse.particle += static_cast<std::uint32_t>(m.first);
      impulse.surface = m.joint_index[impulse.surface];
      all.wall_impulses.push_back(impulse);
    }
  }
  return all;
}

/// `contacts` are in the order of particles.
void World::JointStep::part_particles(const world::JointParticles& all,
                                      const std::vector<Contact>& contacts) {
  auto next = contacts.begin();
  for (const auto& m : members_) {
    all.give_back(m->first, m->impl.state.particles, *m->interval);
    m->step.contacts.clear();
    for (; next != contacts.end() && next->particle < m->first + m->interval->x_t1.size(); ++next) {
      Contact c = *next;
      OILSKIN_ASSERT(m->active_index[c.surface] != Member::none);
      c.particle -= static_cast<std::uint32_t>(m->first);
      c.surface = m->active_index[c.surface];
      m->step.contacts.push_back(c);
    }
  }
}

/// On the active surfaces of a member.
std::vector<std::vector<Vec3>> World::JointStep::loads_of_others(const Member& member) const {
  std::vector<std::vector<Vec3>> loads;
  for (std::uint32_t s : member.joint_index) {
    std::vector<Vec3>& sum = loads.emplace_back();
    for (std::size_t k = 0; k < members_.size(); ++k) {
      const std::vector<Vec3>& load = loads_[k][s];
      if (members_[k].get() == &member || load.empty()) continue;
      sum.resize(load.size(), Vec3::Zero());
      for (std::size_t i = 0; i < load.size(); ++i) sum[i] += load[i];
    }
  }
  return loads;
}

void World::JointStep::scatter() {
  StageTimer timer(members_[0]->step.report.seconds.gather);
  StepReport& report = members_[0]->step.report;
  StepReport of_copies;  // counts once what happens to a surface
  for (const auto& m : members_) {
    Impl& w = m->impl;
    w.state.particles.new_end = w.state.time + dt_ + w.state.max_age;
    w.release(m->step);
    w.fluid->record_load(dt_, m->step.surfaces.motion, loads_of_others(*m));
  }
  for (const auto& m : members_)
    for (const auto& a : m->impl.attachments.all()) {
      if (a->refused || index_.count(original_of(*a)) == 0) continue;
      world::update_carried_mass(dt_, m->impl.fluid_settings, *a, *m->impl.workers,
                                 a->sharing.original ? of_copies : report);
    }
  std::vector<std::vector<Vec3>> impulses;  // of contact and pressure alone
  for (Attachment* original : surfaces_.attachment) {
    impulses.emplace_back();
    for_all_of(*original, [&](Attachment& a) {
      std::vector<Vec3> before = world::add_momentum_of_liquid(a, original->motion);
      if (impulses.back().empty()) impulses.back().swap(before);
    });
  }
  Attachments::scatter(surfaces_, report);
  for (std::size_t s = 0; s < impulses.size(); ++s) {
    Attachment& original = *surfaces_.attachment[s];
    if (!impulses[s].empty()) original.motion.impulse.swap(impulses[s]);
    world::copy_end(original);
    for (Attachment* copy : original.sharing.copies) copy->teleported |= original.teleported;
    members_[0]->step.energy.end_surface(original.motion, dt_, Attachments::before(original),
                                         members_[0]->impl.state.last_dt, *members_[0]->impl.workers);
  }
}

/// The first world has the balance of energies of all.
void World::JointStep::finish() {
  Member& first = *members_[0];
  for (std::size_t k = 1; k < members_.size(); ++k) {
    Member& m = *members_[k];
    first.step.energy.include(m.step.energy);
    first.step.mass_of_others +=
        m.impl.fluid->particle_mass() * m.impl.state.particles.sum_of_relative_masses();
  }
  for (const auto& m : members_) m->impl.finish(m->step);
}

StepReport World::step_together(Span<World* const> worlds, double dt) {
  StepReport refused;
  refused.dt = dt;
  refused.status = JointStep::check(worlds);
  if (refused.status.ok()) refused.status = world::check_dt(dt);
  if (!refused.status.ok()) return refused;
  if (worlds.size() == 1) return worlds[0]->step(dt);
  JointStep step(worlds, dt);
  try {
    step.run();
  } catch (const fluid::TooCrowded& crowd) {
    worlds[0]->impl_->start_report(refused, dt);
    refused.status = Status::refused(crowd.what());
    refused.alive = 0;
    for (const World* w : worlds) refused.alive += w->particle_count();
    return refused;
  }
  return step.report();
}

}  // namespace oilskin
