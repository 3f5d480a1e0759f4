/// Moving a world, surfaces included, without a motion.
#include "core/inverse_mass.h"
#include "core/refuse.h"
#include "world/numeric_range.h"
#include "world/world_impl.h"

namespace oilskin {

namespace world {

namespace {

/// Are all nodes within rounding of `from` + `offset`?
bool are_at(const std::vector<Vec3>& nodes, const std::vector<Vec3>& from, const Vec3& offset,
            double rounding) {
  if (nodes.size() != from.size()) return false;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if ((nodes[i] - from[i] - offset).cwiseAbs().maxCoeff() > rounding) return false;
  return true;
}

/// The surface as its host has it now; a refusal says why it cannot be moved.
Status find_moved(const Attachment& a, const Vec3& offset, const Box& kill_box, std::size_t number,
                  SurfaceMotion& moved, bool& is_new) {
  moved = a.motion;
  moved.still = moved.revision = 0;
  moved.added_mass.clear();
  const Gathered gathered = a.host->gather(0, moved);
  if (!gathered.status.ok()) return gathered.status;
  const double r = kill_box.min.cwiseAbs().cwiseMax(kill_box.max.cwiseAbs()).maxCoeff();
  const double needed = minimum_separation(moved.thickness, r, moved.storage);
  if (moved.thickness < 4 * needed)
    return refuse("surface ", number + 1, " is ", moved.thickness, " m thick, below 4 δ = ", 4 * needed,
                  " m, which ", moved.storage == Storage::float32 ? "single" : "double",
                  "-precision positions need where the kill box would be");
  moved.delta = std::max(moved.delta, needed);
  const double rounding = 16 * epsilon_of(moved.storage) * (r + offset.cwiseAbs().maxCoeff());
  const bool has_moved = gathered.new_surface || offset.cwiseAbs().maxCoeff() <= rounding ||
                         !are_at(moved.x_t1, a.motion.x_t1, Vec3::Zero(), rounding);
  if (!has_moved) return refuse("surface ", number + 1, " was not moved: move what the hosts read first");
  // What moved on its own meanwhile goes on from where it was.
  if (!gathered.new_surface && are_at(moved.x_t1, a.motion.x_t1, offset, rounding)) return {};
  is_new = gathered.new_surface;
  moved.x_t1 = a.motion.x_t1;
  for (Vec3& x : moved.x_t1) x = stored(x + offset, moved.storage);
  if (moved.body && a.motion.body) moved.body->center_t1 = a.motion.body->center_t1 + offset;
  return {};
}

}  // namespace

Status Attachments::translate(const Vec3& offset, const Box& kill_box) {
  std::vector<SurfaceMotion> moved(list_.size());
  std::vector<char> is_new(list_.size(), 0);
  for (std::size_t k = 0; k < list_.size(); ++k)
    if (!list_[k]->refused) {
      bool is_new_surface = false;
      if (Status s = find_moved(*list_[k], offset, kill_box, k, moved[k], is_new_surface); !s.ok()) return s;
      is_new[k] = is_new_surface;
    }
  for (std::size_t k = 0; k < list_.size(); ++k) {
    Attachment& a = *list_[k];
    if (a.refused) continue;
    SurfaceMotion& m = a.motion;
    for (Vec3& x : m.x_t0) x = stored(x + offset, m.storage);
    m.x_t1.swap(moved[k].x_t1);
    m.delta = moved[k].delta;
    m.still = m.revision = 0;
    m.angular_impulse += offset.cross(load_of(m).impulse);
    if (m.body) {
      m.body->center_t0 += offset;
      m.body->center_t1 = moved[k].body ? moved[k].body->center_t1 : Vec3(m.body->center_t1 + offset);
    }
    // The mesh is the same, and its tree is refitted.
    if (is_new[k])
      a.geometry = {};
    else
      a.geometry.fitted_still = 0;
    a.teleported = a.teleported || is_new[k];
    a.is_new = true;  // rounding may have brought particles closer than δ
  }
  return {};
}

namespace {

/// Along each axis, what of a surface gravity moves [kg].
Vec3 free_mass(const SurfaceMotion& m) {
  Vec3 mass = Vec3::Zero();
  if (m.body) {
    for (int k = 0; k < 3; ++k)
      if (m.body->inverse_mass[k] > 0) mass[k] = 1 / m.body->inverse_mass[k];
    return mass;
  }
  for (std::size_t j = 0; j < m.x_t1.size(); ++j)
    if (m.inverse_mass[j] > 0) mass += Vec3::Constant(own_mass(m, j));
  return mass;
}

}  // namespace

/// Potentials are relative to the origin: what is somewhere else has brought the difference.
void EnergyState::translate(const Vec3& offset, const Vec3& water_mass, const Vec3& node_mass,
                            double withdrawn_mass) {
  const Vec3 water_moment = (water_mass + Vec3::Constant(withdrawn_mass)).cwiseProduct(offset);
  const Vec3 node_moment = node_mass.cwiseProduct(offset);
  water.moment += water_moment;
  nodes.moment += node_moment;
  withdrawn.moment += withdrawn_mass * offset;
  report.water_potential -= gravity.dot(water_moment);
  report.node_potential -= gravity.dot(node_moment);
  report.entered_potential -= gravity.dot(water_moment + node_moment);
  max_specific -= gravity.dot(offset);
}

}  // namespace world

Status World::Impl::translate(const Vec3& offset) {
  WorldSettings moved = settings;
  moved.kill_box = {settings.kill_box.min + offset, settings.kill_box.max + offset};
  if (Status s = moved.validate(); !s.ok()) return s;
  if (!world::is_in_range(moved.kill_box.min) || !world::is_in_range(moved.kill_box.max))
    return Status::refused("the kill box would lie beyond the range of numbers");
  Vec3 node_mass = Vec3::Zero();
  for (const auto& a : attachments.all())
    if (!a->refused) node_mass += world::free_mass(a->motion);
  if (Status s = attachments.translate(offset, moved.kill_box); !s.ok()) return s;
  double ratio = 0;
  for (std::size_t i = 0; i < state.particles.size(); ++i)
    if (state.particles.id[i] < state.energy.first_new_id) ratio += state.particles.relative_mass(i);
  const double mass = fluid->particle_mass();
  state.energy.translate(offset, Vec3::Constant(ratio * mass), node_mass, state.withdrawn.mass_ratio * mass);
  for (Vec3& x : state.particles.position) x += offset;
  emission->translate(offset);
  state.sinks.translate(offset);
  effects.translate(offset);
  settings = moved;
  return {};
}

Status World::translate(const Vec3& offset) {
  if (!impl_->status.ok()) return impl_->status;
  if (!offset.allFinite()) return Status::refused("the offset of a translation must be finite");
  return offset.isZero(0) ? Status() : impl_->translate(offset);
}

}  // namespace oilskin
