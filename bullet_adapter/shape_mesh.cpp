#include "shape_mesh.h"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/CollisionShapes/btTetrahedronShape.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>
#include <BulletCollision/CollisionShapes/btTriangleMeshShape.h>

#include "convert.h"
#include "tessellation.h"
#include "welding.h"

namespace oilskin::bullet {

namespace {

constexpr int max_compound_depth = 32;  // ends the recursion for a compound that contains itself

/// Collects the triangles of one shape and welds coincident vertices.
class Collector : public btTriangleCallback, public btInternalTriangleIndexCallback {
 public:
  Collector(const btTransform& to_body, ShapeMesh* mesh) : to_body_(to_body), mesh_(mesh) {}

  void processTriangle(btVector3* corners, int, int) override { add(corners); }
  void internalProcessTriangleIndex(btVector3* corners, int, int) override { add(corners); }
  void add(const PointMesh& part) {
    for (const Triangle& t : part.triangles) {
      const btVector3 corners[3] = {to_bt(part.points[t[0]]), to_bt(part.points[t[1]]),
                                    to_bt(part.points[t[2]])};
      add(corners);
    }
  }

 private:
  void add(const btVector3* corners) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      const btVector3 p = to_body_ * corners[k];
      const std::uint32_t number = offset_ + numbers_.number_of(to_vec3(p));
      if (number == mesh_->vertices.size()) mesh_->vertices.push_back(p);
      t[k] = number;
    }
    mesh_->triangles.push_back(t);
  }

  btTransform to_body_;
  ShapeMesh* mesh_;
  PointNumbers numbers_;
  std::uint32_t offset_ = static_cast<std::uint32_t>(mesh_->vertices.size());
};

Status unsupported(const btCollisionShape& shape, const char* why) {
  return Status::refused("collision shape \"" + std::string(shape.getName()) + "\" " + why);
}

btAlignedObjectArray<btVector3> corners_of(const btCollisionShape& shape) {
  btAlignedObjectArray<btVector3> points;
  if (shape.getShapeType() == CONVEX_HULL_SHAPE_PROXYTYPE) {
    const auto& hull = static_cast<const btConvexHullShape&>(shape);
    for (int i = 0; i < hull.getNumPoints(); ++i) points.push_back(hull.getScaledPoint(i));
    return points;
  }
  const auto& polyhedron = static_cast<const btPolyhedralConvexShape&>(shape);
  for (int i = 0; i < polyhedron.getNumVertices(); ++i) {
    btVector3 p;
    polyhedron.getVertex(i, p);
    points.push_back(p);
  }
  return points;
}

btAlignedObjectArray<btVector3> support_points(const btConvexShape& shape, double tolerance) {
  btVector3 center;
  btScalar radius = 0;
  shape.getBoundingSphere(center, radius);
  btAlignedObjectArray<btVector3> points;
  for (const Vec3& direction : even_directions(static_cast<double>(radius), tolerance))
    points.push_back(shape.localGetSupportingVertex(to_bt(direction)));
  return points;
}

void read_concave(const btCollisionShape& shape, Collector* collector) {
  const int type = shape.getShapeType();
  const btScalar large = btScalar(BT_LARGE_FLOAT);
  const btVector3 box_min(-large, -large, -large), box_max(large, large, large);
  if (type == TRIANGLE_MESH_SHAPE_PROXYTYPE || type == MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE)
    static_cast<const btTriangleMeshShape&>(shape).getMeshInterface()->InternalProcessAllTriangles(
        collector, box_min, box_max);
  else
    static_cast<const btConcaveShape&>(shape).processAllTriangles(collector, box_min, box_max);
}

Status read_convex(const btCollisionShape& shape, double tolerance, Collector* collector) {
  PointMesh part;
  switch (shape.getShapeType()) {
    case SPHERE_SHAPE_PROXYTYPE:
      part = sphere_of_equal_volume(static_cast<double>(static_cast<const btSphereShape&>(shape).getRadius()),
                                    tolerance);
      break;
    case BOX_SHAPE_PROXYTYPE:
    case TETRAHEDRAL_SHAPE_PROXYTYPE:
    case CONVEX_HULL_SHAPE_PROXYTYPE:
      part = convex_hull(corners_of(shape));
      break;
    default:
      part = convex_hull(support_points(static_cast<const btConvexShape&>(shape), tolerance));
  }
  if (part.triangles.empty()) return unsupported(shape, "is flat: it needs four points that span a volume");
  collector->add(part);
  return Status::accepted();
}

