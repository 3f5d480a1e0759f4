#include "fuzz/random_world.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

#include "contact/zones.h"
#include "fuzz/random_sheet.h"
#include "oilskin/world.h"
#include "support/trace_watch.h"

namespace oilskin::test {

namespace {

/// Rounding of sums in the ledgers, relative to the sum of all magnitudes in them.
constexpr double ledger_tolerance = 1e-10;

template <class T, std::size_t n>
T one_of(Random& random, const T (&values)[n]) {
  return values[random.below(n)];
}

bool chance(Random& random, double p) {
  return random.uniform() < p;
}

class RandomWorld {
 public:
  RandomWorld(std::uint64_t seed, bool large, int threads);
  WorldVerdict run();

 private:
  struct Sheet {
    std::unique_ptr<RandomSheet> host;
    SurfaceSettings settings;
    SurfaceId id;  ///< none while it is detached
    bool spoilt = false;
  };
  struct Before {
    std::uint64_t alive = 0;
    double node_momentum = 0;   ///< Σ m |v|
    bool out_of_range = false;  ///< a surface proposes to be where δ was not chosen for
  };

  // Drawing
  void draw_settings(int threads);
  FluidSettings draw_fluid();
  ContactSettings draw_contact();
  SlipSettings draw_slip();
  SheetPlan draw_sheet();
  void add_sheet();
  void add_emitters();
  void add_water(std::uint32_t count);
  Vec3 place(double share = 0.3) { return arena_.center + random_.in_cube(share * arena_.half); }
  Vec3 beside_a_sheet();
  Vec3 speed();
  void describe();

  // Running
  void disturb();
  void kick();
  void step();

  // Judging
  void expect(bool holds, const std::string& what);
  double node_momentum() const;
  void check_finite();
  void check_counts(const StepReport& r, const Before& before);
  void check_momentum(const StepReport& r, const Before& before);
  void check_energy(const StepReport& r);
  void check_promise(const StepReport& r);
  bool nothing_is_driven() const;

