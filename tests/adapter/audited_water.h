/// Water on Bullet's bodies, watched from outside: every interval is judged in exact arithmetic, and what the
/// report books is compared with what Bullet's nodes hold.
#pragma once

#include <gtest/gtest.h>

#include <sstream>

#include "audit/trace_auditor.h"
#include "bullet_world.h"
#include "oilskin/bullet.h"

namespace oilskin::bullet::test {

constexpr double sheet_thickness = 0.002;
const btVector3 down(0, bt(-9.81), 0);

/// All surfaces of the fluid have `sheet_thickness`, so that one δ serves.
class AuditedWater : public btFluid, private IntervalObserver {
 public:
  explicit AuditedWater(double kill_box = 2)
      : btFluid(coarse(), boxed(kill_box), ContactSettings()),
        auditor_(limits(minimum_separation(sheet_thickness, kill_box, bt_storage))) {
    getWorld().set_observer(this);
  }

  /// The step that was just coupled: nothing crossed, and the fluid's ledger is closed.
  void expect_sound(const StepReport& report) {
    ASSERT_TRUE(report.status.ok()) << report.status.message;
    ASSERT_EQ(auditor_.summary().findings(), 0u) << "step " << report.step << "\n" << auditor_.summary();
    constexpr std::uint32_t faults = flag_leaked | flag_scatter_mismatch | flag_no_promise |
                                     flag_surface_refused | flag_removed_invalid | flag_removed_by_contact;
    ASSERT_EQ(report.flags & faults, 0u) << "step " << report.step << ": " << flag_texts(report.flags)[0];
    Vec3 fluid = Vec3::Zero();
    double size = report.momentum_before.norm() + report.momentum_gravity.norm();
    for (const Vec3& v : getWorld().velocities()) {
      fluid += getWorld().particle_mass() * v;
      size += getWorld().particle_mass() * v.norm();
    }
    ASSERT_LE((fluid - report.momentum_after).norm(), 1e-12 * size);
    ASSERT_LE(report.momentum_residual().norm(), 1e-10 * size) << "step " << report.step;
    contacts += report.contact.contacts + report.contact.impacts;
  }

  /// Particles that have the cloth straight below them.
  int carried_by(const btSoftBody& cloth) const {
    int count = 0;
    for (const Vec3& x : getWorld().positions()) count += is_above(cloth, x);
    return count;
  }

  const audit::Summary& summary() const { return auditor_.summary(); }

  std::uint64_t contacts = 0;

 private:
  static FluidSettings coarse() {
    FluidSettings fluid;
    fluid.spacing = 0.02;
    fluid.solver = PressureSolver::pcisph;  // the model of the paper: what carries the water is contact
    fluid.boundary = BoundaryModel::contact_only;
    fluid.max_substeps = 1;  // a record for each coupling
    return fluid;
  }
  static WorldSettings boxed(double r) {
    WorldSettings world;
    world.kill_box = {Vec3::Constant(-r), Vec3::Constant(r)};
    world.threads = 2;
    return world;
  }
  static audit::Limits limits(double delta) {
    audit::Limits limits;
    limits.delta = delta;
    return limits;
  }

  static bool is_above(const btSoftBody& cloth, const Vec3& x) {
    for (int f = 0; f < cloth.m_faces.size(); ++f) {
      const auto& n = cloth.m_faces[f].m_n;
      const Vec3 a = to_vec3(n[0]->m_x) - x, b = to_vec3(n[1]->m_x) - x, c = to_vec3(n[2]->m_x) - x;
      const auto turn = [](const Vec3& p, const Vec3& q) { return p.x() * q.z() - p.z() * q.x(); };
      const double wa = turn(b, c), wb = turn(c, a), wc = turn(a, b), sum = wa + wb + wc;
      const bool covers = (wa >= 0 && wb >= 0 && wc >= 0) || (wa <= 0 && wb <= 0 && wc <= 0);
      if (covers && sum != 0 && (wa * a.y() + wb * b.y() + wc * c.y()) / sum < 0) return true;
    }
    return false;
  }

  void on_interval(const Interval& interval) override {
    std::stringstream trace;
    TraceWriter(trace).on_interval(interval);
    audit::Record record;
    std::string error;
    ASSERT_EQ(audit::read_record(trace, &record, &error), audit::ReadResult::kRecord) << error;
    auditor_.audit(record);
  }

  audit::Auditor auditor_;
};

/// Runs `couple` and compares what the report says the free nodes got with how their momentum changed.
template <class Couple>
void expect_nodes_get_what_is_booked(const btAlignedObjectArray<btSoftBody*>& bodies, const World& water,
                                     Couple couple) {
  const auto steps = water.step_count();
  Vec3 change = Vec3::Zero();
  double size = 0;
  for (int i = 0; i < bodies.size(); ++i) change -= momentum(*bodies[i]);
  couple();
  if (water.step_count() == steps) return;
  for (int i = 0; i < bodies.size(); ++i) {
    change += momentum(*bodies[i]);
    for (int k = 0; k < bodies[i]->m_nodes.size(); ++k) {
      const btSoftBody::Node& n = bodies[i]->m_nodes[k];
      if (n.m_im > 0) size += to_vec3(n.m_v).norm() / static_cast<double>(n.m_im);
    }
  }
  // What is owed went to the supports of cloth that carries water.
  const Vec3 booked = water.report().contact.impulse_on_free_nodes - water.report().momentum_owed;
  size += booked.norm();
  ASSERT_LE((change - booked).norm(), (is_double ? 1e-13 : 1e-6) * size) << "step " << steps + 1;
}

/// The solver that a user passes to Bullet, with the ledger checked at every coupling.
class LedgerSolver : public btFluidSoftBodySolver {
 public:
  void updateSoftBodies() override {
    const btFluid* fluid = getCoupling().getFluid();
    if (!fluid) return btFluidSoftBodySolver::updateSoftBodies();
    expect_nodes_get_what_is_booked(m_softBodySet, fluid->getWorld(),
                                    [this] { btFluidSoftBodySolver::updateSoftBodies(); });
  }
};

inline void pin_border(btSoftBody* cloth, int n) {
  for (int i = 0; i < n * n; ++i)
    if (i % n == 0 || i % n == n - 1 || i < n || i >= n * (n - 1)) cloth->setMass(i, 0);
}

}  // namespace oilskin::bullet::test
