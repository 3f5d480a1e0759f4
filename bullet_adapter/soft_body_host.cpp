#include "soft_body_host.h"

#include <BulletSoftBody/btSoftBodySolvers.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "convert.h"
#include "core/inverse_mass.h"
#include "welding.h"

namespace oilskin::bullet {

namespace {

/// 0 if all three are finite, else not a number.
btScalar zero_if_finite(const btVector3& v) {
  return 0 * v.x() + 0 * v.y() + 0 * v.z();
}

bool is_valid(const btSoftBody::Node& n) {
  return zero_if_finite(n.m_x) + zero_if_finite(n.m_v) + 0 * n.m_im == 0 && n.m_im >= 0;
}

/// The owner moves a body whose simulation is disabled, whatever its masses are.
bool is_simulated(const btSoftBody& body) {
  return body.getActivationState() != DISABLE_SIMULATION;
}

/// By a pin, an anchor, or a contact with a collision object in Bullet's last sub-step.
bool is_supported(const btSoftBody& body) {
  if (body.m_anchors.size() > 0 || body.m_rcontacts.size() > 0) return true;
  for (int i = 0; i < body.m_nodes.size(); ++i)
    if (body.m_nodes[i].m_im == 0) return true;
  return false;
}

}  // namespace

Status SoftBodyHost::check() const {
  if (body_->m_faces.size() == 0)
    return Status::refused(
        "soft body has no faces: contact needs triangles; build it with faces "
        "(btSoftBodyHelpers::CreatePatch, "
        "CreateFromTriMesh) or call appendFace()");
  const std::ptrdiff_t nodes = body_->m_nodes.size();
  const btSoftBody::Node* first = nodes > 0 ? &body_->m_nodes[0] : nullptr;
  for (int f = 0; f < body_->m_faces.size(); ++f)
    for (const btSoftBody::Node* n : body_->m_faces[f].m_n)
      if (n < first || n >= first + nodes)
        return Status::refused("face " + std::to_string(f) +
                               " of the soft body refers to a node of another body");
  for (int i = 0; i < body_->m_nodes.size(); ++i)
    if (!is_valid(body_->m_nodes[i]))
      return Status::refused(
          "node " + std::to_string(i) +
          " of the soft body has a position, velocity or inverse mass that is not finite (or a "
          "negative mass): lower Bullet's time step or stiffness");
  return Status::accepted();
}

/// True if faces or nodes differ from those of the last call.
bool SoftBodyHost::read_faces() {
  const auto count = static_cast<std::size_t>(body_->m_faces.size());
  bool differs =
      faces_.size() != count || contact_node_.size() != static_cast<std::size_t>(body_->m_nodes.size());
  faces_.resize(count);
  const btSoftBody::Node* first = &body_->m_nodes[0];
  for (int f = 0; f < body_->m_faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto node = static_cast<std::uint32_t>(body_->m_faces[f].m_n[k] - first);
      std::uint32_t& kept = faces_[static_cast<std::size_t>(f)][k];
      differs |= kept != node;
      kept = node;
    }
  return differs;
}

bool SoftBodyHost::is_prescribed(std::size_t i) const {
  return node(i).m_im == 0 || !is_simulated(*body_);
}

void SoftBodyHost::weld_all() {
  const auto n = static_cast<std::size_t>(body_->m_nodes.size());
  contact_node_.resize(n);
  PointNumbers points;
  for (std::size_t i = 0; i < n; ++i)
    contact_node_[i] = options_.weld ? points.number_of(to_vec3(node(i).m_x)) : static_cast<std::uint32_t>(i);
  contact_nodes_ = options_.weld ? points.size() : n;
  count_copies();
}

void SoftBodyHost::count_copies() {
  copies_.assign(contact_nodes_, 0);
  for (std::uint32_t c : contact_node_) ++copies_[c];
}

/// Pinned copies that are moved apart cannot be one node: all their copies become separate contact nodes
/// permanently. These start at the position of the common node at the start of the interval.
bool SoftBodyHost::split_pins(SurfaceMotion& motion) {
  const std::size_t n = contact_node_.size();
  if (contact_nodes_ == n) return false;
  std::vector<std::size_t> pin(contact_nodes_, n);
  std::vector<std::uint8_t> apart(contact_nodes_, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t c = contact_node_[i];
    if (!is_prescribed(i)) continue;
    if (pin[c] == n) pin[c] = i;
    apart[c] |= to_vec3(node(i).m_x) != to_vec3(node(pin[c]).m_x);
  }
  if (std::count(apart.begin(), apart.end(), 0) == static_cast<std::ptrdiff_t>(contact_nodes_)) return false;
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(contact_nodes_, none);
  const bool has_start = motion.x_t0.size() == contact_nodes_;
  std::vector<Vec3> x_t0;
  std::uint32_t count = 0;
  for (std::uint32_t& c : contact_node_) {
    const std::uint32_t old = c;
    const bool is_new = apart[old] || number[old] == none;
    if (is_new && has_start) x_t0.push_back(motion.x_t0[old]);
    c = is_new ? count++ : number[old];
    if (!apart[old]) number[old] = c;
  }
  if (has_start) motion.x_t0 = std::move(x_t0);
  contact_nodes_ = count;
  count_copies();
  return true;
}

/// A contact node is at its pinned copy if it has one, otherwise at the centre of mass of its copies.
void SoftBodyHost::fill(double dt, SurfaceMotion& motion) {
  motion.x_t1.resize(contact_nodes_);
  motion.velocity.assign(contact_nodes_, Vec3::Zero());
  motion.inverse_mass.assign(contact_nodes_, 0);
  motion.holdable.assign(contact_nodes_, 0);
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  first_copy_.assign(contact_nodes_, none);
  for (std::size_t i = 0; i < contact_node_.size(); ++i) {
    std::uint32_t& first = first_copy_[contact_node_[i]];
    if (first == none || (is_prescribed(i) && !is_prescribed(first))) first = static_cast<std::uint32_t>(i);
  }
  // Relative to the first copy, so that copies at equal positions give exactly that position.
  std::vector<double> mass(contact_nodes_, 0);
  std::vector<Vec3> moment(contact_nodes_, Vec3::Zero());
  for (std::size_t i = 0; i < contact_node_.size(); ++i) {
    const std::uint32_t c = contact_node_[i];
    if (copies_[c] == 1 || is_prescribed(first_copy_[c])) continue;
    const double m = 1 / static_cast<double>(node(i).m_im);
    mass[c] += m;
    moment[c] += m * (to_vec3(node(i).m_x) - to_vec3(node(first_copy_[c]).m_x));
  }
  const std::vector<Vec3> velocity = common_velocities();
  for (std::size_t c = 0; c < contact_nodes_; ++c) {
    const btSoftBody::Node& first = node(first_copy_[c]);
    motion.x_t1[c] = to_vec3(first.m_x);
    if (is_prescribed(first_copy_[c])) {
      motion.velocity[c] = prescribed_velocity(motion, c, dt);
      motion.holdable[c] = options_.may_hold_pins;
      continue;
    }
    const bool welded = copies_[c] > 1;
    if (welded) motion.x_t1[c] = stored(motion.x_t1[c] + moment[c] / mass[c], bt_storage);
    motion.velocity[c] = velocity[c];
    motion.inverse_mass[c] = welded ? 1 / mass[c] : static_cast<double>(first.m_im);
  }
}

/// Mean velocities of the free copies of each contact node, weighted by mass.
std::vector<Vec3> SoftBodyHost::common_velocities() const {
  std::vector<Vec3> velocity(contact_nodes_);
  for (std::size_t c = 0; c < contact_nodes_; ++c) velocity[c] = to_vec3(node(first_copy_[c]).m_v);
  if (contact_nodes_ == contact_node_.size()) return velocity;
  std::vector<double> mass(contact_nodes_, 0);
  std::vector<Vec3> moment(contact_nodes_, Vec3::Zero());
  for (std::size_t i = 0; i < contact_node_.size(); ++i) {
    const std::uint32_t c = contact_node_[i];
    if (copies_[c] == 1 || is_prescribed(first_copy_[c])) continue;
    const double m = 1 / static_cast<double>(node(i).m_im);
    mass[c] += m;
    moment[c] += m * (to_vec3(node(i).m_v) - velocity[c]);
  }
  for (std::size_t c = 0; c < contact_nodes_; ++c)
    if (mass[c] > 0) velocity[c] += moment[c] / mass[c];
  return velocity;
}

/// Bullet's position solver satisfies links whatever the masses are; the solvers of deformable bodies do not.
/// Clusters are moved by impulses.
bool SoftBodyHost::may_add_mass() const {
  const btSoftBodySolver* solver = body_->getSoftBodySolver();
  return carries_water_ && solver && solver->getSolverType() == btSoftBodySolver::DEFAULT_SOLVER &&
         body_->m_clusters.size() == 0 && is_supported(*body_);
}

void SoftBodyHost::add_carried_mass(SurfaceMotion& motion) const {
  const std::vector<double>& carried = motion.carried_mass;
  if (carried.size() != contact_nodes_ || !may_add_mass()) return;
  const auto is_carried = [&](std::size_t c) { return motion.inverse_mass[c] > 0 && carried[c] > 0; };
  for (std::size_t c = 0; c < contact_nodes_; ++c) {
    if (!is_carried(c)) continue;
    if (motion.added_mass.empty()) motion.added_mass.assign(contact_nodes_, 0);
    motion.added_mass[c] = carried[c];
    motion.inverse_mass[c] = 1 / (1 / motion.inverse_mass[c] + carried[c]);
  }
}

/// Sets the inverse mass of a node with liquid. True if it changed. A node whose inverse mass is not the one
/// that was set here has got a new mass from its owner, or is new.
bool SoftBodyHost::weigh_node(std::size_t i, double absorbed) {
  btScalar& inverse_mass = node(i).m_im;
  if (inverse_mass == 0) return false;  // pinned: weighed again when it is freed
  if (inverse_mass != weighed_[i]) dry_mass_[i] = 1 / static_cast<double>(inverse_mass);
  const auto wet = static_cast<btScalar>(1 / (dry_mass_[i] + absorbed));
  const bool changes = wet != inverse_mass;
  inverse_mass = weighed_[i] = wet;
  return changes;
}

/// Not setMass(), which makes the stretched shape the rest shape.
void SoftBodyHost::weigh_nodes(const std::vector<double>& absorbed) {
  const std::size_t n = contact_node_.size();
  const bool is_dry = absorbed.size() != contact_nodes_;
  if (is_dry && weighed_.empty()) return;
  weighed_.resize(n, btScalar(-1));
  dry_mass_.resize(n, 0);
  bool any = false;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t c = contact_node_[i];
    any |= weigh_node(i, is_dry ? 0 : absorbed[c] / copies_[c]);
  }
  if (any) body_->updateLinkConstants();
}

