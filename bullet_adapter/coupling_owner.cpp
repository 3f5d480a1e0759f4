// Messages to the owner of a coupling, and objects that the owner deleted.
#include <algorithm>
#include <sstream>

#include "convert.h"
#include "coupling_impl.h"

namespace oilskin::bullet {

namespace {

std::string left_the_world(const Attachment& a) {
  const char* kind = a.cloth ? "a cloth" : "a collision object";
  std::string text = std::string(kind) + " was detached: it is not in its world, or was deleted";
  if (a.id()) text += " (surface " + std::to_string(a.id().value) + ")";
  return text + "; attach it again if it comes back";
}

}  // namespace

void btFluidCoupling::Impl::note(const std::string& message) {
  add_message(message, &messages);
}

void btFluidCoupling::Impl::note_report(const StepReport& report) {
  if (!report.status.ok()) note(report.status.message);
  for (const std::string& message : report.messages) note(message);
}

void btFluidCoupling::Impl::note_drivers(bool by_solver) {
  if (!by_solver && stepped_by_solver)
    note(
        "btFluidSoftBodySolver couples in each sub-step, and step() was called, too: the fluid runs ahead of "
        "its world");
  stepped_by_solver = by_solver;
}

namespace {

/// The gravity of the first body that the water moves and that has one.
std::optional<Vec3> gravity_of_bodies(const std::vector<Attachment>& attachments) {
  for (const Attachment& a : attachments) {
    const btRigidBody* body = a.takes_impulses ? btRigidBody::upcast(a.object) : nullptr;
    if (body && body->getInvMass() > 0 && !body->getGravity().isZero()) return to_vec3(body->getGravity());
  }
  return {};
}

std::string name_of_body(const Attachment& a) {
  return "surface " + std::to_string(a.id().value) + ", a rigid body, ";
}

}  // namespace

/// Without a cloth the fluid keeps its own gravity. Who has not set it may expect that of the world.
void btFluidCoupling::Impl::note_gravity() {
  const Vec3 usual = WorldSettings().gravity;
  const std::optional<Vec3> of_bodies = gravity_of_bodies(attachments);
  if (!use_cloth_gravity || !of_bodies || (*of_bodies - usual).norm() < 0.05 * usual.norm()) return;
  for (World* w : worlds())
    if (w->settings().gravity == usual) {
      std::ostringstream text;
      text << "the gravity of the fluid is (" << usual.transpose() << ") m/s², that of the bodies ("
           << of_bodies->transpose()
           << "): without a cloth the fluid keeps its own; call btFluid::setGravity()";
      return note(text.str());
    }
}

void btFluidCoupling::Impl::note_bodies() {
  for (const Attachment& a : attachments) {
    if (a.cloth || a.sensor) continue;
    if (!a.takes_impulses) {
      if (!a.object->isStaticOrKinematicObject())
        note(name_of_body(a) +
             "was attached by addCollisionObject() and is dynamic now, so the water does not move it: attach "
             "it by addRigidBody()");
      continue;
    }
    const double jump = static_cast<const RigidBodyHost&>(*a.rigid).unexplained();
    if (jump == 0 || jump <= finest_spacing()) continue;
    std::ostringstream text;
    text << name_of_body(a) << "moved by " << jump
         << " m in a step, which its velocity does not explain: if it was placed there, call resetMotion()";
    note(text.str());
  }
}

/// Does not touch the object.
void btFluidCoupling::Impl::detach_deleted(std::size_t attachment) {
  note(left_the_world(attachments[attachment]));
  detach(attachments[attachment]);
  attachments.erase(attachments.begin() + static_cast<std::ptrdiff_t>(attachment));
}

/// Never looks at an attached object before `present` has it: it may have been deleted.
template <class Objects>
std::vector<char> btFluidCoupling::Impl::present_in(const Objects& present) const {
  std::vector<std::pair<const btCollisionObject*, std::size_t>> sorted;
  for (std::size_t i = 0; i < attachments.size(); ++i) sorted.emplace_back(attachments[i].object, i);
  std::sort(sorted.begin(), sorted.end());
  std::vector<char> is_present(attachments.size(), 0);
  for (int i = 0; i < present.size(); ++i) {
    const btCollisionObject* object = present[i];
    const auto it = std::lower_bound(sorted.begin(), sorted.end(), std::make_pair(object, std::size_t{0}));
    if (it != sorted.end() && it->first == object)
      is_present[it->second] = attachments[it->second].mark->is_on(*object);
  }
  return is_present;
}

template <class Objects>
void btFluidCoupling::Impl::detach_absent(const Objects& present, bool cloth_only) {
  if (attachments.empty()) return;
  const std::vector<char> is_present = present_in(present);
  for (std::size_t i = attachments.size(); i-- > 0;)
    if (!is_present[i] && (attachments[i].cloth || !cloth_only)) detach_deleted(i);
}

void btFluidCoupling::Impl::detach_absent() {
  if (collision_world) detach_absent(collision_world->getCollisionObjectArray(), false);
}

Status btFluidCoupling::Impl::check_between_steps() const {
  if (listening.is_telling)
    return Status::refused("a listener may not save or restore: leave that until the call has returned");
  if (!collision_world) return Status::accepted();
  const std::vector<char> is_present = present_in(collision_world->getCollisionObjectArray());
  const auto absent = std::find(is_present.begin(), is_present.end(), 0);
  if (absent == is_present.end()) return Status::accepted();
  return Status::refused("object " + std::to_string(absent - is_present.begin() + 1) +
                         " is not in its world, or was deleted: remove it from the coupling first");
}

void btFluidCoupling::detachAbsent(const btAlignedObjectArray<btSoftBody*>& bodies) {
  m_impl->detach_absent(bodies, true);
}

void btFluidCoupling::setCollisionWorld(const btCollisionWorld* world) {
  m_impl->collision_world = world;
}

std::vector<std::string> btFluidCoupling::takeMessages() {
  std::vector<std::string> taken;
  taken.swap(m_impl->messages);
  return taken;
}

}  // namespace oilskin::bullet
