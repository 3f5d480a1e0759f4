#include "hard_cases/invariants.h"

#include <gtest/gtest.h>

#include <cstring>

#include "contact/zones.h"

namespace oilskin::test {

namespace {

audit::Point point(const Vec3& x) {
  return {x.x(), x.y(), x.z()};
}

std::vector<audit::Point> points(Span<const Vec3> xs) {
  std::vector<audit::Point> out;
  out.reserve(xs.size());
  for (const Vec3& x : xs) out.push_back(point(x));
  return out;
}

audit::Surface audited(const SurfaceMotion& s) {
  audit::Surface a;
  a.id = s.id;
  a.start = points(s.x_t0);
  a.end = points(s.x_t1);
  a.triangles.assign(s.triangles.begin(), s.triangles.end());
  return a;
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0);
}

// Of what can move.
struct Motion {
  double energy = 0, momentum_size = 0;
};

void add_motion(Motion& sum, const Vec3& v, double inverse_mass) {
  if (!(inverse_mass > 0)) return;
  sum.energy += 0.5 * v.squaredNorm() / inverse_mass;
  sum.momentum_size += v.norm() / inverse_mass;
}

Motion motion_of(const ContactScene& s) {
  Motion sum;
  for (std::size_t i = 0; i < s.particles.id.size(); ++i)
    add_motion(sum, s.particles.velocity[i], s.particles.inverse_mass[i]);
  for (const SurfaceMotion& m : s.surfaces)
    for (std::size_t i = 0; i < m.velocity.size(); ++i) add_motion(sum, m.velocity[i], m.inverse_mass[i]);
  return sum;
}

void expect_bounded(const ContactReport& r, const ContactSettings& settings, int intervals = 1) {
  EXPECT_LE(r.ccd_iterations, static_cast<std::uint64_t>(settings.ccd_iterations * intervals));
  EXPECT_LE(r.zone_rounds, contact::max_zone_rounds * static_cast<std::uint64_t>(intervals));
}

void expect_clean(const audit::Summary& s, bool crossings_allowed) {
  EXPECT_EQ(s.invalid, 0u) << s;
  EXPECT_EQ(s.jumps, 0u) << s;
  if (crossings_allowed) return;
  EXPECT_EQ(s.crossings + s.touchings, 0u) << s;
  EXPECT_EQ(s.too_near, 0u) << s;
}

}  // namespace

SurfaceMotion mesh_surface(const std::vector<Vec3>& nodes, const std::vector<Triangle>& triangles,
                           Storage storage, double mass, double thickness, double r, std::uint64_t id) {
  SurfaceMotion s;
  s.id = id;
  s.storage = storage;
  s.triangles = triangles;
  s.thickness = thickness;
  s.delta = minimum_separation(thickness, r, storage);
  for (const Vec3& x : nodes) s.x_t0.push_back(stored(x, storage));
  s.x_t1 = s.x_t0;
  s.velocity.assign(nodes.size(), Vec3::Zero());
  s.inverse_mass.assign(nodes.size(), mass > 0 ? 1 / mass : 0);
  s.holdable.assign(nodes.size(), 0);
  return s;
}

void Found::add(const Found& o) {
  total.add(o.total);
  audit.exact_pairs += o.audit.exact_pairs;
  audit.pairs += o.audit.pairs;
  audit.particles += o.audit.particles;
  audit.crossings += o.audit.crossings;
  audit.touchings += o.audit.touchings;
  intervals += o.intervals;
  momentum_error = std::max(momentum_error, o.momentum_error);
  energy_gain = std::max(energy_gain, o.energy_gain);
  speed = std::max(speed, o.speed);
  impulse = std::max(impulse, o.impulse);
}

double max_speed(const std::vector<Vec3>& velocities) {
  double largest = 0;
  for (const Vec3& v : velocities) largest = std::max(largest, v.norm());
  return largest;
}