void read_plane(const btStaticPlaneShape& shape, const btTransform& to_body, ShapeMesh* mesh) {
  const btVector3 n = to_body.getBasis() * shape.getPlaneNormal();
  mesh->planes.push_back({n, shape.getPlaneConstant() + n.dot(to_body.getOrigin())});
}

Status read(const btCollisionShape& shape, const btTransform& to_body, double tolerance, int depth,
            ShapeMesh* mesh) {
  const int type = shape.getShapeType();
  if (type == COMPOUND_SHAPE_PROXYTYPE) {
    if (depth >= max_compound_depth) return unsupported(shape, "is nested too deeply");
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
      const btTransform child = to_body * compound.getChildTransform(i);
      Status status = read(*compound.getChildShape(i), child, tolerance, depth + 1, mesh);
      if (!status.ok()) return status;
    }
    return Status::accepted();
  }
  if (type == STATIC_PLANE_PROXYTYPE) {
    read_plane(static_cast<const btStaticPlaneShape&>(shape), to_body, mesh);
    mesh->solid = false;
    return Status::accepted();
  }
  Collector collector(to_body, mesh);
  if (shape.isConvex()) return read_convex(shape, tolerance, &collector);
  if (!shape.isConcave()) return unsupported(shape, "is not supported");
  read_concave(shape, &collector);
  mesh->solid = false;
  return Status::accepted();
}

void add_signature(const btCollisionShape& shape, int depth, std::vector<double>* values) {
  auto add = [values](const btVector3& v) {
    for (int k = 0; k < 3; ++k) values->push_back(static_cast<double>(v[k]));
  };
  values->push_back(static_cast<double>(reinterpret_cast<std::uintptr_t>(&shape)));
  values->push_back(shape.getShapeType());
  values->push_back(static_cast<double>(shape.getMargin()));
  add(shape.getLocalScaling());
  if (shape.getShapeType() == CONVEX_HULL_SHAPE_PROXYTYPE)
    values->push_back(static_cast<const btConvexHullShape&>(shape).getNumPoints());
  // Another shape of the same kind may be at the address of one that was deleted.
  if (shape.getShapeType() == STATIC_PLANE_PROXYTYPE) {
    const auto& plane = static_cast<const btStaticPlaneShape&>(shape);
    add(plane.getPlaneNormal());
    values->push_back(static_cast<double>(plane.getPlaneConstant()));
  } else {
    btVector3 low, high;
    shape.getAabb(btTransform::getIdentity(), low, high);
    add(low);
    add(high);
  }
  if (shape.getShapeType() != COMPOUND_SHAPE_PROXYTYPE || depth >= max_compound_depth) return;
  const auto& compound = static_cast<const btCompoundShape&>(shape);
  for (int i = 0; i < compound.getNumChildShapes(); ++i) {
    const btTransform& child = compound.getChildTransform(i);
    add(child.getOrigin());
    for (int row = 0; row < 3; ++row) add(child.getBasis().getRow(row));
    add_signature(*compound.getChildShape(i), depth + 1, values);
  }
}

}  // namespace

Status read_shape(const btCollisionShape& shape, ShapeMesh* mesh, double tolerance) {
  *mesh = ShapeMesh();
  Status status = read(shape, btTransform::getIdentity(), tolerance, 0, mesh);
  if (!status.ok()) return status;
  if (mesh->triangles.empty() && mesh->planes.empty()) return unsupported(shape, "has no triangles");
  for (std::size_t i = 0; i < mesh->vertices.size(); ++i)
    if (!to_vec3(mesh->vertices[i]).allFinite()) return unsupported(shape, "has a vertex that is not finite");
  return Status::accepted();
}

std::vector<double> shape_signature(const btCollisionShape& shape) {
  std::vector<double> values;
  add_signature(shape, 0, &values);
  return values;
}

}  // namespace oilskin::bullet