std::vector<bool> SoftBodyHost::wet_nodes(Span<const double> absorbed) const {
  std::vector<bool> wet;
  if (absorbed.size() != contact_nodes_) return wet;
  for (std::uint32_t c : contact_node_) wet.push_back(absorbed[c] > 0);
  return wet;
}

void SoftBodyHost::give_back_absorbed_mass() {
  if (static_cast<std::size_t>(body_->m_nodes.size()) == contact_node_.size()) weigh_nodes({});
  weighed_.clear();
}

Gathered SoftBodyHost::gather(double dt, SurfaceMotion& motion) {
  Gathered result;
  result.status = check();
  if (!result.status.ok()) return result;
  bool teleported = forget_motion_;
  if (read_faces()) {
    weld_all();
    result.new_surface = teleported = true;
  } else {
    result.new_surface = split_pins(motion);
  }
  const auto contact_triangle = [&](const Triangle& face) {
    return Triangle{contact_node_[face[0]], contact_node_[face[1]], contact_node_[face[2]]};
  };
  const auto is_given = [&](const Triangle& t, const Triangle& face) {
    const Triangle given = contact_triangle(face);
    return t[0] == given[0] && t[1] == given[1] && t[2] == given[2];
  };
  if (result.new_surface ||
      !std::equal(motion.triangles.begin(), motion.triangles.end(), faces_.begin(), faces_.end(), is_given)) {
    if (!result.new_surface) teleported = true;  // another motion was given the change, or it is the first
    result.new_surface = true;
    motion.storage = bt_storage;
    motion.nodes_movable = false;  // Bullet's position solver turns moved nodes into velocity
    motion.triangles.resize(faces_.size());
    std::transform(faces_.begin(), faces_.end(), motion.triangles.begin(), contact_triangle);
  }
  if (!result.new_surface) weigh_nodes(motion.absorbed_mass);  // also those that the owner freed
  fill(teleported ? 0 : dt, motion);
  if (!teleported) add_carried_mass(motion);
  forget_motion_ = false;
  return result;
}