double normal_speed(const ContactScene& scene, const Contact& contact) {
  Vec3 v = scene.particles.velocity[contact.particle];
  for (int k = 0; k < 3; ++k)
    v -= contact.weights[k] * scene.surfaces[contact.surface].velocity[contact.nodes[k]];
  return v.dot(contact.normal);
}

void lift(SurfaceMotion& s, double y) {
  for (auto* list : {&s.x_t0, &s.x_t1})
    for (Vec3& x : *list) x = stored(x + Vec3(0, y, 0), s.storage);
}

std::vector<SurfaceMotion*> ContactScene::surface_list() {
  std::vector<SurfaceMotion*> list;
  for (SurfaceMotion& s : surfaces) list.push_back(&s);
  return list;
}

Vec3 ContactScene::momentum() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < particles.id.size(); ++i)
    if (!particles.removed[i] && particles.inverse_mass[i] > 0)
      sum += particles.velocity[i] / particles.inverse_mass[i];
  for (const SurfaceMotion& s : surfaces)
    for (std::size_t i = 0; i < s.velocity.size(); ++i)
      if (s.inverse_mass[i] > 0) sum += s.velocity[i] / s.inverse_mass[i];
  return sum;
}

void ContactScene::move() {
  particles.move(dt);
  for (SurfaceMotion& s : surfaces)
    for (std::size_t i = 0; i < s.x_t0.size(); ++i)
      s.x_t1[i] = stored(s.x_t0[i] + dt * s.velocity[i], s.storage);
}

CheckedContact::CheckedContact(ContactScene s)
    : scene(std::move(s)), one_(scene.settings, 1), two_(scene.settings, 2) {
  audit::Limits limits;
  for (const SurfaceMotion& m : scene.surfaces) limits.delta_of[m.id] = m.delta;
  auditor_ = std::make_unique<audit::Auditor>(limits);
}

void CheckedContact::resolve() {
  ContactScene twin = scene;
  const Vec3 momentum = scene.momentum();
  const Motion before = motion_of(scene);
  const auto solve = [](ContactSolver& solver, ContactScene& s, ContactReport& r) {
    ParticleMotion motion = s.particles.motion(s.spacing);
    const std::vector<SurfaceMotion*> surfaces = s.surface_list();
    StageSeconds seconds;
    const Status status = solver.resolve(s.dt, motion, surfaces, r, seconds);
    ASSERT_TRUE(status.ok()) << status.message;
  };
  report = {};
  ASSERT_NO_FATAL_FAILURE(solve(one_, scene, report));
  ContactReport twin_report;
  ASSERT_NO_FATAL_FAILURE(solve(two_, twin, twin_report));
  contacts = one_.contacts();
  check_same_bits(twin);
  check_finite();
  audit_interval();
  expect_bounded(report, scene.settings);

  const Vec3 gained = scene.momentum() + report.momentum_removed + report.impulse_on_prescribed - momentum;
  const double size = std::max(before.momentum_size, motion_of(scene).momentum_size);
  if (size > 0) found.momentum_error = std::max(found.momentum_error, gained.norm() / size);
  EXPECT_LE(gained.norm(), max_momentum_error * size + std::numeric_limits<double>::min());

  double work = 0;  // of the owner of prescribed nodes
  for (const SurfaceMotion& s : scene.surfaces)
    for (std::size_t i = 0; i < s.velocity.size(); ++i) {
      found.impulse = std::max(found.impulse, s.impulse[i].norm());
      if (s.inverse_mass[i] == 0) work -= s.impulse[i].dot(s.velocity[i]);
    }
  // Springs store energy; and of the work of a particle of infinite mass that moves there is no record.
  bool is_known = scene.settings.repulsion != Repulsion::bridson;
  for (std::size_t i = 0; i < scene.particles.id.size(); ++i)
    is_known &= scene.particles.inverse_mass[i] > 0 || scene.particles.velocity[i].isZero(0);
  if (is_known) check_energy(before.energy, work);
  found.total.add(report);
  ++found.intervals;
}

