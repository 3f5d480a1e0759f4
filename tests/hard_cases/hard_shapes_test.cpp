// Hard cases 1, 2, 42, 43: triangles without area, slivers, fans, huge and tiny triangles side by side.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "hard_cases/hard_case.h"
#include "hard_cases/shooting.h"
#include "support/find_contacts.h"
#include "support/random.h"

namespace oilskin::test {
namespace {

// Mesh without area: three collinear nodes; two and three coincident nodes, by position and by index.
SurfaceMotion zero_area_mesh(const HostKind& host) {
  const std::vector<Vec3> nodes = {{0, 0, 0},    {0.04, 0, 0}, {0.02, 0, 0},  {0.1, 0, 0},    {0.1, 0, 0},
                                   {0.14, 0, 0}, {0.2, 0, 0},  {0.2, 0, 0},   {0.2, 0, 0},    {0.3, 0, 0},
                                   {0.33, 0, 0}, {0.4, 0, 0},  {0.5, 0, 0.5}, {0.53, 0, 0.53}};
  return mesh_surface(nodes, {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {9, 10, 9}, {11, 11, 11}, {12, 13, 13}},
                      host.storage, mass_of_nodes(host), 0.001, 2);
}

// Weights and normals of particles at rest close to a mesh: finite, Σ = 1, unit.
struct ContactCount {
  std::uint64_t number = 0;
  double weight_error = 0, largest_k = 0;
};
constexpr double max_weight_error = 4e-16;

ContactCount check_records(std::vector<SurfaceMotion> surfaces, const std::vector<Vec3>& points) {
  ParticleArrays p;
  for (const Vec3& x : points) p.add(x, Vec3::Zero(), particle_mass);
  std::vector<SurfaceMotion*> list;
  for (SurfaceMotion& s : surfaces) list.push_back(&s);
  ContactCount found;
  std::set<std::uint32_t> seen;
  for (const Contact& r : test::find_contacts(p.motion(), list)) {
    ++found.number;
    seen.insert(r.particle);
    double sum = 0, k = 1 / particle_mass;
    for (int i = 0; i < 3; ++i) {
      EXPECT_GE(r.weights[i], 0);
      EXPECT_LE(r.weights[i], 1);
      sum += r.weights[i];
      k += r.weights[i] * r.weights[i] * surfaces[r.surface].inverse_mass[r.nodes[i]];
    }
    EXPECT_TRUE(std::isfinite(k) && k >= 1 / particle_mass);
    EXPECT_NEAR(r.normal.norm(), 1, 1e-12);
    found.weight_error = std::max(found.weight_error, std::abs(sum - 1));
    found.largest_k = std::max(found.largest_k, k);
  }
  EXPECT_LE(found.weight_error, max_weight_error);
  EXPECT_EQ(seen.size(), points.size()) << "every one of these is within the thickness";
  return found;
}

TEST(HardGeometry, triangles_without_area_stop_particles_with_finite_weights) {
  HardCase c("1", "triangles of three collinear nodes, of two or three coincident ones");
  Shooting all;
  ContactCount contacts;
  for (const HostKind& host : host_kinds)
    for (double speed : {20.0, 500.0}) {
      SCOPED_TRACE(host.name);
      ContactScene scene;
      scene.surfaces = {zero_area_mesh(host)};
      std::vector<Vec3> targets, close;
      for (const Triangle& t : scene.surfaces[0].triangles)
        for (double a : {0.0, 0.5, 1.0})
          targets.push_back((1 - a) * scene.surfaces[0].x_t0[t[0]] + a * scene.surfaces[0].x_t0[t[1]]);
      for (const Vec3& x : targets) close.push_back(x + Vec3(0, 5e-4, 0));
      const ContactCount r = check_records(scene.surfaces, close);
      contacts.number += r.number;
      contacts.weight_error = std::max(contacts.weight_error, r.weight_error);
      Random random(1);
      aim(scene, targets, speed, random, true);
      scene.move();
      all.shoot(scene, Vec3::UnitY(), !host.free);
    }
  all.expect_in(c);
  c.at_most("sum of weights, error", contacts.weight_error, max_weight_error);
}

// A fan of slivers of the given aspect between two long sides.
SurfaceMotion sliver_strip(const HostKind& host, double aspect, const Eigen::Matrix3d& turn) {
  const double length = 0.1, width = length / aspect;
  std::vector<Vec3> nodes;
  std::vector<Triangle> triangles;
  for (int k = 0; k < 4; ++k)
    for (double x : {-0.5, 0.5}) nodes.push_back(turn * Vec3(x * length, 0, (k - 1.5) * width));
  for (std::uint32_t k = 0; k + 1 < 4; ++k) {
    triangles.push_back({2 * k, 2 * k + 1, 2 * k + 3});
    triangles.push_back({2 * k, 2 * k + 3, 2 * k + 2});
  }
  return mesh_surface(nodes, triangles, host.storage, mass_of_nodes(host), 0.001, 2);
}

TEST(HardGeometry, slivers_of_aspect_1e6_to_1e12_stop_particles_with_finite_effective_mass) {
  HardCase c("2", "strips of slivers, aspect 1e6 to 1e12, straight and turned");
  Shooting all;
  double largest_k = 0, weight_error = 0;
  for (const HostKind& host : host_kinds)
    for (double aspect : {1e6, 1e7, 1e8, 1e10, 1e12})
      for (double angle : {0.0, 0.7}) {
        SCOPED_TRACE(std::string(host.name) + ", aspect " + shown(aspect) + ", turned by " + shown(angle));
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Vec3(0.6, 0.8, 0)).toRotationMatrix();
        ContactScene scene;
        scene.surfaces = {sliver_strip(host, aspect, turn)};
        std::vector<Vec3> targets, close;
        const std::vector<Vec3>& x = scene.surfaces[0].x_t0;  // aimed at what is stored
        for (const Triangle& t : scene.surfaces[0].triangles)
          for (double a : {0.1, 0.5, 0.8})
            targets.push_back(a * x[t[0]] + 0.6 * (1 - a) * x[t[1]] + 0.4 * (1 - a) * x[t[2]]);
        for (const Vec3& target : targets) close.push_back(target + turn * Vec3(0, 5e-4, 0));
        const ContactCount r = check_records(scene.surfaces, close);
        largest_k = std::max(largest_k, r.largest_k);
        weight_error = std::max(weight_error, r.weight_error);
        Random random(2);
        const Vec3 up = turn * Vec3::UnitY();
        for (double speed : {20.0, 500.0})
          for (const Vec3& target : targets)
            for (double side : {1.0, -1.0})
              scene.particles.add(target + side * 0.5 * speed * scene.dt * up, -side * speed * up,
                                  particle_mass);
        scene.move();
        all.shoot(scene, up, !host.free);
      }
  all.expect_in(c);
  c.at_most("sum of weights, error", weight_error, max_weight_error);
  c.note("largest effective 1/m [1/kg]", largest_k);
}

TEST(HardGeometry, a_fan_of_ten_thousand_edges_around_one_vertex_is_correct_and_bounded) {
  HardCase c("42", "a fan of 10,000 edges around one vertex");
  Found all;
  const std::uint32_t spokes = 10000;
  std::uint64_t contacts = 0, pairs = 0;
  for (const HostKind& host : {host_kinds[0], host_kinds[3]}) {
    SCOPED_TRACE(host.name);
    std::vector<Vec3> nodes{Vec3::Zero()};
    std::vector<Triangle> triangles;
    for (std::uint32_t k = 0; k < spokes; ++k) {
      const double angle = 2 * M_PI * k / spokes;
      nodes.push_back(0.1 * Vec3(std::cos(angle), 0, std::sin(angle)));
      triangles.push_back({0, 1 + k, 1 + (k + 1) % spokes});
    }
    ContactScene scene;
    scene.surfaces = {mesh_surface(nodes, triangles, host.storage, mass_of_nodes(host), 0.001, 2)};
    std::vector<Vec3> targets{Vec3::Zero(), Vec3(1e-9, 0, 0), Vec3(2e-3, 0, 1e-3),
                              nodes[1],     0.5 * nodes[77],  Vec3(0.05, 0, 0.03)};
    Random random(8);
    for (double speed : {3.0, 500.0}) aim(scene, targets, speed, random, true);
    for (const Vec3& x : targets) {  // at rest within the thickness
      scene.particles.add(x + Vec3(0, 6e-4, 0), Vec3::Zero(), particle_mass);
      scene.particles.add(x + Vec3(0, 2e-3, 0), Vec3(0, -3, 0), particle_mass);
    }
    scene.move();
    CheckedContact check(scene);
    check.resolve();
    all.add(check.found);
    contacts += check.contacts.size();
    EXPECT_LE(check.report.candidates, static_cast<std::uint64_t>(spokes) * scene.particles.id.size());
    pairs += static_cast<std::uint64_t>(spokes) * scene.particles.id.size();
    // Thousands of triangles have the hub as their closest point: one record stands for them all. A nanometre
    // beside it rounding cannot tell the spokes apart, and each keeps its record.
    std::uint64_t beside_spokes = 0;
    for (const Contact& r : check.contacts) {
      const Vec3& x = check.scene.particles.x_t0[r.particle];
      beside_spokes += x.x() == 1e-9 && x.z() == 0;
    }
    EXPECT_LE(check.contacts.size() - beside_spokes, 3 * scene.particles.id.size());
    if (host.free) continue;
    for (std::size_t i = 0; i < scene.particles.id.size(); ++i)
      EXPECT_GT(check.scene.particles.x_t1[i].y() * scene.particles.x_t0[i].y(), 0) << "particle " << i;
  }
  c.note("shots", all.audit.particles);
  c.no_crossings(all);
  c.equal("removed", all.total.removed, 0);
  c.note("impacts", all.total.impacts);
  c.at_most("candidates", static_cast<double>(all.total.candidates), static_cast<double>(pairs));
  c.note("contacts", contacts);
}

TEST(HardGeometry, huge_and_tiny_triangles_side_by_side_miss_no_pair) {
  HardCase c("43", "a triangle of 1,000 spacings under a sheet of triangles of dx/100, 200 shots each");
  Found all;
  std::uint64_t aimed = 0, maximum = 0;
  for (const HostKind& host : host_kinds) {
    SCOPED_TRACE(host.name);
    // A triangle of 1,000 spacings, and a sheet of triangles of a hundredth of a spacing over it.
    ContactScene scene;
    const double dx = scene.spacing;
    scene.surfaces = {mesh_surface({{-500 * dx, 0, -500 * dx}, {500 * dx, 0, -500 * dx}, {0, 0, 500 * dx}},
                                   {{0, 1, 2}}, host.storage, mass_of_nodes(host), 0.001, 5, 1),
                      make_grid(41, 41, Vec3(-20 * dx / 100, 0.02, -20 * dx / 100), Vec3(40 * dx / 100, 0, 0),
                                Vec3(0, 0, 40 * dx / 100), host.free ? 1e-7 : 0, 0.001, 5, host.storage, 2)};
    Random random(12);
    for (int k = 0; k < 200; ++k) {
      const bool small = k % 2;
      const double reach = small ? 0.19 * dx : 100 * dx;
      const double side = k % 4 < 2 ? 1 : -1, speed = k % 3 ? 10 : 300;
      const Vec3 target(random.uniform(-reach, reach), small ? 0.02 : 0, random.uniform(-reach, reach));
      const Vec3 displacement = (Vec3(0, -side, 0) + 0.3 * random.in_cube(1)).normalized();
      scene.particles.add(target - 0.5 * scene.dt * speed * displacement, speed * displacement,
                          particle_mass);
    }
    // Those that begin between the sheets nearer than δ to one would break the premise.
    scene.move();
    for (std::size_t i = 0; i < scene.particles.id.size(); ++i) aimed += exactly_intersects(scene, i);
    const Found f = resolve_checked(scene);
    all.add(f);
    maximum = std::max(maximum, f.total.candidates);
  }
  c.note("shots", all.audit.particles);
  c.above("true hits", static_cast<double>(aimed), 400);
  c.no_crossings(all);
  c.equal("removed", all.total.removed, 0);
  c.note("impacts", all.total.impacts);
  c.at_most("candidates of one host", static_cast<double>(maximum), 200 * 3201);
}

}  // namespace
}  // namespace oilskin::test
