#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>
#include <BulletSoftBody/btSoftBodySolvers.h>

#include <algorithm>

#include "bullet_archive.h"
#include "object_state.h"

namespace oilskin::bullet {

namespace {

// The fields of elements that steps change and read. With one element: f(field); with two: f(to, from).

template <class F, class... E>
void each_node_field(const F& f, E&... e) {
  f(e.m_x...), f(e.m_q...), f(e.m_v...), f(e.m_vn...), f(e.m_f...), f(e.m_n...), f(e.m_splitv...);
  f(e.m_im...), f(e.m_area...), f(e.m_constrained...);
}

template <class F, class... E>
void each_link_field(const F& f, E&... e) {
  f(e.m_c3...), f(e.m_rl...), f(e.m_c0...), f(e.m_c1...);
}

template <class F, class... E>
void each_face_field(const F& f, E&... e) {
  f(e.m_normal...), f(e.m_ra...);
}

template <class F, class... S>
void each_solver_field(const F& f, S&... s) {
  f(s.sdt...), f(s.isdt...), f(s.velmrg...), f(s.radmrg...), f(s.updmrg...);
}

const auto assign = [](auto& to, const auto& from) { to = from; };

template <class Elements, class Nodes>
void number_nodes(const Elements& elements, const Nodes& nodes, int per_element, std::vector<int>& numbers) {
  for (int i = 0; i < elements.size(); ++i)
    for (int k = 0; k < per_element; ++k) numbers.push_back(static_cast<int>(elements[i].m_n[k] - &nodes[0]));
}

SoftState::Mesh mesh_of(const btSoftBody& body) {
  SoftState::Mesh mesh;
  mesh.nodes = {body.m_nodes.size()};
  if (body.m_nodes.size() == 0) return mesh;
  number_nodes(body.m_links, body.m_nodes, 2, mesh.links);
  number_nodes(body.m_faces, body.m_nodes, 3, mesh.faces);
  for (int i = 0; i < body.m_anchors.size(); ++i)
    mesh.anchors.push_back(static_cast<int>(body.m_anchors[i].m_node - &body.m_nodes[0]));
  return mesh;
}

template <class Element>
LeafNumber numbering(const btAlignedObjectArray<Element>& elements) {
  return [&](const void* datum) {
    return elements.size() == 0 ? -1 : static_cast<const Element*>(datum) - &elements[0];
  };
}

template <class Element>
LeafPlaces places_in(btAlignedObjectArray<Element>& elements) {
  return [&](std::size_t i) {
    Element& element = elements[static_cast<int>(i)];
    return LeafPlace{&element, &element.m_leaf};
  };
}

std::size_t count_of(const std::vector<int>& numbers, std::size_t per_element) {
  return numbers.size() / per_element;
}

}  // namespace

Status is_restorable(const btSoftBody& body) {
  const btSoftBodySolver* solver = body.m_softBodySolver;
  if (body.m_clusters.size() > 0 || body.m_joints.size() > 0)
    return Status::refused("is a soft body with clusters or joints, whose state cannot be saved");
  if (body.m_reducedModel || body.m_deformableAnchors.size() > 0 ||
      (solver && solver->getSolverType() != btSoftBodySolver::DEFAULT_SOLVER))
    return Status::refused("is a body of Bullet's deformable solver, whose state cannot be saved");
  return Status::accepted();
}

Status SoftState::capture(const btSoftBody& body) {
  if (Status s = is_restorable(body); !s.ok()) return s;
  mesh = mesh_of(body);
  nodes.resize(static_cast<std::size_t>(body.m_nodes.size()));
  links.resize(static_cast<std::size_t>(body.m_links.size()));
  faces.resize(static_cast<std::size_t>(body.m_faces.size()));
  for (int i = 0; i < body.m_nodes.size(); ++i)
    each_node_field(assign, nodes[static_cast<std::size_t>(i)], body.m_nodes[i]);
  for (int i = 0; i < body.m_links.size(); ++i)
    each_link_field(assign, links[static_cast<std::size_t>(i)], body.m_links[i]);
  for (int i = 0; i < body.m_faces.size(); ++i)
    each_face_field(assign, faces[static_cast<std::size_t>(i)], body.m_faces[i]);
  each_solver_field(assign, solver, body.m_sst);
  capture_pose(body.m_pose);
  time = body.m_timeacc;
  rest_length_scale = body.m_restLengthScale;
  bounds[0] = body.m_bounds[0], bounds[1] = body.m_bounds[1];
  updates_constants = body.m_bUpdateRtCst;
  Status status = bullet::capture(body.m_ndbvt, nodes.size(), numbering(body.m_nodes), node_tree);
  if (status.ok()) status = bullet::capture(body.m_fdbvt, faces.size(), numbering(body.m_faces), face_tree);
  return status;
}

void SoftState::capture_pose(const btSoftBody::Pose& pose) {
  has_volume = pose.m_bvolume;
  has_frame = pose.m_bframe;
  volume = pose.m_volume;
  if (!has_frame) return;
  center = pose.m_com;
  rotation = pose.m_rot, scale = pose.m_scl, base_scale = pose.m_aqq;
  for (int i = 0; i < pose.m_pos.size(); ++i) positions.push_back(pose.m_pos[i]);
  for (int i = 0; i < pose.m_wgh.size(); ++i) weights.push_back(pose.m_wgh[i]);
}

void SoftState::visit_elements(Archive& archive) {
  archive.values(mesh.nodes, mesh.links, mesh.faces, mesh.anchors);
  const auto visit_field = [&](auto& field) { bullet::visit(archive, field); };
  archive.list(nodes, 23 * sizeof(btScalar), [&](btSoftBody::Node& n) { each_node_field(visit_field, n); });
  archive.list(links, 6 * sizeof(btScalar), [&](btSoftBody::Link& l) { each_link_field(visit_field, l); });
  archive.list(faces, 4 * sizeof(btScalar), [&](btSoftBody::Face& f) { each_face_field(visit_field, f); });
  each_solver_field(visit_field, solver);
  archive.require(mesh.nodes.size() == 1 && static_cast<std::size_t>(mesh.nodes[0]) == nodes.size() &&
                      count_of(mesh.links, 2) == links.size() && count_of(mesh.faces, 3) == faces.size(),
                  "the number of elements of a soft body");
  for (const btSoftBody::Node& node : nodes) archive.require(node.m_im >= 0, "the mass of a node");
}

void SoftState::visit_pose(Archive& archive) {
  archive.values(has_volume, has_frame);
  bullet::visit(archive, volume);
  if (!has_frame) return;
  bullet::visit(archive, center);
  bullet::visit(archive, rotation);
  // Bullet makes them from the inverse of a matrix that is singular where the body is flat.
  for (btMatrix3x3* m : {&scale, &base_scale})
    for (int row = 0; row < 3; ++row)
      for (int i = 0; i < 3; ++i) archive.value((*m)[row][i]);
  archive.list(positions, 3 * sizeof(btScalar), [&](btVector3& x) { bullet::visit(archive, x); });
  archive.list(weights, sizeof(btScalar), [&](btScalar& w) { bullet::visit(archive, w); });
  archive.require(positions.size() == nodes.size() && weights.size() == nodes.size(),
                  "the pose of a soft body");
}

void SoftState::visit(Archive& archive) {
  visit_elements(archive);
  visit_pose(archive);
  for (btScalar* x : {&time, &rest_length_scale}) bullet::visit(archive, *x);
  for (btVector3& x : bounds) bullet::visit(archive, x);
  archive.value(updates_constants);
  bullet::visit(archive, node_tree, nodes.size());
  bullet::visit(archive, face_tree, faces.size());
}

Status SoftState::check(const btSoftBody& body) const {
  if (Status s = is_restorable(body); !s.ok()) return s;
  const Mesh here = mesh_of(body);
  const auto compare = [](const char* what, const std::vector<int>& saved, const std::vector<int>& present) {
    return saved == present ? Status::accepted()
                            : Status::refused("has other " + std::string(what) + " than the saved cloth");
  };
  if (here.nodes != mesh.nodes)
    return Status::refused("has " + std::to_string(here.nodes[0]) + " nodes, the saved cloth " +
                           std::to_string(mesh.nodes[0]));
  Status status = compare("links", mesh.links, here.links);
  if (status.ok()) status = compare("faces", mesh.faces, here.faces);
  if (status.ok()) status = compare("anchors", mesh.anchors, here.anchors);
  return status;
}

void SoftState::apply_pose(btSoftBody::Pose& pose) const {
  pose.m_bvolume = has_volume;
  pose.m_bframe = has_frame;
  pose.m_volume = volume;
  if (!has_frame) return;
  pose.m_com = center;
  pose.m_rot = rotation, pose.m_scl = scale, pose.m_aqq = base_scale;
  pose.m_pos.resize(static_cast<int>(positions.size()));
  pose.m_wgh.resize(static_cast<int>(weights.size()));
  std::copy(positions.begin(), positions.end(), &pose.m_pos[0]);
  std::copy(weights.begin(), weights.end(), &pose.m_wgh[0]);
}

void SoftState::apply(btSoftBody& body) const {
  for (int i = 0; i < body.m_nodes.size(); ++i)
    each_node_field(assign, body.m_nodes[i], nodes[static_cast<std::size_t>(i)]);
  for (int i = 0; i < body.m_links.size(); ++i)
    each_link_field(assign, body.m_links[i], links[static_cast<std::size_t>(i)]);
  for (int i = 0; i < body.m_faces.size(); ++i)
    each_face_field(assign, body.m_faces[i], faces[static_cast<std::size_t>(i)]);
  each_solver_field(assign, body.m_sst, solver);
  apply_pose(body.m_pose);
  body.m_timeacc = time;
  body.m_restLengthScale = rest_length_scale;
  body.m_bounds[0] = bounds[0], body.m_bounds[1] = bounds[1];
  body.m_bUpdateRtCst = updates_constants;
  body.m_rcontacts.clear();  // Bullet finds them again
  body.m_scontacts.clear();
  bullet::apply(node_tree, body.m_ndbvt, places_in(body.m_nodes));
  bullet::apply(face_tree, body.m_fdbvt, places_in(body.m_faces));
  if (body.getBroadphaseHandle())
    body.m_worldInfo->m_broadphase->setAabb(body.getBroadphaseHandle(), bounds[0], bounds[1],
                                            body.m_worldInfo->m_dispatcher);
}

}  // namespace oilskin::bullet