  Random random_;
  const std::uint64_t seed_;
  const bool large_;
  double dx_ = 0.005, dt_ = 1e-3;
  Arena arena_;
  double reach_ = 1;  ///< largest coordinate of the kill box [m]
  WorldSettings world_settings_;
  bool leaks_allowed_ = false, something_passed_ = false, all_slip_free_ = true;
  std::unique_ptr<World> world_;
  std::vector<Sheet> sheets_;
  TraceWatch watch_;
  WorldVerdict verdict_;
};

RandomWorld::RandomWorld(std::uint64_t seed, bool large, int threads)
    : random_(Random(seed).bits()), seed_(seed), large_(large) {
  draw_settings(threads);
  const std::uint32_t surfaces = 1 + random_.below(large ? 5 : 3);
  for (std::uint32_t k = 0; k < surfaces; ++k) add_sheet();
  add_emitters();
  add_water(large ? 900 + random_.below(400) : 20 + random_.below(180));
  world_->set_observer(&watch_);
  describe();
}

void RandomWorld::draw_settings(int threads) {
  dx_ = one_of(random_, {0.005, 0.005, 1e-4, 0.3});
  dt_ = random_.log_uniform(1e-6, 0.5);
  arena_.half = 20 * dx_;
  arena_.center = random_.direction() * arena_.half * one_of(random_, {0.0, 0.0, 3.0});
  world_settings_.kill_box = {arena_.center - Vec3::Constant(1.5 * arena_.half),
                              arena_.center + Vec3::Constant(1.5 * arena_.half)};
  reach_ = std::max(world_settings_.kill_box.min.cwiseAbs().maxCoeff(),
                    world_settings_.kill_box.max.cwiseAbs().maxCoeff());
  world_settings_.gravity = random_.direction() * one_of(random_, {0.0, 9.81, 9.81, 9810.0});
  world_settings_.threads = threads;
  world_ = std::make_unique<World>(world_settings_, draw_fluid(), draw_contact());
  expect(world_->status().ok(), world_->status().message);
}

FluidSettings RandomWorld::draw_fluid() {
  FluidSettings s;
  s.spacing = dx_;
  s.rest_density = one_of(random_, {1000.0, 1000.0, 1.2, 13600.0});
  s.support_ratio = one_of(random_, {2.0, 2.0, 2.0, 1.5, 2.5, 3.0, 4.0});
  s.solver = one_of(random_, {PressureSolver::mcg03, PressureSolver::pcisph, PressureSolver::dfsph});
  s.tolerance = one_of(random_, {1e-3, 1e-3, 0.0, 0.1});
  s.min_iterations = 1 + static_cast<int>(random_.below(3));
  s.max_iterations = s.min_iterations + static_cast<int>(random_.below(30));
  s.stiffness = random_.log_uniform(0.1, 1000);
  s.viscosity = one_of(random_, {0.0, 1e-6, 1e-6, 1e-2});
  s.xsph_rate = one_of(random_, {0.0, 10.0, 1000.0});
  s.contact_aware = chance(random_, 0.8);
  s.occlusion = chance(random_, 0.7);
  if (s.solver != PressureSolver::mcg03 && chance(random_, 0.4)) s.boundary = BoundaryModel::mirrored;
  s.cfl = one_of(random_, {0.4, 0.4, 5.0});
  s.max_substeps = chance(random_, 0.3) ? 2 + static_cast<int>(random_.below(6)) : 1;
  return s;
}

ContactSettings RandomWorld::draw_contact() {
  ContactSettings s;
  s.repulsion = one_of(random_, {Repulsion::split, Repulsion::split, Repulsion::bridson, Repulsion::none});
  s.stiffness = random_.log_uniform(1e-3, 1e9);
  s.solver_iterations = one_of(random_, {5, 5, 1, 20});
  s.ccd_iterations = one_of(random_, {5, 5, 0, 1, 10});
  s.infeasible =
      one_of(random_, {Infeasible::stall, Infeasible::stall, Infeasible::remove, Infeasible::allow});
  s.verify = true;
  const double promise = random_.uniform();
  s.ccd = promise > 0.04;
  s.zones = promise > 0.04 || promise < 0.02;
  leaks_allowed_ = s.infeasible == Infeasible::allow;
  verdict_.promised = s.ccd && s.zones;
  return s;
}

SlipSettings RandomWorld::draw_slip() {
  SlipSettings s;
  s.model = one_of(random_, {SlipModel::free, SlipModel::free, SlipModel::coulomb, SlipModel::sticking,
                             SlipModel::viscous_wall});
  s.friction = one_of(random_, {1.0, 0.0, 0.3, 1e9, std::numeric_limits<double>::infinity()});
  s.slip_length = one_of(random_, {0.0, 1e-3, std::numeric_limits<double>::infinity()});
  all_slip_free_ &= s.model == SlipModel::free;
  return s;
}

SheetPlan RandomWorld::draw_sheet() {
  SheetPlan p;
  p.mesh =
      one_of(random_, {MeshKind::grid, MeshKind::layers, MeshKind::folds, MeshKind::crumpled, MeshKind::bag});
  p.motion = one_of(random_, {SheetMotion::still, SheetMotion::shaken, SheetMotion::carried,
                              SheetMotion::closing, SheetMotion::turning, SheetMotion::free_flight});
  p.storage = chance(random_, 0.5) ? Storage::float32 : Storage::float64;
  p.edge = dx_ * random_.uniform(0.4, 3);
  p.displacement = random_.log_uniform(0.01, 100);
  p.pins = one_of(random_, {0.0, 0.0, 0.1, 0.5, 1.0});
  p.pins_agree = chance(random_, 0.7);
  p.holdable = chance(random_, 0.6);
  p.movable = chance(random_, 0.5);
  const double middle = world_->particle_mass() * random_.log_uniform(1e-3, 1e3);
  const double span = one_of(random_, {1.0, 1e3, 1e6});
  p.lightest = middle / span;
  p.heaviest = middle * span;
  return p;
}

void RandomWorld::add_sheet() {
  Sheet sheet;
  const SheetPlan plan = draw_sheet();
  sheet.host = std::make_unique<RandomSheet>(plan, place(), random_);
  sheet.settings.slip = draw_slip();
  if (chance(random_, 0.2)) sheet.settings.slip_back = draw_slip();
  const double thinnest = 4.01 * minimum_separation(0, reach_, plan.storage);
  sheet.settings.thickness = std::max(thinnest, dx_ * random_.log_uniform(1e-3, 1.5));
  if (chance(random_, 0.05)) sheet.settings.collision_mask = 2;
  const Status s = world_->attach(*sheet.host, sheet.settings, &sheet.id);
  expect(s.ok(), "attach: " + s.message);
  sheets_.push_back(std::move(sheet));
}

/// Somewhere near a node, at times nearer than δ.
Vec3 RandomWorld::beside_a_sheet() {
  const RandomSheet& sheet = *sheets_[random_.below(static_cast<std::uint32_t>(sheets_.size()))].host;
  const Vec3& node = sheet.nodes()[random_.below(static_cast<std::uint32_t>(sheet.nodes().size()))];
  return node + random_.direction() * dx_ * random_.log_uniform(1e-6, 5);
}

Vec3 RandomWorld::speed() {
  return random_.direction() * dx_ / dt_ * random_.log_uniform(0.01, 30);
}

void RandomWorld::add_emitters() {
  const double start = random_.uniform() * 5 * dt_;
  Status s;
  if (chance(random_, 0.3)) {
    DiscEmitter e;
    e.center = beside_a_sheet();
    e.direction = random_.direction();
    e.radius = random_.uniform(1, 3) * dx_;
    e.speed = std::min(speed().norm(), dx_ / dt_);
    e.start = start;
    s = world_->add_emitter(e);
    expect(s.ok(), s.message);
  }
  if (chance(random_, 0.2)) {
    RainEmitter e;
    e.corner = place();
    e.edge_u = random_.in_cube(5 * dx_);
    e.edge_v = random_.in_cube(5 * dx_);
    e.drops_per_second = random_.uniform(0.1, 3) / dt_;
    e.drop_radius = random_.uniform(0, 2) * dx_;
    e.velocity = speed();
    e.seed = random_.bits();
    s = world_->add_emitter(e);
    expect(s.ok(), s.message);
  }
  if (chance(random_, 0.2)) {
    BoxEmitter e;
    const Vec3 corner = place();
    e.box = {corner, corner + Vec3::Constant(random_.uniform(1.01, 5) * dx_)};
    e.velocity = speed();
    e.start = start;
    s = world_->add_emitter(e);
    expect(s.ok(), s.message);
  }
}

void RandomWorld::add_water(std::uint32_t count) {
  std::vector<Vec3> x, v;
  const Vec3 common = speed(), corner = beside_a_sheet();
  const bool in_a_block = chance(random_, 0.5);
  const auto side = static_cast<std::uint32_t>(std::ceil(std::cbrt(count)));
  for (std::uint32_t k = 0; k < count; ++k) {
    const Vec3 cell(k % side, k / side % side, k / (side * side));
    x.push_back(in_a_block ? Vec3(corner + dx_ * cell) : beside_a_sheet());
    v.push_back(chance(random_, 0.9) ? common : speed());
  }
  std::uint64_t blocked = 0;
  const std::size_t before = world_->particle_count();
  const Status s = world_->add_particles(x, v, &blocked);
  expect(s.ok() && world_->particle_count() == before + count - blocked, "add_particles: " + s.message);
}

void RandomWorld::describe() {
  const FluidSettings& f = world_->fluid_settings();
  const ContactSettings& c = world_->contact_settings();
  static const char* const solvers[] = {"mcg03", "pcisph", "dfsph"};
  static const char* const repulsions[] = {"split", "bridson", "none"};
  static const char* const policies[] = {"stall", "remove", "allow"};
  std::ostringstream s;
  s << "seed " << seed_ << (large_ ? " (large)" : "") << ": " << world_->particle_count() << " particles, dx "
    << dx_ << ", dt " << dt_ << ", " << solvers[static_cast<int>(f.solver)] << " H/dx " << f.support_ratio
    << ", sub-steps " << f.max_substeps << (f.boundary == BoundaryModel::mirrored ? ", mirrored" : "")
    << (f.occlusion ? ", occlusion" : "") << ", " << repulsions[static_cast<int>(c.repulsion)] << ", "
    << policies[static_cast<int>(c.infeasible)] << (verdict_.promised ? "" : ", no promise") << "; surfaces:";
  for (const Sheet& sheet : sheets_) {
    const SheetPlan& p = sheet.host->plan();
    s << ' ' << name_of(p.mesh) << ' ' << name_of(p.motion) << ' ' << p.displacement << " edges "
      << (p.storage == Storage::float32 ? "float" : "double") << " pins " << p.pins << " h/dx "
      << sheet.settings.thickness / dx_ << ';';
  }
  verdict_.what = s.str();
}

// --- Running

WorldVerdict RandomWorld::run() {
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

void RandomWorld::kick() {
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
void RandomWorld::disturb() {
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
}

void RandomWorld::step() {
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
  verdict_.hashes.push_back(world_->state_hash());
}

// --- Judging

void RandomWorld::expect(bool holds, const std::string& what) {
  if (!holds) verdict_.faults.push_back("step " + std::to_string(verdict_.steps) + ": " + what);
}

double RandomWorld::node_momentum() const {
  double sum = 0;
  for (const Sheet& s : sheets_)
    if (const SurfaceMotion* m = s.id ? world_->surface(s.id) : nullptr)
      for (std::size_t i = 0; i < m->velocity.size() && i < m->inverse_mass.size(); ++i)
        if (m->inverse_mass[i] > 0 && !s.spoilt) sum += m->velocity[i].norm() / m->inverse_mass[i];
  return sum;
}

void RandomWorld::check_finite() {
  const auto finite = [](Span<const Vec3> values) {
    return std::all_of(values.begin(), values.end(), [](const Vec3& x) { return x.allFinite(); });
  };
  const auto finite_numbers = [](Span<const double> values) {
    return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
  };
  expect(finite(world_->positions()), "positions are not finite");
  expect(finite(world_->velocities()), "velocities are not finite");
  expect(finite_numbers(world_->densities()), "densities are not finite");
  expect(finite_numbers(world_->pressures()), "pressures are not finite");
  for (const Sheet& s : sheets_) {
    if (!s.id || s.spoilt) continue;
    const SurfaceMotion& m = *world_->surface(s.id);
    expect(finite(m.x_t1) && finite(m.velocity) && finite(m.impulse), "a surface is not finite");
    bool stored_numbers = true;
    for (const Vec3& x : m.x_t1) stored_numbers &= x == stored(x, m.storage);
    expect(stored_numbers, "a surface holds numbers that its host cannot store");
  }
}

void RandomWorld::check_counts(const StepReport& r, const Before& before) {
  const ContactReport& c = r.contact;
  const ContactSettings& settings = world_->contact_settings();
  const auto substeps = static_cast<std::uint64_t>(r.substeps);
  expect(r.alive == world_->particle_count(), "alive");
  expect(before.alive + r.emitted == r.alive + r.removed + r.removed_invalid, "particles are lost or made");
  const double m = world_->particle_mass();
  const double out = m * static_cast<double>(r.removed + r.removed_invalid),
               in = m * static_cast<double>(r.emitted);
  expect(std::abs(r.mass_removed - out) <= 1e-12 * out, "mass removed");
  expect(std::abs(r.mass_emitted - in) <= 1e-12 * in, "mass emitted");
  expect(substeps >= 1 && r.substeps <= world_->fluid_settings().max_substeps, "sub-steps");
  expect(c.ccd_iterations <= substeps * static_cast<std::uint64_t>(settings.ccd_iterations), "rounds");
  expect(c.zone_rounds <= substeps * contact::max_zone_rounds,
         "zone rounds: " + std::to_string(c.zone_rounds));
  expect(r.fluid.iterations <= r.substeps * world_->fluid_settings().max_iterations, "iterations");
  expect(c.stalled <= c.held, "stalled");
  expect(c.removed <= r.removed, "removed");
  expect(settings.infeasible == Infeasible::allow || c.allowed == 0, "allowed without leave");
  expect(settings.infeasible == Infeasible::stall || c.stalled == 0, "stalled without leave");
  expect(settings.infeasible != Infeasible::allow || c.removed == 0, "removed without leave");
  const auto flag_says = [&](StepFlag flag, bool is) {
    expect(((r.flags & flag) != 0) == is, flag_texts(flag)[0]);
  };
  flag_says(flag_leaked, c.allowed > 0);
  flag_says(flag_stalled, c.stalled > 0);
  flag_says(flag_removed_by_contact, c.removed > 0);
  flag_says(flag_removed_invalid, r.removed_invalid > 0);
  flag_says(flag_many_holds, c.held > 0);
  flag_says(flag_scatter_mismatch, false);
  flag_says(flag_surface_out_of_range, before.out_of_range);
  flag_says(flag_surface_refused,
            std::any_of(sheets_.begin(), sheets_.end(), [](const Sheet& s) { return s.id && s.spoilt; }));
  verdict_.particles += r.alive;
  verdict_.impacts += c.impacts;
  verdict_.zone_steps += c.zone_rounds > 0;
  verdict_.max_zone_rounds = std::max(verdict_.max_zone_rounds, c.zone_rounds / substeps);
  verdict_.stalled += c.stalled;
  verdict_.carried_along += c.carried_along;
  verdict_.removed += c.removed;
  verdict_.allowed += c.allowed;
  verdict_.relocated += c.relocated;
  verdict_.removed_invalid += r.removed_invalid;
  verdict_.blocked += r.blocked_starts;
}

void RandomWorld::check_momentum(const StepReport& r, const Before& before) {
  const double m = world_->particle_mass();
  Vec3 fluid = Vec3::Zero(), on_nodes = Vec3::Zero();
  double size = before.node_momentum + node_momentum() + r.momentum_before.norm() +
                r.momentum_removed.norm() + r.momentum_emitted.norm() + r.momentum_gravity.norm();
  for (const Vec3& v : world_->velocities()) {
    fluid += m * v;
    size += m * v.norm();
  }
  for (const Sheet& s : sheets_) {
    const SurfaceMotion* motion = s.id && !s.spoilt ? world_->surface(s.id) : nullptr;
    if (!motion) continue;
    for (const Vec3& j : motion->impulse) {
      on_nodes += j;
      size += j.norm();
    }
  }
  const double residual = r.momentum_residual().norm();
  if (residual > ledger_tolerance * size && r.removed_invalid >= 2) {
    // Two whom the pressure threw apart at 1e18 m/s take momenta along, of which the report tells the sum.
    // What is lost in rounding them is no fault.
    ++verdict_.not_judged;
  } else {
    if (size > 0) verdict_.worst_momentum = std::max(verdict_.worst_momentum, residual / size);
    std::ostringstream text;
    text << "momentum: residual " << residual << " of " << size;
    expect(residual <= ledger_tolerance * size, text.str());
  }
  expect((fluid - r.momentum_after).norm() <= ledger_tolerance * size, "momentum_after");
  const Vec3 booked = r.contact.impulse_on_free_nodes + r.contact.impulse_on_prescribed;
  expect((booked - on_nodes).norm() <= ledger_tolerance * size, "impulses are not what is booked");
}

bool RandomWorld::nothing_is_driven() const {
  for (const Sheet& s : sheets_) {
    const SurfaceMotion* m = s.id && !s.spoilt ? world_->surface(s.id) : nullptr;
    if (!m) continue;
    for (std::size_t i = 0; i < m->x_t1.size(); ++i)
      if (m->inverse_mass[i] == 0 && (m->x_t1[i] != m->x_t0[i] || m->velocity[i] != Vec3::Zero()))
        return false;
  }
  return true;
}

/// Contact takes energy, where nothing drives it and no spring gives.
void RandomWorld::check_energy(const StepReport& r) {
  if (!all_slip_free_ || world_->contact_settings().repulsion == Repulsion::bridson || !nothing_is_driven())
    return;
  double energy = std::abs(r.contact.kinetic_energy_change);
  for (const Vec3& v : world_->velocities()) energy += 0.5 * world_->particle_mass() * v.squaredNorm();
  for (const Sheet& s : sheets_) {
    const SurfaceMotion* m = s.id && !s.spoilt ? world_->surface(s.id) : nullptr;
    if (!m) continue;
    for (std::size_t i = 0; i < m->velocity.size(); ++i)
      if (m->inverse_mass[i] > 0) energy += 0.5 * m->velocity[i].squaredNorm() / m->inverse_mass[i];
  }
  std::ostringstream text;
  text << "contact gives energy: " << r.contact.kinetic_energy_change << " of " << energy << " J";
  expect(r.contact.kinetic_energy_change <= 1e-12 * r.substeps * energy, text.str());
}

void RandomWorld::check_promise(const StepReport& r) {
  if (!verdict_.promised) return;
  const ContactReport& c = r.contact;
  something_passed_ |= c.allowed > 0;
  if (!something_passed_) {
    expect(c.started_too_close == 0, "a particle begins nearer than δ");
    expect((r.flags & flag_no_promise) == 0, "no promise");
  }
  // It takes what passes an edge closer than rounding tells (1e-17 m) for a crossing; the auditor decides.
  verdict_.false_alarms += c.crossings_found_by_verify > c.allowed;
  if (!leaks_allowed_) return;
  const audit::Summary s = watch_.judge();
  verdict_.pairs += s.pairs;
  // The auditor has seen the last interval before again, with what was allowed then.
  expect(s.jumps + s.invalid == 0, "the auditor finds jumps");
  if (!something_passed_) expect(s.findings() == 0, "the auditor finds what was not allowed");
}

}  // namespace

WorldVerdict run_random_world(std::uint64_t seed, bool large, int threads) {
  return RandomWorld(seed, large, threads).run();
}

}  // namespace oilskin::test
