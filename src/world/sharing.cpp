#include "world/sharing.h"

#include <algorithm>
#include <functional>

#include "core/assert.h"
#include "core/refuse.h"

namespace oilskin::world {

namespace {

/// What the host of an original gave it, for a copy. Another start than the copy's last end is a teleport:
/// its world was stepped alone, or the original's was.
Gathered read_original(const Attachment& original, Attachment& copy) {
  const SurfaceMotion& from = original.motion;
  SurfaceMotion& to = copy.motion;
  Gathered result;
  if (original.refused) {
    result.status = refuse("an earlier world of the step has refused it");
    return result;
  }
  result.new_surface = original.sharing.mesh_changed || from.triangles != to.triangles;
  copy.teleported |= original.sharing.teleported;
  if (!result.new_surface && !copy.teleported && from.still != 0 && to.still != 0 &&
      from.revision == to.revision) {
    result.unchanged = true;
    return result;
  }
  copy.teleported |= from.x_t0 != to.x_t0;
  if (result.new_surface) to.triangles = from.triangles;
  to.x_t0 = from.x_t0;
  to.storage = from.storage;
  to.nodes_movable = from.nodes_movable;
  to.x_t1 = from.x_t1;
  to.velocity = from.velocity;
  to.inverse_mass = from.inverse_mass;
  to.holdable = from.holdable;
  to.added_mass = from.added_mass;
  to.body = from.body;
  to.revision = from.revision;
  return result;
}

/// A host weighs the liquids of all worlds, and carries the most that one of them asks for: while it is
/// called, the motion of an original has these.
class LiquidsOfAll {
 public:
  explicit LiquidsOfAll(Attachment& original) : motion_(original.motion) {
    if (original.sharing.copies.empty()) return;
    absorbed_ = motion_.absorbed_mass;
    carried_ = motion_.carried_mass;
    for (const Attachment* copy : original.sharing.copies) {
      combine(copy->motion.absorbed_mass, motion_.absorbed_mass, std::plus<>());
      combine(copy->motion.carried_mass, motion_.carried_mass,
              [](double a, double b) { return std::max(a, b); });
    }
    is_combined_ = true;
  }
  ~LiquidsOfAll() {
    if (!is_combined_) return;
    motion_.absorbed_mass.swap(absorbed_);
    motion_.carried_mass.swap(carried_);
  }
  LiquidsOfAll(const LiquidsOfAll&) = delete;
  LiquidsOfAll& operator=(const LiquidsOfAll&) = delete;

 private:
  template <class F>
  void combine(const std::vector<double>& of_copy, std::vector<double>& of_all, F f) const {
    if (of_copy.size() != motion_.x_t0.size()) return;
    of_all.resize(of_copy.size(), 0);
    for (std::size_t i = 0; i < of_copy.size(); ++i) of_all[i] = f(of_all[i], of_copy[i]);
  }

  SurfaceMotion& motion_;
  std::vector<double> absorbed_, carried_;
  bool is_combined_ = false;
};

/// At least 4 δ. Where δ has grown, particles near the surface are relocated.
void take_thickness(Attachment& a) {
  SurfaceMotion& m = a.motion;
  const double least = 4 * minimum_separation(0, a.sharing.reach, m.storage);
  a.sharing.thickness = m.thickness = std::max(a.sharing.thickness, least);
  const double delta = minimum_separation(m.thickness, a.sharing.reach, m.storage);
  if (delta > m.delta) a.is_new = true;
  m.delta = delta;
}

void copy_end(const SurfaceMotion& original, SurfaceMotion& copy) {
  OILSKIN_ASSERT(original.x_t1.size() == copy.x_t1.size() && (original.still != 0) == (copy.still != 0));
  if (original.still == 0 || copy.impulse.size() != original.impulse.size()) {
    copy.impulse = original.impulse;
    copy.moved = original.moved;
  } else {
    for (std::uint32_t node : copy.touched) copy.impulse[node].setZero();
    for (std::uint32_t node : original.touched) copy.impulse[node] = original.impulse[node];
    for (std::uint32_t node : copy.touched) copy.moved[node] = 0;
    for (std::uint32_t node : original.touched) copy.moved[node] = original.moved[node];
  }
  copy.angular_impulse = original.angular_impulse;
  copy.touched = original.touched;
  if (original.still != 0) return;
  copy.x_t1 = original.x_t1;
  copy.velocity = original.velocity;
  copy.body = original.body;
}

}  // namespace

Gathered read_host(Attachment& a, double dt) {
  if (a.sharing.original) return read_original(*a.sharing.original, a);
  const LiquidsOfAll liquids(a);
  return a.host->gather(dt, a.motion);
}

void write_host(Attachment& original) {
  const LiquidsOfAll liquids(original);
  original.host->scatter(original.motion);
}

void share_thickness(Attachment& original, double reach) {
  if (original.sharing.copies.empty()) return;
  double thickness = *original.settings.thickness;
  for (const Attachment* copy : original.sharing.copies)
    thickness = std::min(thickness, *copy->settings.thickness);
  for_all_of(original, [&](Attachment& a) {
    a.sharing.thickness = thickness;
    a.sharing.reach = reach;
    if (!a.refused) take_thickness(a);
  });
}

void copy_end(Attachment& original) {
  for (Attachment* copy : original.sharing.copies)
    if (!copy->refused) copy_end(original.motion, copy->motion);
}

}  // namespace oilskin::world
