#include "hosts/bullet_body.h"

#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>

#include "scene/cloth_model.h"
#include "scene/fields.h"
#include "scene/tank.h"

namespace oilskin::demo {
namespace {

/// Its origin is the centre of mass, all boxes having one density. Overlaps count twice.
void make_compound(const CompoundShape& compound, BulletBody& made) {
  auto shape = std::make_unique<btCompoundShape>();
  Vec3 moment = Vec3::Zero();
  for (const BoxShape& box : compound.boxes) {
    made.volume += box.volume();
    moment += box.volume() * box.center;
  }
  made.origin = moment / made.volume;
  for (const BoxShape& box : compound.boxes) {
    made.parts.push_back(std::make_unique<btBoxShape>(to_bullet(box.half_extents)));
    const btTransform place(to_bullet(box.rotate), to_bullet(Vec3(box.center - made.origin)));
    shape->addChildShape(place, made.parts.back().get());
  }
  made.shape = std::move(shape);
}

/// Calls use(a, b, c) for the triangles of a hull, outwards.
template <class Use>
void for_each_triangle(const btConvexHullComputer& hull, Use use) {
  for (int f = 0; f < hull.faces.size(); ++f) {
    const btConvexHullComputer::Edge* first = &hull.edges[hull.faces[f]];
    const Vec3 a = from_bullet(hull.vertices[first->getSourceVertex()]);
    for (const auto* edge = first->getNextEdgeOfFace(); edge->getTargetVertex() != first->getSourceVertex();
         edge = edge->getNextEdgeOfFace())
      use(a, from_bullet(hull.vertices[edge->getSourceVertex()]),
          from_bullet(hull.vertices[edge->getTargetVertex()]));
  }
}

/// Its origin is the centre of mass.
void make_hull(const Mesh& mesh, BulletBody& made) {
  std::vector<btVector3> points;
  points.reserve(mesh.vertices.size());
  for (const Vec3& x : mesh.vertices) points.push_back(to_bullet(x));
  btConvexHullComputer hull;
  hull.compute(&points[0].x(), int(sizeof(btVector3)), int(points.size()), 0, 0);
  Vec3 moment = Vec3::Zero();
  const Vec3 middle = from_bullet(hull.vertices[0]);
  double volume = 0;
  for_each_triangle(hull, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const double part = (a - middle).dot((b - middle).cross(c - middle)) / 6;
    volume += part;
    moment += part * (a + b + c + middle) / 4;
  });
  made.volume = std::abs(volume);
  if (!(made.volume > 0)) return;
  made.origin = moment / volume;
  auto shape = std::make_unique<btConvexHullShape>();
  for (int k = 0; k < hull.vertices.size(); ++k)
    shape->addPoint(hull.vertices[k] - to_bullet(made.origin), false);
  shape->recalcLocalAabb();
  made.shape = std::move(shape);
}

void make_mesh(const Mesh& mesh, BulletBody& made) {
  made.mesh = std::make_unique<btTriangleMesh>(true, false);
  for (const Triangle& t : mesh.triangles)
    made.mesh->addTriangle(to_bullet(mesh.vertices[t[0]]), to_bullet(mesh.vertices[t[1]]),
                           to_bullet(mesh.vertices[t[2]]));
  made.shape = std::make_unique<btBvhTriangleMeshShape>(made.mesh.get(), true);
}

BulletBody make_shape(const Body& body) {
  BulletBody made;
  if (const auto* box = std::get_if<BoxShape>(&body.shape)) {
    made.shape = std::make_unique<btBoxShape>(to_bullet(box->half_extents));
    made.origin = box->center;
    made.turned = to_bullet(box->rotate);
    made.volume = box->volume();
  } else if (const auto* sphere = std::get_if<SphereShape>(&body.shape)) {
    made.shape = std::make_unique<btSphereShape>(btScalar(sphere->radius));
    made.origin = sphere->center;
    made.volume = 4. / 3 * SIMD_PI * std::pow(sphere->radius, 3);
  } else if (const auto* plane = std::get_if<PlaneShape>(&body.shape)) {
    const Vec3 n = plane->normal.normalized();
    made.shape = std::make_unique<btStaticPlaneShape>(to_bullet(n), btScalar(n.dot(plane->point)));
  } else if (const auto* compound = std::get_if<CompoundShape>(&body.shape)) {
    make_compound(*compound, made);
  } else if (const auto* tank = std::get_if<TankShape>(&body.shape)) {
    make_mesh(tank_mesh(*tank), made);
  } else if (body.is_dynamic()) {
    make_hull(std::get<PlacedMesh>(body.shape).mesh, made);
  } else {
    make_mesh(std::get<PlacedMesh>(body.shape).mesh, made);
  }
  return made;
}

/// Makes the rigid body of a shape. A mass of 0: static or, where it `moves`, kinematic.
void make_rigid(double margin, double mass, bool moves, BulletBody& made) {
  made.shape->setMargin(btScalar(margin));
  for (const auto& part : made.parts) part->setMargin(btScalar(margin));
  btVector3 inertia(0, 0, 0);
  if (mass > 0) made.shape->calculateLocalInertia(btScalar(mass), inertia);
  btRigidBody::btRigidBodyConstructionInfo info(btScalar(mass), nullptr, made.shape.get(), inertia);
  info.m_startWorldTransform = btTransform(made.turned, to_bullet(made.origin));
  made.body = std::make_unique<btRigidBody>(info);
  if (moves) made.body->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  if (moves || mass > 0) made.body->setActivationState(DISABLE_DEACTIVATION);
}

/// Of the boxes that cloth collides with in place of the faces of a tank [m]. Bullet's collision of soft
/// bodies with triangle meshes makes each triangle 6 cm thick on both sides and throws cloth out of it.
double wall_thickness(const TankShape& tank) {
  constexpr double most = 0.05;
  return std::min(most, 0.5 * (tank.inside.max - tank.inside.min).minCoeff());
}

template <class Use>
void for_each_body(BulletBody& body, Use use) {
  use(body);
  if (body.for_cloth) use(*body.for_cloth);
}

}  // namespace

