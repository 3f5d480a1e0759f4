#include "contact/rows.h"

#include <algorithm>
#include <cmath>

#include "contact/records.h"
#include "contact/slip.h"
#include "core/assert.h"

namespace oilskin::contact {

namespace {

Vec3 relative_velocity(const Context& context, const ContactRecord& c) {
  const SurfaceMotion& s = *context.surfaces[c.surface];
  Vec3 v = context.particles->velocity[c.particle];
  for (int k = 0; k < 3; ++k) v -= c.weights[k] * s.velocity[c.nodes[k]];
  return v;
}

// v_p += J/m_p, v_i −= w_i u_i J. The share of a prescribed node, −w_i J, is the reaction of its support.
void apply_impulse(Context& context, const ContactRecord& c, const Vec3& impulse, bool moves_particle) {
  SurfaceMotion& s = *context.surfaces[c.surface];
  OILSKIN_ASSERT(impulse.allFinite());
  const Vec3 dv = context.particles->inverse_mass[c.particle] * impulse;
  context.particles->velocity[c.particle] += dv;
  if (moves_particle)
    context.set_particle_end(c.particle, context.particles->x_t1[c.particle] + context.dt * dv);
  if (context.particles->inverse_mass[c.particle] == 0) context.report->impulse_on_prescribed += impulse;
  for (int k = 0; k < 3; ++k) {
    if (c.weights[k] == 0) continue;
    const std::uint32_t node = c.nodes[k];
    const Vec3 share = -c.weights[k] * impulse;
    s.velocity[node] += s.inverse_mass[node] * share;
    s.impulse[node] += share;
  }
}

// Inelastic stop: v_n ≥ 0 with λ ≥ 0 accumulated (method A.9.2; Eq. 2 of the paper with the effective mass of
// A.7.2).
void stop(Context& context, Row& row, bool moves_particle) {
  const double vn = relative_velocity(context, row.contact).dot(row.contact.normal);
  const double lambda = std::max(row.normal_impulse - vn / row.k, 0.0);
  const double change = lambda - row.normal_impulse;
  if (change == 0) return;
  OILSKIN_ASSERT(lambda >= 0);
  row.normal_impulse = lambda;
  apply_impulse(context, row.contact, change * row.contact.normal, moves_particle);
}

// Spring repulsion of Bridson et al. 2002 with its cap (Eq. 4 of the paper has none and is unstable).
void spring(Context& context, Row& row) {
  if (!(row.overlap > 0)) return;
  const double vn = relative_velocity(context, row.contact).dot(row.contact.normal);
  const double wanted = (0.1 * row.overlap / context.dt - vn) / row.k;
  const double most = context.settings->stiffness * row.overlap * context.dt;
  const double impulse = std::min(row.spring_impulse + std::max(wanted, 0.0), most);
  const double change = impulse - row.spring_impulse;
  if (change == 0) return;
  OILSKIN_ASSERT(impulse >= 0 && impulse <= most);
  row.spring_impulse = impulse;
  apply_impulse(context, row.contact, change * row.contact.normal, true);
}

// Split repulsion: displaces without adding velocity. Accumulated like an impulse, so that many particles on
// one node remove a tenth of the overlap together, not a tenth each.
void push_apart(Context& context, Row& row) {
  if (!(row.k_position > 0)) return;
  const ContactRecord& c = row.contact;
  SurfaceMotion& s = *context.surfaces[c.surface];
  Vec3 foot = Vec3::Zero();
  for (int k = 0; k < 3; ++k) foot += c.weights[k] * s.x_t1[c.nodes[k]];
  const double gap = c.normal.dot(context.particles->x_t1[c.particle] - foot);
  const double push = std::max(row.push + (row.target_gap - gap) / row.k_position, 0.0);
  const double change = push - row.push;
  if (change == 0) return;
  OILSKIN_ASSERT(push >= 0);
  row.push = push;
  context.set_particle_end(c.particle, context.particles->x_t1[c.particle] +
                                           change * context.particles->inverse_mass[c.particle] * c.normal);
  if (!s.nodes_movable) return;
  for (int k = 0; k < 3; ++k) {
    const double u = s.inverse_mass[c.nodes[k]];
    if (c.weights[k] == 0 || u == 0) continue;
    context.set_node_end(c.surface, c.nodes[k], s.x_t1[c.nodes[k]] - change * c.weights[k] * u * c.normal);
  }
}

void slip(Context& context, Row& row) {
  const SlipModel model = context.surfaces[row.contact.surface]->slip_on(row.contact.back).model;
  if (model == SlipModel::free || (model == SlipModel::viscous_wall && row.wall_area == 0)) return;
  if (!row.slips && !(row.normal_impulse + row.spring_impulse > 0)) return;
  const Vec3 v = relative_velocity(context, row.contact);
  const Vec3 vt = v - v.dot(row.contact.normal) * row.contact.normal;
  const Vec3 impulse = slip_impulse(context, row, vt);
  const Vec3 change = impulse - row.slip_impulse;
  if (change.isZero(0)) return;
  row.slip_impulse = impulse;
  // The particle is ours: what it loses in speed along the sheet it loses in way too.
  apply_impulse(context, row.contact, change, true);
}

// Split repulsion removes a tenth of the overlap in a step.
double target_gap(double distance, double thickness) {
  return distance >= thickness ? thickness : distance + 0.1 * (thickness - distance);
}

}  // namespace

Row row_of_record(const Context& context, const ContactRecord& record) {
  const SurfaceMotion& s = *context.surfaces[record.surface];
  Row row;
  row.contact = record;
  const double h = s.thickness, d0 = record.distance;
  row.overlap = h - d0;
  row.target_gap = target_gap(d0, h);
  row.stops = undercuts_thickness(context, record);
  row.slips = may_slip(context, record);
  row.k_position = row.k = context.particles->inverse_mass[record.particle];
  for (int k = 0; k < 3; ++k)
    row.k += record.weights[k] * record.weights[k] * s.inverse_mass[record.nodes[k]];
  if (s.nodes_movable) row.k_position = row.k;
  OILSKIN_ASSERT(row.k_position >= 0 && row.k >= row.k_position);
  return row;
}

void share_gaps(const Context& context, std::vector<Row>& rows) {
  constexpr double facing = -0.5;  // of the normals' product: within 60° of opposite
  for (std::size_t begin = 0, end = 0; begin < rows.size(); begin = end) {
    while (end < rows.size() && rows[end].contact.particle == rows[begin].contact.particle) ++end;
    for (std::size_t k = begin; k < end; ++k) {
      const ContactRecord& c = rows[k].contact;
      double gap = context.surfaces[c.surface]->thickness;
      for (std::size_t o = begin; o < end; ++o) {
        const ContactRecord& other = rows[o].contact;
        if (c.normal.dot(other.normal) < facing) gap = std::min(gap, 0.5 * (c.distance + other.distance));
      }
      rows[k].target_gap = target_gap(c.distance, gap);
      OILSKIN_ASSERT(rows[k].target_gap >= std::min(c.distance, gap));
    }
  }
}

void solve_rows(Context& context, std::vector<Row>& rows) {
  OILSKIN_ASSERT(context.settings->sweeps >= 1);
  const Repulsion repulsion = context.settings->repulsion;
  const bool split = repulsion == Repulsion::split;
  for (int sweep = 0; sweep < context.settings->sweeps; ++sweep) {
    for (Row& row : rows) {
      if (!(row.k > 0)) continue;  // an immovable particle on prescribed nodes
      if (row.stops) stop(context, row, !split);
      if (row.stops && repulsion == Repulsion::bridson) spring(context, row);
      slip(context, row);
      if (row.stops && split) push_apart(context, row);
    }
  }
}

}  // namespace oilskin::contact
