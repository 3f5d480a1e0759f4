// Removal of particles by the caller.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "audit/trace_auditor.h"
#include "support/busy_scene.h"
#include "support/cloth_over_floor.h"
#include "world/saved_bytes.h"

namespace oilskin::test {
namespace {

WorldSettings pool(int threads = 1) {
  WorldSettings s;
  s.kill_box = {Vec3::Constant(-0.5), Vec3::Constant(0.5)};
  s.threads = threads;
  return s;
}

/// Keeps a number for each particle.
class Label : public Effect {
 public:
  std::string name() const override { return "label"; }
  std::vector<double> particle_values() const override { return {0}; }
};

/// What a world knows of a particle.
struct Known {
  Vec3 position, velocity, motion;
  double density, pressure, label;

  bool operator==(const Known& o) const {
    return position == o.position && velocity == o.velocity && motion == o.motion && density == o.density &&
           pressure == o.pressure && label == o.label;
  }
};

/// A falling block of 512 particles after five steps; the label of each is its id.
struct Block {
  explicit Block(int threads = 1) : world(pool(threads)) {
    EXPECT_TRUE(world.add_effect(label).ok());
    add_block(world, 8, Vec3(-0.02, 0, -0.02), Vec3(0.3, -1, 0));
    const std::vector<double> labels(world.ids().begin(), world.ids().end());
    EXPECT_TRUE(world.set_particle_values(label, 0, labels).ok());
    for (int k = 0; k < 5; ++k) EXPECT_TRUE(world.step(1e-3).status.ok());
  }

  Known known(std::size_t i) const {
    return {world.positions()[i], world.velocities()[i], world.motions()[i],
            world.densities()[i], world.pressures()[i],  world.particle_values(label, 0)[i]};
  }