BulletBody make_body(const Body& settings, const std::string& key) {
  BulletBody made = make_shape(settings);
  if (!made.shape) throw SceneError(key + ".mesh: its convex hull has no volume, so that it cannot float");
  const double margin = std::min(cloth_margin, *settings.surface.thickness);
  make_rigid(margin, settings.mass_with(made.volume), settings.motion.moves(), made);
  if (const auto* tank = std::get_if<TankShape>(&settings.shape)) {
    made.for_cloth = std::make_unique<BulletBody>();
    make_compound({tank_walls(*tank, wall_thickness(*tank))}, *made.for_cloth);
    make_rigid(margin, 0, settings.motion.moves(), *made.for_cloth);
  }
  return made;
}

void add_body_to(btDiscreteDynamicsWorld& world, BulletBody& body) {
  if (!body.for_cloth) return world.addRigidBody(body.body.get());
  constexpr int still = btBroadphaseProxy::StaticFilter, all = btBroadphaseProxy::AllFilter;
  world.addRigidBody(body.body.get(), still, all ^ still ^ cloth_filter);
  world.addRigidBody(body.for_cloth->body.get(), still, cloth_filter);
}

void remove_body_from(btDiscreteDynamicsWorld& world, BulletBody& body) {
  for_each_body(body, [&](BulletBody& one) { world.removeRigidBody(one.body.get()); });
}

void make_kinematic(BulletBody& body) {
  for_each_body(body, [](BulletBody& one) {
    one.body->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    one.body->setActivationState(DISABLE_DEACTIVATION);
  });
}

void place(BulletBody& body, const Motion& motion, double t, const Vec3& more) {
  const btQuaternion turn(to_bullet(motion.spin_axis.normalized()),
                          btScalar(motion.spin_rate * motion_time(motion, t)));
  for_each_body(body, [&](BulletBody& one) {
    one.body->setWorldTransform(
        btTransform(turn * one.turned, to_bullet(moved(motion, one.origin, t) + body.displaced)));
    one.body->setLinearVelocity(to_bullet(velocity_at(motion, one.origin, t) + more));
  });
}

void set_velocity(BulletBody& body, const Vec3& velocity) {
  for_each_body(body, [&](BulletBody& one) { one.body->setLinearVelocity(to_bullet(velocity)); });
}

}  // namespace oilskin::demo
