// FCL's own queries as oracles.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/closest_point.h"
#include "meshes.h"
#include "proximity/surface_tree.h"

namespace oilskin::proximity {
namespace {

using namespace proximity_test;

/// A mesh at rest and boxes of points inflated by h: what a static query asks.
struct StaticQuery {
  MovingMesh mesh;
  std::vector<Vec3> points;
  std::vector<Box> boxes;
  Candidates candidates;
  double h;

  StaticQuery(MovingMesh m, std::size_t n, double radius, unsigned seed) : mesh(std::move(m)), h(radius) {
    mesh.x_t1 = mesh.x_t0;
    Random random(seed);
    for (std::size_t i = 0; i < n; ++i) {
      // Close to the mesh, or hardly any would touch it.
      const Triangle& t = mesh.triangles[random.index(mesh.triangles.size())];
      points.push_back(mesh.x_t0[t[0]] + random.in_cube(3 * h));
      boxes.push_back(Box{points.back(), points.back()}.inflated(h));
    }
    SurfaceTree tree;
    tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1));
    tree.query(boxes, Workers(1), candidates);
  }
};

/// Same triangles as FCL's sphere-mesh collision once the distance decides among the candidates.
TEST(SurfaceTreeOracle, candidates_within_reach_are_those_of_fcl_collide) {
  Random random(20);
  StaticQuery q(sheet(24, 0, random), 300, 0.02, 21);
  fcl::BVHModel<fcl::OBBRSS<double>> model;
  std::vector<fcl::Triangle> faces;
  for (const Triangle& t : q.mesh.triangles) faces.emplace_back(t[0], t[1], t[2]);
  model.beginModel();
  model.addSubModel(q.mesh.x_t0, faces);
  model.endModel();
  const fcl::Sphere<double> sphere(q.h);
  std::size_t touched = 0;
  for (std::size_t i = 0; i < q.points.size(); ++i) {
    fcl::Transform3<double> at = fcl::Transform3<double>::Identity();
    at.translation() = q.points[i];
    fcl::CollisionRequest<double> request(10000, true);
    fcl::CollisionResult<double> result;
    fcl::collide(&model, fcl::Transform3<double>::Identity(), &sphere, at, request, result);
    std::set<std::uint32_t> hit;
    for (std::size_t k = 0; k < result.numContacts(); ++k)
      hit.insert(static_cast<std::uint32_t>(result.getContact(k).b1));
    std::set<std::uint32_t> near;
    for (std::uint32_t t : q.candidates.of(i)) {
      const Triangle& n = q.mesh.triangles[t];
      const double d =
          closest_point(q.points[i], q.mesh.x_t0[n[0]], q.mesh.x_t0[n[1]], q.mesh.x_t0[n[2]]).distance;
      if (d <= q.h) near.insert(t);
    }
    EXPECT_EQ(hit, near) << "point " << i;
    touched += hit.size();
  }
  EXPECT_GT(touched, 300u);
}

/// A collision geometry that is a box and nothing else.
class BoxGeometry : public fcl::CollisionGeometry<double> {
 public:
  explicit BoxGeometry(const Box& b) {
    this->aabb_local = fcl::AABB<double>(b.min, b.max);
    this->aabb_center = this->aabb_local.center();
    this->aabb_radius = (this->aabb_local.min_ - this->aabb_center).norm();
  }
  void computeLocalAABB() override {}
};

/// FCL 0.7 gives an unrotated object the box centre ± radius unless a rotation is set.
std::unique_ptr<fcl::CollisionObject<double>> object_of(const Box& b) {
  auto object = std::make_unique<fcl::CollisionObject<double>>(std::make_shared<BoxGeometry>(b),
                                                               fcl::Transform3<double>::Identity());
  const_cast<fcl::AABB<double>&>(object->getAABB()) = fcl::AABB<double>(b.min, b.max);
  return object;
}

struct Hits {
  std::map<const fcl::CollisionObject<double>*, std::uint32_t> number;
  std::set<std::uint32_t> found;
};

bool record(fcl::CollisionObject<double>* a, fcl::CollisionObject<double>* b, void* data) {
  auto& hits = *static_cast<Hits*>(data);
  if (!a->getAABB().overlap(b->getAABB())) return false;
  for (auto* o : {a, b}) {
    const auto it = hits.number.find(o);
    if (it != hits.number.end()) hits.found.insert(it->second);
  }
  return false;
}

void expect_equal_to_manager(const MovingMesh& mesh, const std::vector<Box>& boxes) {
  SurfaceTree tree;
  tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1));
  Candidates candidates;
  tree.query(boxes, Workers(1), candidates);
  Hits hits;
  std::vector<std::unique_ptr<fcl::CollisionObject<double>>> objects;
  fcl::DynamicAABBTreeCollisionManager<double> manager;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    objects.push_back(object_of(swept_box(mesh, t)));
    hits.number[objects.back().get()] = static_cast<std::uint32_t>(t);
    manager.registerObject(objects.back().get());
  }
  manager.setup();
  std::size_t total = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].min.x() > boxes[i].max.x()) continue;
    const auto query = object_of(boxes[i]);
    hits.found.clear();
    manager.collide(query.get(), &hits, record);
    const auto row = candidates.of(i);
    EXPECT_EQ(std::vector<std::uint32_t>(hits.found.begin(), hits.found.end()),
              std::vector<std::uint32_t>(row.begin(), row.end()))
        << "box " << i;
    total += row.size();
  }
  EXPECT_GT(total, boxes.size() / 4);
}

TEST(SurfaceTreeOracle, candidates_are_those_of_fcls_dynamic_tree_manager) {
  Random random(22);
  const StaticQuery rest(sheet(20, 0, random), 200, 0.03, 23);
  expect_equal_to_manager(rest.mesh, rest.boxes);
  const auto moving = soup(100, 300, 0.2, random);
  expect_equal_to_manager(moving, particle_boxes(200, 1, 0.2, 0.02, random));
}

}  // namespace
}  // namespace oilskin::proximity
