// What happens in a random world.
#include "fuzz/drawn_world.h"

#include <cmath>
#include <sstream>

namespace oilskin::test {

WorldVerdict DrawnWorld::run() {
  const int steps = large_ ? 6 : 8 + static_cast<int>(random_.below(10));
  for (int k = 0; k < steps && verdict_.faults.empty(); ++k) {
    if (k > 0) disturb();
    step();
  }
  if (!leaks_allowed_ && verdict_.promised) {
    const audit::Summary s = watch_.judge();
    verdict_.pairs += s.pairs;
    std::ostringstream text;
    text << s;
    for (const std::string& d : s.details) text << "\n    " << d;
    expect(s.findings() == 0, "the auditor: " + text.str());
  }
  world_->set_observer(nullptr);
  return std::move(verdict_);
}

void DrawnWorld::kick() {
  std::vector<Vec3> dv(world_->particle_count(), Vec3::Zero());
  for (Vec3& v : dv)
    if (chance(random_, 0.3)) v = speed();
  if (!dv.empty() && chance(random_, 0.2))
    dv[random_.below(static_cast<std::uint32_t>(dv.size()))].x() = std::nan("");
  if (!dv.empty() && chance(random_, 0.2))
    dv[random_.below(static_cast<std::uint32_t>(dv.size()))].y() = 1e300;
  expect(world_->add_velocities(dv).ok(), "add_velocities");
}

/// What a user does between two steps.
void DrawnWorld::disturb() {
  for (Sheet& s : sheets_) {
    if (chance(random_, 0.03)) s.host->change_a_pin(random_);
    if (s.id && s.spoilt && chance(random_, 0.5)) {
      s.host->mend();
      s.spoilt = false;
      world_->reset_motion(s.id);
    } else if (s.id && !s.spoilt && chance(random_, 0.01)) {
      s.host->spoil();
      s.spoilt = true;
    }
    // Zones let light cloth fly with the water that has caught it.
    const bool lost = s.host->reach() > reach_;
    if (lost || (s.id && chance(random_, 0.04))) {
      s.host->jump(random_, arena_);
      if (s.id) world_->reset_motion(s.id);
    }
    if (s.id && chance(random_, 0.03)) {
      world_->detach(s.id);
      s.id = {};
    } else if (!s.id && !s.spoilt && chance(random_, 0.3)) {
      expect(world_->attach(*s.host, s.settings, &s.id).ok(), "attach again");
    }
    if (s.id && chance(random_, 0.03))
      expect(world_->set_slip(s.id, draw_slip(), draw_slip()).ok(), "set_slip");
  }
  if (chance(random_, 0.03)) add_sheet();
  if (chance(random_, 0.1)) kick();
  if (chance(random_, 0.05)) add_water(1 + random_.below(20));
  if (chance(random_, 0.03))
    expect(world_->set_gravity(random_.direction() * random_.log_uniform(1e-3, 1e4)).ok(), "set_gravity");
  disturb_fields();
}

void DrawnWorld::step() {
  const double dt = dt_ * (chance(random_, 0.1) ? random_.log_uniform(1e-3, 10) : random_.uniform(0.5, 1));
  for (Sheet& s : sheets_) s.host->propose(random_, arena_, world_->settings().gravity, dt);
  Before before;
  before.alive = world_->particle_count();
  before.node_momentum = node_momentum();
  for (const Sheet& s : sheets_) before.out_of_range |= s.id && !s.spoilt && s.host->reach() > reach_;
  const double time = world_->time();
  const StepReport& r = world_->step(dt);
  ++verdict_.steps;
  expect(r.status.ok(), r.status.message);
  expect(r.time == time + dt && r.dt == dt, "time");
  check_finite();
  check_counts(r, before);
  check_momentum(r, before);
  check_energy(r);
  check_promise(r);
  check_fields(r);
  verdict_.hashes.push_back(world_->state_hash());
}

WorldVerdict run_random_world(std::uint64_t seed, bool large, int threads) {
  return DrawnWorld(seed, large, threads).run();
}

}  // namespace oilskin::test
