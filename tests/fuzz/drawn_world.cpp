// What is drawn.
#include "fuzz/drawn_world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace oilskin::test {

DrawnWorld::DrawnWorld(std::uint64_t seed, bool large, int threads)
    : random_(Random(seed).bits()), fields_random_(Random(~seed).bits()), seed_(seed), large_(large) {
  draw_settings(threads);
  const std::uint32_t surfaces = 1 + random_.below(large ? 5 : 3);
  for (std::uint32_t k = 0; k < surfaces; ++k) add_sheet();
  add_emitters();
  add_water(large ? 900 + random_.below(400) : 20 + random_.below(180));
  add_fields();
  world_->set_observer(&watch_);
  describe();
}

void DrawnWorld::draw_settings(int threads) {
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

FluidSettings DrawnWorld::draw_fluid() {
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
  const bool mirrored = s.solver != PressureSolver::mcg03 && chance(random_, 0.4);
  s.boundary = mirrored ? BoundaryModel::mirrored : BoundaryModel::contact_only;
  if (s.boundary == BoundaryModel::mirrored) s.support_ratio = std::min(s.support_ratio, 2.5);
  s.cfl = one_of(random_, {0.4, 0.4, 5.0});
  s.max_substeps = chance(random_, 0.3) ? 2 + static_cast<int>(random_.below(6)) : 1;
  return s;
}

ContactSettings DrawnWorld::draw_contact() {
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

SlipSettings DrawnWorld::draw_slip() {
  SlipSettings s;
  s.model = one_of(random_, {SlipModel::free, SlipModel::free, SlipModel::coulomb, SlipModel::sticking,
                             SlipModel::viscous_wall});
  s.friction = one_of(random_, {1.0, 0.0, 0.3, 1e9, std::numeric_limits<double>::infinity()});
  s.slip_length = one_of(random_, {0.0, 1e-3, std::numeric_limits<double>::infinity()});
  all_slip_free_ &= s.model == SlipModel::free;
  return s;
}

SheetPlan DrawnWorld::draw_sheet() {
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

void DrawnWorld::add_sheet() {
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
Vec3 DrawnWorld::beside_a_sheet() {
  const RandomSheet& sheet = *sheets_[random_.below(static_cast<std::uint32_t>(sheets_.size()))].host;
  const Vec3& node = sheet.nodes()[random_.below(static_cast<std::uint32_t>(sheet.nodes().size()))];
  return node + random_.direction() * dx_ * random_.log_uniform(1e-6, 5);
}

Vec3 DrawnWorld::speed() {
  return random_.direction() * dx_ / dt_ * random_.log_uniform(0.01, 30);
}

void DrawnWorld::add_emitters() {
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

void DrawnWorld::add_water(std::uint32_t count) {
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

void DrawnWorld::describe() {
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
      << *sheet.settings.thickness / dx_ << ';';
  }
  s << ' ' << drains_.size() << " sinks, " << forces_.size() << " forces, age " << max_age_ / dt_ << " dt";
  verdict_.what = s.str();
}

}  // namespace oilskin::test