/// Adds impulses to velocities; sets positions only of nodes that contact moved and of copies. True if
/// contact moved the node.
bool SoftBodyHost::scatter_node(std::size_t i, const Vec3& velocity, const SurfaceMotion& motion) {
  btSoftBody::Node& n = node(i);
  const std::uint32_t c = contact_node_[i];
  const bool moved = motion.moved[c] != 0, welded = copies_[c] > 1;
  if (motion.inverse_mass[c] > 0) {
    if (welded || !motion.impulse[c].isZero(0))
      n.m_v = to_bt(velocity + motion.inverse_mass[c] * motion.impulse[c]);
  } else if (moved && motion.holdable[c]) {
    // Bullet integrates nodes of mass 0, too: a velocity would move the pin away.
    n.m_v = btVector3(0, 0, 0);
  } else if (!is_prescribed(i)) {
    n.m_v = to_bt(motion.velocity[c]);  // a free copy of a pin
  } else {
    return false;
  }
  n.m_vn = n.m_v;  // the implicit deformable solver starts from it
  if (moved || welded) n.m_x = to_bt(motion.x_t1[c]);
  return moved;
}

void SoftBodyHost::scatter(SurfaceMotion& motion) {
  const std::size_t n = contact_node_.size();
  node_impulse_.assign(n, Vec3::Zero());
  if (static_cast<std::size_t>(body_->m_nodes.size()) != n || motion.impulse.size() != contact_nodes_ ||
      motion.moved.size() != contact_nodes_)
    return;  // the body changed since gather: the next gather reports a new surface
  const std::vector<Vec3> velocity = common_velocities();
  bool any_moved = false, any_impulse = false;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t c = contact_node_[i];
    any_moved |= scatter_node(i, velocity[c], motion);
    const double fraction = motion.inverse_mass[c] > 0 && copies_[c] > 1
                                ? 1 / (own_mass(motion, c) * static_cast<double>(node(i).m_im))
                                : 1.0 / copies_[c];
    node_impulse_[i] = fraction * motion.impulse[c];
    any_impulse |= motion.inverse_mass[c] > 0 && !motion.impulse[c].isZero(0);
  }
  weigh_nodes(motion.absorbed_mass);
  if (any_impulse && !body_->isActive()) body_->activate();
  if (any_moved) {
    body_->updateBounds();
    if (update_normals_) body_->updateNormals();
  }
  for (std::size_t i = 0; i < n; ++i) motion.x_t1[contact_node_[i]] = to_vec3(node(i).m_x);
}