void CheckedContact::check_energy(double before, double work) {
  const double after = motion_of(scene).energy, size = before + std::abs(work);
  const double gain = after - before - work;
  EXPECT_LE(gain, max_energy_gain * size + 1e-300);
  if (size > 0) found.energy_gain = std::max(found.energy_gain, gain / size);
}

void CheckedContact::check_finite() const {
  const auto all = [](const std::vector<Vec3>& vs, const char* what) {
    for (std::size_t i = 0; i < vs.size(); ++i) ASSERT_TRUE(vs[i].allFinite()) << what << " of " << i;
  };
  all(scene.particles.x_t1, "position of particle");
  all(scene.particles.velocity, "velocity of particle");
  for (const SurfaceMotion& s : scene.surfaces) {
    all(s.x_t1, "position of node");
    all(s.velocity, "velocity of node");
    all(s.impulse, "impulse of node");
    for (const Vec3& x : s.x_t1) ASSERT_EQ(x, stored(x, s.storage));
  }
  for (const Contact& r : contacts) {
    EXPECT_NEAR(r.weights[0] + r.weights[1] + r.weights[2], 1, 1e-15);
    EXPECT_NEAR(r.normal.norm(), 1, 1e-12);
  }
}

void CheckedContact::check_same_bits(const ContactScene& other) const {
  EXPECT_TRUE(same_bits(scene.particles.x_t1, other.particles.x_t1));
  EXPECT_TRUE(same_bits(scene.particles.velocity, other.particles.velocity));
  EXPECT_EQ(scene.particles.removed, other.particles.removed);
  for (std::size_t k = 0; k < scene.surfaces.size(); ++k) {
    EXPECT_TRUE(same_bits(scene.surfaces[k].x_t1, other.surfaces[k].x_t1));
    EXPECT_TRUE(same_bits(scene.surfaces[k].velocity, other.surfaces[k].velocity));
    EXPECT_TRUE(same_bits(scene.surfaces[k].impulse, other.surfaces[k].impulse));
  }
}

void CheckedContact::audit_interval() {
  audit::Record record;
  record.number = number_++;
  record.length = scene.dt;
  const ParticleArrays& p = scene.particles;
  for (std::size_t i = 0; i < p.id.size(); ++i) {
    found.speed = std::max(found.speed, p.velocity[i].norm());
    if (p.removed[i]) continue;
    record.ids.push_back(p.id[i]);
    record.start.push_back(point(p.x_t0[i]));
    record.end.push_back(point(p.x_t1[i]));
  }
  for (const SurfaceMotion& s : scene.surfaces) record.surfaces.push_back(audited(s));
  auditor_->audit(record);
  found.audit = auditor_->summary();
  expect_clean(found.audit, scene.settings.infeasible == Infeasible::allow);
}

void CheckedContact::advance() {
  scene.particles.drop_removed();
  scene.particles.x_t0 = scene.particles.x_t1;
  for (SurfaceMotion& s : scene.surfaces) s.x_t0 = s.x_t1;
}

void CheckedContact::run(int steps) {
  for (int k = 0; k < steps && !::testing::Test::HasFatalFailure(); ++k) {
    scene.move();
    resolve();
    advance();
  }
}

Found resolve_checked(ContactScene& scene) {
  CheckedContact check(std::move(scene));
  check.resolve();
  scene = std::move(check.scene);
  return check.found;
}