  Label label;
  World world;
};

/// Removes with `remove`, which returns a number, and expects that those leave for which `is_chosen` holds,
/// and nothing else changes.
template <class Remove, class Chosen>
void expect_to_remove(Block& b, Remove remove, Chosen is_chosen) {
  std::vector<std::uint64_t> ids;
  std::vector<Known> rest;
  std::uint64_t chosen = 0;
  for (std::size_t i = 0; i < b.world.particle_count(); ++i) {
    if (is_chosen(b.world.ids()[i], b.world.positions()[i])) {
      ++chosen;
      continue;
    }
    ids.push_back(b.world.ids()[i]);
    rest.push_back(b.known(i));
  }
  ASSERT_GT(chosen, 0u);
  EXPECT_EQ(remove(), chosen);
  ASSERT_EQ(b.world.particle_count(), ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    EXPECT_EQ(b.world.ids()[i], ids[i]);
    EXPECT_TRUE(b.known(i) == rest[i]) << "particle " << ids[i];
    EXPECT_EQ(b.known(i).label, static_cast<double>(ids[i]));
  }
}

std::uint64_t remove_in(World& w, const Box& box) {
  std::uint64_t removed = 12345;
  EXPECT_TRUE(w.remove_particles(box, &removed).ok());
  return removed;
}

const Box lower_half = {Vec3(-0.5, -0.5, -0.5), Vec3(0.5, 0.0125, 0.5)};

TEST(Removal, takes_what_lies_in_a_box_and_leaves_the_rest_bit_for_bit) {
  Block b;
  expect_to_remove(
      b, [&] { return remove_in(b.world, lower_half); },
      [](std::uint64_t, const Vec3& x) { return x.y() <= 0.0125; });
  EXPECT_GT(b.world.particle_count(), 0u);
  EXPECT_EQ(remove_in(b.world, lower_half), 0u);
}

TEST(Removal, a_box_and_a_ball_contain_their_border) {
  World w(pool());
  const std::vector<Vec3> x = {Vec3(0.25, 0, 0), Vec3(0, 0.25, 0), Vec3(0.125, 0, 0), Vec3(0, 0, 0.375)};
  ASSERT_TRUE(w.add_particles(x, std::vector<Vec3>(4, Vec3::Zero())).ok());
  const Box point = {Vec3(0.125, 0, 0), Vec3(0.125, 0, 0)};
  EXPECT_EQ(remove_in(w, point), 1u);
  std::uint64_t removed = 0;
  ASSERT_TRUE(w.remove_particles(Vec3(0, 0, 0), 0.25, &removed).ok());
  EXPECT_EQ(removed, 2u);
  ASSERT_EQ(w.particle_count(), 1u);
  EXPECT_EQ(w.positions()[0], x[3]);
}

TEST(Removal, takes_what_lies_in_a_ball_or_has_an_id) {
  Block b;
  const Vec3 center(0, 0.01, 0);
  const auto in_ball = [&] {
    std::uint64_t removed = 0;
    EXPECT_TRUE(b.world.remove_particles(center, 0.012, &removed).ok());
    return removed;
  };
  expect_to_remove(b, in_ball, [&](std::uint64_t, const Vec3& x) { return (x - center).norm() <= 0.012; });
  const std::vector<std::uint64_t> ids = {512, 1, 7, 7, 100000, 0};
  expect_to_remove(
      b, [&] { return b.world.remove_particles(ids); },
      [](std::uint64_t id, const Vec3&) { return id == 512 || id == 1 || id == 7; });
  EXPECT_EQ(b.world.remove_particles(ids), 0u);
}

TEST(Removal, a_box_or_a_ball_that_makes_no_sense_is_refused) {
  const double nan = std::nan(""), inf = INFINITY;
  Block b;
  const std::uint64_t hash = b.world.state_hash();
  for (const Box& box :
       {Box{}, Box{Vec3(0, 1e-9, 0), Vec3::Zero()}, Box{Vec3(nan, 0, 0), Vec3::Ones()},
        Box{Vec3::Constant(-inf), Vec3::Constant(inf)}, Box{Vec3::Zero(), Vec3(1, nan, 1)}}) {
    std::uint64_t removed = 12345;
    const Status s = b.world.remove_particles(box, &removed);
    EXPECT_NE(s.message.find("it must be"), std::string::npos);
    EXPECT_EQ(removed, 12345u);
  }
  for (const double radius : {-1e-9, nan, inf})
    EXPECT_FALSE(b.world.remove_particles(Vec3::Zero(), radius).ok());
  EXPECT_FALSE(b.world.remove_particles(Vec3(0, inf, 0), 1.0).ok());
  EXPECT_EQ(b.world.remove_particles(Span<const std::uint64_t>()), 0u);
  EXPECT_EQ(b.world.particle_count(), 512u);
  EXPECT_EQ(b.world.state_hash(), hash);
  World refused(pool(), [] {
    FluidSettings bad;
    bad.spacing = -1;
    return bad;
  }());
  refused.clear();
  EXPECT_EQ(refused.particle_count(), 0u);
}

double made_by_balance(const EnergyReport& e) {
  return e.water_kinetic + e.water_potential + e.node_kinetic + e.node_potential + e.transfer +
         e.left_kinetic + e.left_potential - e.entered_kinetic - e.entered_potential - e.work_prescribed -
         e.work_host - e.work_outside;
}

TEST(Removal, the_next_report_has_mass_and_momentum) {
  Block b;
  const Vec3 before = fluid_momentum(b.world);
  const double m = b.world.particle_mass();
  const std::uint64_t removed = remove_in(b.world, lower_half);
  const Vec3 taken = before - fluid_momentum(b.world);
  const StepReport& r = b.world.step(1e-3);
  EXPECT_EQ(r.removed, removed);
  EXPECT_NEAR(r.mass_removed, static_cast<double>(removed) * m, 1e-12 * r.mass_removed);
  EXPECT_LT((r.momentum_removed - taken).norm(), 1e-12 * before.norm());
  EXPECT_LT((r.momentum_before - before).norm(), 1e-12 * before.norm());
  EXPECT_LT((r.momentum_after - fluid_momentum(b.world)).norm(), 1e-12 * before.norm());
  EXPECT_LT(r.momentum_residual().norm(), 1e-12 * before.norm());
  EXPECT_EQ(r.alive, 512 - removed);
  EXPECT_EQ(b.world.step(1e-3).removed, 0u) << "once";
  EXPECT_EQ(b.world.report().mass_removed, 0);
}

/// Particles too far from each other to interact, in free fall.
World& scattered(World& w) {
  std::vector<Vec3> x, v;
  for (int k = 0; k < 20; ++k) {
    x.push_back(Vec3(0.02 * k - 0.2, 0.3, 0.01 * (k % 3)));
    v.push_back(Vec3(0, -0.1 * k, 0.5));
  }
  EXPECT_TRUE(w.add_particles(x, v).ok());
  return w;
}

TEST(Removal, takes_the_energy_away_that_the_particles_had) {
  FluidSettings fluid;
  fluid.boundary = BoundaryModel::contact_only;
  World w(pool(), fluid);
  scattered(w);
  for (int k = 0; k < 20; ++k) w.step(1e-3);
  const EnergyReport before = w.report().energy;
  double kinetic = 0, potential = 0;
  for (std::size_t i = 0; i < w.particle_count(); ++i) {
    if (w.ids()[i] > 12) continue;
    const Vec3& u = w.motions()[i];
    kinetic += 0.5 * w.particle_mass() * u.squaredNorm();
    potential -= w.particle_mass() * w.settings().gravity.dot(w.positions()[i] - 0.5e-3 * u);
  }
  std::vector<std::uint64_t> ids(12);
  std::iota(ids.begin(), ids.end(), 1u);
  ASSERT_EQ(w.remove_particles(ids), 12u);
  const EnergyReport& after = w.step(1e-3).energy;
  EXPECT_EQ(before.left_kinetic, 0);
  EXPECT_NEAR(after.left_kinetic, kinetic, 1e-12 * kinetic);
  EXPECT_NEAR(after.left_potential, potential, 1e-12 * std::abs(potential));
  EXPECT_NEAR(after.work_outside, 0, 1e-12 * after.scale);
  EXPECT_NEAR(after.made, 0, 1e-11 * after.scale);
  EXPECT_NEAR(made_by_balance(after), after.made, 1e-11 * after.scale);
}

TEST(Removal, a_particle_that_has_not_moved_yet_brings_and_takes_no_energy) {
  World w(pool());
  scattered(w);
  const double m = w.particle_mass();
  w.clear();
  const StepReport& r = w.step(1e-3);
  EXPECT_EQ(r.removed, 20u);
  EXPECT_NEAR(r.mass_removed, 20 * m, 1e-12 * m);
  EXPECT_LT(r.momentum_residual().norm(), 1e-15);
  EXPECT_EQ(r.energy.entered_kinetic, 0);
  EXPECT_EQ(r.energy.left_kinetic, 0);
  EXPECT_EQ(r.energy.made, 0);
  EXPECT_EQ(r.energy.work_outside, 0);
}

TEST(Removal, velocities_that_are_not_finite_leave_the_ledger_finite) {
  Block b;
  std::vector<Vec3> dv(512, Vec3::Zero());
  dv[3].x() = std::nan("");
  ASSERT_TRUE(b.world.add_velocities(dv).ok());
  b.world.clear();
  const StepReport& r = b.world.step(1e-3);
  EXPECT_EQ(r.removed, 512u);
  EXPECT_EQ(r.removed_invalid, 0u);
  EXPECT_NEAR(r.mass_removed, 512 * b.world.particle_mass(), 1e-12 * r.mass_removed);
  EXPECT_TRUE(r.momentum_residual().allFinite());
  EXPECT_TRUE(std::isfinite(r.energy.made));
}

TEST(Removal, after_clear_emitters_go_on) {
  World w(pool());
  DiscEmitter jet;
  jet.radius = 0.012;
  jet.speed = 2;
  ASSERT_TRUE(w.add_emitter(jet).ok());
  for (int k = 0; k < 20; ++k) w.step(1e-3);
  const std::uint64_t last = *std::max_element(w.ids().begin(), w.ids().end());
  w.clear();
  EXPECT_EQ(w.particle_count(), 0u);
  EXPECT_EQ(w.fluid_mass(), 0);
  BoxEmitter box;
  box.box = {Vec3(0.1, 0.1, 0.1), Vec3(0.12, 0.12, 0.12)};
  box.start = w.time();
  ASSERT_TRUE(w.add_emitter(box).ok());
  double scale = 0;
  std::uint64_t emitted = 0;
  for (int k = 0; k < 20; ++k) {
    const StepReport& r = w.step(1e-3);
    ASSERT_TRUE(r.status.ok());
    emitted += r.emitted;
    scale += r.momentum_emitted.norm() + r.momentum_removed.norm();
    EXPECT_LT(r.momentum_residual().norm(), 1e-11 * scale);
    EXPECT_NEAR(made_by_balance(r.energy), r.energy.made, 1e-10 * r.energy.scale);
  }
  EXPECT_GT(emitted, 64u);
  EXPECT_EQ(w.particle_count(), emitted);
  for (std::uint64_t id : w.ids()) EXPECT_GT(id, last) << "ids are not given twice";
}

/// Twenty steps in which the caller removes what lies in a box that wanders, and all at the end.
std::vector<std::uint64_t> drain(BusyScene<float>& s, int first) {
  std::vector<std::uint64_t> trail;
  for (int k = first; k < first + 20; ++k) {
    const double x = 0.01 * (k % 10) - 0.05;
    const Box box = {Vec3(x, -0.2, -0.1), Vec3(x + 0.03, 0.1, 0.1)};
    trail.push_back(remove_in(s.world, box));
    const StepReport& r = s.step(k);
    EXPECT_TRUE(r.status.ok());
    EXPECT_GE(r.removed, trail.back());
    trail.push_back(r.removed);
    trail.push_back(s.world.state_hash());
  }
  return trail;
}

std::unique_ptr<BusyScene<float>> started(int threads) {
  auto scene = std::make_unique<BusyScene<float>>(busy_world(threads), dfsph());
  scene->add_emitters();
  EXPECT_TRUE(scene->ok);
  for (int k = 0; k < 40; ++k) EXPECT_TRUE(scene->step(k).status.ok());
  return scene;
}

TEST(Removal, is_the_same_on_any_number_of_threads) {
  const auto one = started(1), two = started(2);
  const std::vector<std::uint64_t> trail = drain(*one, 40);
  EXPECT_EQ(drain(*two, 40), trail);
  std::uint64_t removed = 0;
  for (std::size_t k = 0; k < trail.size(); k += 3) removed += trail[k];
  EXPECT_GT(removed, 100u);
}

TEST(Removal, a_world_saved_between_removal_and_step_goes_on_bit_for_bit) {
  const auto scene = started(1);
  const std::uint64_t removed = remove_in(scene->world, {Vec3(-0.05, -0.2, -0.1), Vec3(0.05, 0.02, 0.1)});
  ASSERT_GT(removed, 10u);
  const Bytes bytes = save(scene->world);
  BusyScene<float> other(busy_world(1), FluidSettings{});
  const Status s = other.world.restore(bytes);
  ASSERT_TRUE(s.ok()) << s.message;
  other.set_host_state(scene->host_state());
  EXPECT_EQ(save(other.world), bytes);
  const StepReport here = scene->step(40), there = other.step(40);
  EXPECT_GE(here.removed, removed);
  EXPECT_EQ(there.removed, here.removed);
  EXPECT_EQ(there.mass_removed, here.mass_removed);
  EXPECT_EQ(there.momentum_removed, here.momentum_removed);
  EXPECT_EQ(there.energy.left_kinetic, here.energy.left_kinetic);
  EXPECT_EQ(there.energy.made, here.energy.made);
  EXPECT_EQ(drain(other, 41), drain(*scene, 41));
}

/// A part of the water that lies on cloth is taken out in every tenth step. Returns how many particles the
/// caller removed.
std::uint64_t drain_cloth(std::ostream& out, audit::Limits* limits) {
  FluidSettings fluid;
  fluid.max_substeps = 1;  // a record for each step
  ContactSettings contact;
  contact.verify = true;
  World w(pool(2), fluid, contact);
  ClothOverFloor<float> sheets;
  sheets.pin_two_borders();
  sheets.attach_to(w);
  DiscEmitter jet;
  jet.center = Vec3(0.003, 0.05, -0.002);
  jet.radius = 0.012;
  jet.speed = 3;
  EXPECT_TRUE(w.add_emitter(jet).ok());
  TraceWriter trace(out);
  w.set_observer(&trace);
  std::uint64_t removed = 0, touching = 0;
  for (int k = 0; k < 120; ++k) {
    if (k % 10 == 9) {
      for (const Contact& c : w.contacts()) touching += w.positions()[c.particle].x() > 0;
      removed += remove_in(w, {Vec3(0, -0.1, -0.1), Vec3(0.1, 0.02, 0.1)});
    }
    const StepReport& r = w.step(1e-3);
    EXPECT_TRUE(r.status.ok());
    EXPECT_EQ(r.contact.crossings_found_by_verify, 0u);
    EXPECT_EQ(r.flags & (flag_leaked | flag_no_promise), 0u);
    const double size = r.momentum_before.norm() + r.momentum_emitted.norm() + r.momentum_gravity.norm();
    EXPECT_LT(r.momentum_residual().norm(), 1e-11 * size);
    EXPECT_NEAR(made_by_balance(r.energy), r.energy.made, 1e-9 * r.energy.scale);
  }
  EXPECT_GT(touching, 100u);
  *limits = sheets.limits(w);
  return removed;
}

TEST(Removal, nothing_crosses_cloth_whose_water_is_taken_away) {
  std::stringstream trace;
  audit::Limits limits;
  EXPECT_GT(drain_cloth(trace, &limits), 200u);
  audit::Summary summary;
  std::string error;
  ASSERT_TRUE(audit::audit_stream(trace, limits, &summary, &error)) << error;
  EXPECT_EQ(summary.records, 120u);
  EXPECT_EQ(summary.findings(), 0u) << summary;
}

}  // namespace
}  // namespace oilskin::test