SoftBodyHost::State SoftBodyHost::state() const {
  return {forget_motion_, contact_node_, contact_nodes_, node_impulse_, dry_mass_, weighed_};
}

Status SoftBodyHost::check(const State& state) const {
  const auto nodes = static_cast<std::size_t>(body_->m_nodes.size());
  const auto has = [nodes](std::size_t size) { return size == nodes || size == 0; };
  bool valid = has(state.contact_node.size()) && has(state.node_impulse.size()) &&
               has(state.dry_mass.size()) && state.weighed.size() == state.dry_mass.size();
  std::vector<char> found(valid && state.contact_nodes <= nodes ? state.contact_nodes : 0, 0);
  for (std::uint32_t c : state.contact_node) {
    valid = valid && c < found.size();
    if (valid) found[c] = 1;
  }
  valid =
      valid && std::count(found.begin(), found.end(), 1) == static_cast<std::ptrdiff_t>(state.contact_nodes);
  return valid ? Status::accepted() : Status::refused("has other nodes than the saved cloth");
}

void SoftBodyHost::set_state(State state) {
  read_faces();
  forget_motion_ = state.forget_motion;
  contact_node_ = std::move(state.contact_node);
  contact_nodes_ = static_cast<std::size_t>(state.contact_nodes);
  count_copies();
  node_impulse_ = std::move(state.node_impulse);
  dry_mass_ = std::move(state.dry_mass);
  weighed_ = std::move(state.weighed);
}

}  // namespace oilskin::bullet