namespace {

// Keeps every interval for the auditor, who wants to know δ of all surfaces before it begins.
class Recorder : public IntervalObserver {
 public:
  void on_interval(const Interval& interval) override {
    audit::Record record;
    record.number = interval.number;
    record.length = interval.length;
    record.ids.assign(interval.id.begin(), interval.id.end());
    record.start = points(interval.x_t0);
    record.end = points(interval.x_t1);
    for (const SurfaceMotion* s : interval.surfaces) {
      record.surfaces.push_back(audited(*s));
      limits_.delta_of[s->id] = s->delta;
      for (const Vec3& j : s->impulse) max_impulse_ = std::max(max_impulse_, j.norm());
    }
    records_.push_back(std::move(record));
  }
  audit::Summary audit() const {
    audit::Auditor auditor(limits_);
    for (const audit::Record& r : records_) auditor.audit(r);
    return auditor.summary();
  }
  double max_impulse() const { return max_impulse_; }

 private:
  audit::Limits limits_;
  std::vector<audit::Record> records_;
  double max_impulse_ = 0;
};

void check_step(World& w, Found& found) {
  const StepReport& r = w.report();
  ASSERT_TRUE(r.status.ok()) << r.status.message;
  double size = r.momentum_removed.norm() + r.momentum_gravity.norm();
  for (std::size_t i = 0; i < w.particle_count(); ++i) {
    ASSERT_TRUE(w.positions()[i].allFinite() && w.velocities()[i].allFinite()) << "particle " << i;
    const double speed = w.velocities()[i].norm();
    found.speed = std::max(found.speed, speed);
    size += w.particle_mass() * speed;
  }
  size = std::max(size, r.momentum_before.norm() + r.momentum_emitted.norm());
  const double error = r.momentum_residual().norm();
  EXPECT_LE(error, max_momentum_error * size);
  if (size > 0) found.momentum_error = std::max(found.momentum_error, error / size);
  expect_bounded(r.contact, w.contact_settings(), r.substeps);
  found.total.add(r.contact);
  found.intervals += static_cast<std::uint64_t>(r.substeps);
}

/// What the reports of a run say of its mass, in the fluid and in its surfaces [kg].
struct MassLedger {
  double fluid = 0, liquid = 0, ever = 0;

  explicit MassLedger(const World& w)
      : fluid(w.fluid_mass()), liquid(w.absorbed_mass()), ever(fluid + liquid) {}
  void add(const StepReport& r) {
    fluid += r.mass_emitted - r.mass_removed - r.mass_absorbed + r.mass_released;
    liquid += r.mass_absorbed - r.mass_released - r.mass_dried - r.mass_lost;
    ever += r.mass_emitted;
  }
  void check(const World& w) const {
    EXPECT_NEAR(fluid, w.fluid_mass(), 1e-12 * ever) << "the ledger of mass";
    EXPECT_NEAR(liquid, w.absorbed_mass(), 1e-12 * ever) << "the ledger of liquid";
  }
};

}  // namespace

Found run_checked(const std::function<std::unique_ptr<WorldScene>(int)>& make, int steps, double dt) {
  Found found;
  std::uint64_t hash[2] = {0, 0};
  double liquid[2] = {0, 0};
  for (int threads : {1, 2}) {
    const std::unique_ptr<WorldScene> scene = make(threads);
    World& w = scene->world();
    Recorder recorder;
    if (threads == 1) w.set_observer(&recorder);
    MassLedger mass(w);
    for (int k = 0; k < steps && !::testing::Test::HasFatalFailure(); ++k) {
      scene->before_step(k);
      mass.add(w.step(dt));
      if (threads == 1) check_step(w, found);
      scene->after_step(k);
    }
    hash[threads - 1] = w.state_hash();
    liquid[threads - 1] = w.absorbed_mass();
    w.set_observer(nullptr);
    mass.check(w);
    if (threads == 1) {
      found.audit = recorder.audit();
      found.impulse = recorder.max_impulse();
      expect_clean(found.audit, w.contact_settings().infeasible == Infeasible::allow);
    }
  }
  EXPECT_EQ(hash[0], hash[1]) << "one and two threads";
  EXPECT_EQ(liquid[0], liquid[1]) << "one and two threads";
  return found;
}

}  // namespace oilskin::test
