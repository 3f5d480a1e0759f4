// Hard cases of geometry: triangles without area, slivers, exact hits, duplicates, seams, holes, huge and
// tiny triangles side by side, coordinates far away. What holds in all of them is in invariants.h.
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/closest_point.h"
#include "fluid/boundary/boundary.h"
#include "hard_cases/cloth_scene.h"
#include "hard_cases/invariants.h"
#include "hard_cases/outcome.h"
#include "support/exact.h"
#include "support/find_contacts.h"
#include "support/random.h"
#include "support/static_mesh.h"
#include "support/surface_of.h"

namespace oilskin {
namespace {

using test::CheckedContact;
using test::ContactScene;
using test::count;
using test::Found;
using test::host_kinds;
using test::HostKind;
using test::mass_of_nodes;
using test::mesh_surface;
using test::node_mass;
using test::particle_mass;
using test::Random;
using test::record_outcome;
using test::resolve_checked;
using test::shots;
using test::shown;
using test::square_sheet;

// A particle on each side of every target, aimed so that it would be as far on the other side after dt.
void aim(ContactScene& scene, const std::vector<Vec3>& targets, double speed, Random& random,
         bool straight = false) {
  for (const Vec3& target : targets)
    for (double side : {1.0, -1.0}) {
      Vec3 displacement = Vec3(0, -side, 0);
      if (!straight) displacement = (displacement + 0.6 * random.in_cube(1)).normalized();
      scene.particles.add(target - 0.5 * displacement * speed * scene.dt, displacement * speed,
                          particle_mass);
    }
}

// Mesh without area: three collinear nodes; two and three coincident nodes, by position and by index.
SurfaceMotion zero_area_mesh(const HostKind& host) {
  const std::vector<Vec3> nodes = {{0, 0, 0},    {0.04, 0, 0}, {0.02, 0, 0},  {0.1, 0, 0},    {0.1, 0, 0},
                                   {0.14, 0, 0}, {0.2, 0, 0},  {0.2, 0, 0},   {0.2, 0, 0},    {0.3, 0, 0},
                                   {0.33, 0, 0}, {0.4, 0, 0},  {0.5, 0, 0.5}, {0.53, 0, 0.53}};
  return mesh_surface(nodes, {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {9, 10, 9}, {11, 11, 11}, {12, 13, 13}},
                      host.storage, mass_of_nodes(host), 0.001, 2);
}

// Do the straight ways of a particle and of some triangle touch? In exact arithmetic, behind a test of boxes.
bool exactly_meets(const ContactScene& scene, std::size_t particle = 0) {
  const auto point = [](const Vec3& x) { return exact::Point{x.x(), x.y(), x.z()}; };
  const test::ParticleArrays& p = scene.particles;
  Box displacement;
  displacement.add(p.x_t0[particle]);
  displacement.add(p.x_t1[particle]);
  for (const SurfaceMotion& s : scene.surfaces)
    for (const Triangle& t : s.triangles) {
      exact::Motion m;
      m.t0[0] = point(p.x_t0[particle]);
      m.t1[0] = point(p.x_t1[particle]);
      Box swept;
      for (int k = 0; k < 3; ++k) {
        swept.add(s.x_t0[t[k]]);
        swept.add(s.x_t1[t[k]]);
        m.t0[k + 1] = point(s.x_t0[t[k]]);
        m.t1[k + 1] = point(s.x_t1[t[k]]);
      }
      if (swept.overlaps(displacement) && exact::point_triangle(m).hit) return true;
    }
  return false;
}

// Shots through the plane with the normal `up` through the origin: those that would truly meet the mesh, by
// exact arithmetic, must end on the side where they began if the mesh stands still.
struct Shooting {
  Found found;
  std::uint64_t true_hits = 0;

  void shoot(ContactScene scene, const Vec3& up, bool still) {
    std::vector<std::uint8_t> hits;
    for (std::size_t i = 0; i < scene.particles.id.size(); ++i) {
      hits.push_back(exactly_meets(scene, i));
      true_hits += hits.back();
    }
    found.add(resolve_checked(scene));
    EXPECT_EQ(found.total.removed, 0u);
    for (std::size_t i = 0; still && i < hits.size(); ++i) {
      const double before = scene.particles.x_t0[i].dot(up), after = scene.particles.x_t1[i].dot(up);
      if (hits[i]) {
        EXPECT_GT(before * after, 0) << "particle " << i << " is not stopped";
      }
    }
  }
  std::string row() const {
    return count(found.audit.particles) + " shots, " + count(true_hits) + " true hits, " +
           count(found.audit.crossings + found.audit.touchings) + " crossings";
  }
};

// Weights and normals of particles at rest close to a mesh: finite, Σ = 1, unit.
struct ContactCount {
  std::uint64_t number = 0;
  double weight_error = 0, largest_k = 0;
};
ContactCount check_records(std::vector<SurfaceMotion> surfaces, const std::vector<Vec3>& points) {
  test::ParticleArrays p;
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
  EXPECT_LE(found.weight_error, 4e-16);
  EXPECT_EQ(seen.size(), points.size()) << "every one of these is within the thickness";
  return found;
}

TEST(HardGeometry, triangles_without_area_stop_particles_with_finite_weights) {
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
  EXPECT_GT(all.true_hits, all.found.audit.particles / 2);
  record_outcome("1", "triangles of three collinear nodes, of two or three coincident ones",
                 all.row() + "; sum of weights off by " + shown(contacts.weight_error) + " at most");
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
  EXPECT_GT(all.true_hits, all.found.audit.particles / 2);
  record_outcome("2", "strips of slivers, aspect 1e6 to 1e12, straight and turned",
                 all.row() + "; sum of weights off by " + shown(weight_error) + ", largest effective 1/m " +
                     shown(largest_k) + " 1/kg");
}

TEST(HardGeometry,
     particles_that_start_exactly_on_the_mesh_are_refused_and_those_it_lands_on_are_seeded_anew) {
  std::uint64_t refused = 0, seeded = 0, removed = 0;
  for (const HostKind& host : host_kinds) {
    SCOPED_TRACE(host.name);
    const SurfaceMotion sheet = square_sheet(host);
    const Triangle t = sheet.triangles[5];
    const Vec3 vertex = sheet.x_t0[t[0]], edge = 0.5 * (sheet.x_t0[t[0]] + sheet.x_t0[t[1]]);
    const Vec3 face = (sheet.x_t0[t[0]] + sheet.x_t0[t[1]] + sheet.x_t0[t[2]]) / 3;
    const std::vector<Vec3> on = {vertex, edge, face, vertex + Vec3(0, 1e-9, 0)};

    // A record there has a unit normal; contact says that it cannot promise anything.
    test::ParticleArrays p;
    for (const Vec3& x : on) p.add(x, Vec3(0, -1, 0), particle_mass);
    p.move(1e-3);
    SurfaceMotion copy = sheet;
    SurfaceMotion* list[] = {&copy};
    ContactSolver solver(ContactSettings{}, 1);
    std::set<std::uint32_t> seen;
    for (const Contact& r : test::find_contacts(p.motion(), list)) {
      seen.insert(r.particle);
      EXPECT_NEAR(r.normal.norm(), 1, 1e-12);
    }
    EXPECT_EQ(seen.size(), on.size());
    ContactReport report;
    StageSeconds seconds;
    ParticleMotion motion = p.motion();
    ASSERT_TRUE(solver.resolve(1e-3, motion, list, report, seconds).ok());
    EXPECT_GE(report.started_too_close, on.size());
    for (const Vec3& x : p.x_t1) EXPECT_TRUE(x.allFinite());

    // A world refuses them one by one …
    test::StaticMesh wall;
    wall.nodes = sheet.x_t0;
    wall.triangles = sheet.triangles;
    const std::vector<Vec3> still(on.size(), Vec3::Zero());
    WorldSettings settings;
    settings.gravity.setZero();
    settings.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
    const auto fill = [&](World& w) {
      std::uint64_t blocked = 0;
      EXPECT_TRUE(w.add_particles(on, still, &blocked).ok());
      return blocked;
    };
    World late(settings);
    ASSERT_TRUE(late.attach(wall, test::sheet_settings(), nullptr).ok());
    EXPECT_EQ(fill(late), on.size());
    refused += on.size();
    // … and where a mesh comes down on those that are there, they are moved out or removed, the same way each
    // time.
    std::uint64_t hash = 0;
    for (int again : {0, 1}) {
      World early(settings);
      EXPECT_EQ(fill(early), 0u);
      ASSERT_TRUE(early.attach(wall, test::sheet_settings(), nullptr).ok());
      const StepReport& r = early.step(1e-3);
      EXPECT_EQ(r.contact.relocated, on.size());
      EXPECT_EQ(r.contact.started_too_close, 0u);
      EXPECT_EQ(early.particle_count() + r.removed, on.size());
      for (const Vec3& x : early.positions()) EXPECT_GE(std::abs(x.y()), sheet.delta);
      if (again) {
        EXPECT_EQ(early.state_hash(), hash);
        seeded += r.contact.relocated - r.removed;
        removed += r.removed;
      }
      hash = early.state_hash();
    }
  }
  record_outcome("4", "particles exactly on a face, an edge, a vertex, and 1 nm over one",
                 count(refused) + " refused; of as many under a new mesh " + count(seeded) +
                     " moved out to h, " + count(removed) + " removed, all counted");
}

// Three triangles on one edge (along z through the origin), one of them upright.
SurfaceMotion non_manifold(const HostKind& host) {
  return mesh_surface({{0, 0, -0.02}, {0, 0, 0.02}, {0.03, 0, 0}, {-0.03, 0, 0}, {0, -0.03, 0}},
                      {{0, 2, 1}, {0, 1, 3}, {0, 1, 4}}, host.storage, mass_of_nodes(host), 0.001, 2);
}

SurfaceMotion renumbered(const SurfaceMotion& s) {
  SurfaceMotion r = s;
  std::reverse(r.triangles.begin(), r.triangles.end());
  for (Triangle& t : r.triangles) t = {t[1], t[2], t[0]};
  return r;
}

TEST(HardGeometry, aimed_at_vertices_edges_and_non_manifold_edges_nothing_passes_however_faces_are_numbered) {
  Found all;
  double difference = 0;
  for (const HostKind& host : host_kinds)
    for (double speed : {3.0, 50.0, 500.0}) {
      SCOPED_TRACE(std::string(host.name) + " at " + shown(speed) + " m/s");
      for (const SurfaceMotion& mesh : {square_sheet(host), non_manifold(host)}) {
        std::vector<Vec3> targets = mesh.x_t0;
        for (const Triangle& t : mesh.triangles)
          for (int k = 0; k < 3; ++k) targets.push_back(0.5 * (mesh.x_t0[t[k]] + mesh.x_t0[t[(k + 1) % 3]]));
        for (const Vec3& target : targets) {
          if (target.y() < 0) continue;  // on the upright triangle: a shot at it would begin on it
          ContactScene scene;
          Random random(5);
          scene.surfaces = {mesh};
          aim(scene, {target}, speed, random, true);
          scene.particles.id.resize(1);  // from above alone: below is the upright triangle
          for (auto* list : {&scene.particles.x_t0, &scene.particles.x_t1, &scene.particles.velocity})
            list->resize(1);
          scene.particles.inverse_mass.resize(1);
          scene.particles.removed.resize(1);
          scene.move();
          ContactScene other = scene;
          other.surfaces = {renumbered(mesh)};
          all.add(resolve_checked(scene));
          all.add(resolve_checked(other));
          if (!host.free) {
            EXPECT_GT(scene.particles.x_t1[0].y(), 0);
          }
          difference =
              std::max({difference, (scene.particles.x_t1[0] - other.particles.x_t1[0]).norm() / 0.001,
                        (scene.particles.velocity[0] - other.particles.velocity[0]).norm() / speed});
        }
      }
    }
  EXPECT_LE(difference, 1e-6) << "of h and of the speed";
  EXPECT_EQ(all.total.removed, 0u);
  record_outcome("5", "aimed exactly at vertices, shared edges of two faces and of three; faces renumbered",
                 shots(all) + "; renumbering changes results by " + shown(difference) + " (of h, of v)");
}

TEST(HardGeometry, sliding_in_the_plane_of_a_sheet_its_border_stops_particles) {
  Found all;
  std::uint64_t stopped = 0, shot = 0;
  for (const HostKind& host : host_kinds)
    for (double speed : {2.0, 20.0, 500.0})
      for (double angle : {0.0, 0.5}) {
        SCOPED_TRACE(std::string(host.name) + " at " + shown(speed) + " m/s, turned by " + shown(angle));
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Vec3(0, 0, 1)).toRotationMatrix();
        ContactScene scene;
        scene.surfaces = {test::make_grid(5, 5, turn * Vec3(-0.02, 0, -0.02), turn * Vec3(0.04, 0, 0),
                                          Vec3(0, 0, 0.04), mass_of_nodes(host), 0.001, 2, host.storage)};
        for (double z : {-0.02, -0.013, -0.01, 0.0, 0.0077, 0.01, 0.02}) {
          const double gap = 0.5 * speed * scene.dt;
          scene.particles.add(turn * Vec3(-0.02 - gap, 0, z), turn * Vec3(speed, 0, 0), particle_mass);
          scene.particles.add(turn * Vec3(0.02 + gap, 0, z), turn * Vec3(-speed, 0, 0), particle_mass);
        }
        scene.move();
        all.add(resolve_checked(scene));
        if (host.free) continue;
        for (std::size_t i = 0; i < scene.particles.id.size(); ++i) {
          ++shot;
          const Vec3 end = turn.transpose() * scene.particles.x_t1[i];
          stopped += std::abs(end.x()) > 0.02;
          // In the plane the border stops it; in a float host turned nodes are a rounding off the plane, and
          // it may glide on along one side.
          if (angle == 0 || host.storage == Storage::float64) {
            EXPECT_GT(std::abs(end.x()), 0.02) << i;
          }
        }
      }
  EXPECT_EQ(all.total.removed, 0u);
  record_outcome("6", "sliding in the sheet's own plane into its border, at nodes and between",
                 shots(all) + "; pinned: " + count(stopped) + " of " + count(shot) + " stopped outside");
}

// Four points whose signed volume has a double or triple root at t = 1/2, shifted by `offset` along y.
ContactScene grazing(bool triple, double offset, double scale, const HostKind& host) {
  ContactScene scene;
  std::vector<Vec3> t0, t1;
  Vec3 p0, p1;
  if (triple) {
    // b − a, c − a and p − a shrink to a point and come out on the other side: (t − ½)³.
    for (double s : {-0.5, 0.5}) {
      (s < 0 ? t0 : t1) = {{0, 0, 0}, {3 * s, 0, 0}, {0, 0, 3 * s}};
      (s < 0 ? p0 : p1) = Vec3(0.7 * s, s + offset, 0.6 * s);
    }
  } else {
    // The plane tilts about the x axis while the point walks along z through that axis: (t − ½)².
    for (double s : {-0.5, 0.5}) {
      (s < 0 ? t0 : t1) = {{-2, -2 * s, -2}, {2, -2 * s, -2}, {0, 2 * s, 2}};
      (s < 0 ? p0 : p1) = Vec3(0.1, offset, s);
    }
  }
  for (auto* list : {&t0, &t1})
    for (Vec3& x : *list) x *= scale;
  scene.surfaces = {mesh_surface(t0, {{0, 1, 2}}, host.storage, mass_of_nodes(host), 0.001, 2)};
  SurfaceMotion& s = scene.surfaces[0];
  scene.particles.add(scale * p0, scale * (p1 - p0) / scene.dt, particle_mass);
  scene.particles.x_t1[0] = scale * p1;
  for (int k = 0; k < 3; ++k) {
    s.x_t1[k] = stored(t1[k], host.storage);
    s.velocity[k] = (s.x_t1[k] - s.x_t0[k]) / scene.dt;
  }
  return scene;
}

TEST(HardGeometry, grazing_paths_with_double_and_triple_roots_never_cross) {
  Found all;
  std::uint64_t real = 0, spurious = 0, grazes = 0;
  for (const HostKind& host : host_kinds)
    for (bool triple : {false, true})
      for (double scale : {0.01, 0.013})
        for (double size : {0.0, 1e-17, 1e-16, 1e-14, 1e-12, 1e-9, 1e-6, 1e-3})
          for (double sign : {1.0, -1.0}) {
            SCOPED_TRACE(std::string(host.name) + (triple ? ", triple, " : ", double, ") +
                         shown(sign * size));
            ContactScene scene = grazing(triple, sign * size, scale, host);
            // Rows at the start push away what comes near: detection alone is the subject.
            scene.settings.repulsion = Repulsion::none;
            const bool meets = exactly_meets(scene);
            const std::uint64_t meetings = [&] {
              const Found f = resolve_checked(scene);
              all.add(f);
              return f.total.impacts;
            }();
            ++grazes;
            if (meets) {
              ++real;
            } else if (meetings > 0) {
              ++spurious;
            }
          }
  EXPECT_GT(real, 0u);
  record_outcome("7", "grazing: signed volume with a double or a triple root, shifted by 0 to 1e-3",
                 count(grazes) + " grazes, " + count(all.audit.crossings + all.audit.touchings) +
                     " crossings, " + count(real) + " truly meet, " + count(spurious) +
                     " corrected without need");
}

double smallest_that_would_do(const std::string& message) {
  const std::string words = "must be ≥ ";
  const auto at = message.find(words);
  return at == std::string::npos ? 0 : std::stod(message.substr(at + words.size()));
}

template <class Scalar>
double check_thin(double thickness, double r) {
  WorldSettings settings;
  settings.kill_box = {Vec3::Constant(-r), Vec3::Constant(r)};
  World w(settings);
  test::MockCloth<Scalar> cloth;
  const Status refused = w.attach(cloth, test::sheet_settings(thickness), nullptr);
  EXPECT_FALSE(refused.ok()) << thickness;
  const double minimum = smallest_that_would_do(refused.message);
  EXPECT_GT(minimum, 0) << refused.message;
  EXPECT_TRUE(w.attach(cloth, test::sheet_settings(1.0001 * minimum), nullptr).ok()) << minimum;
  EXPECT_FALSE(w.attach(cloth, test::sheet_settings(0.999 * minimum), nullptr).ok()) << minimum;
  return minimum;
}

TEST(HardGeometry, a_thickness_of_zero_or_1e_12_is_refused_with_the_smallest_that_would_do) {
  const double in_float = check_thin<float>(1e-12, 10);
  EXPECT_NEAR(check_thin<float>(0, 10), in_float, 1e-3 * in_float);
  const double in_double = check_thin<double>(0, 10);
  check_thin<double>(1e-12, 100);  // at ±10 m a double host may be 1e-12 m thick: 4 δ is less
  EXPECT_LT(in_double, 1e-12);
  // … and then nothing passes.
  ContactScene scene;
  scene.surfaces = {test::make_grid(5, 5, Vec3(-0.02, 0, -0.02), Vec3(0.04, 0, 0), Vec3(0, 0, 0.04),
                                    node_mass, 1e-12, 10, Storage::float64)};
  Random random(3);
  aim(scene, scene.surfaces[0].x_t0, 50, random);
  scene.move();
  const Found f = resolve_checked(scene);
  record_outcome("8", "thickness 0 and 1e-12 m",
                 "refused; smallest at 10 m: " + shown(in_float) + " m for floats, " + shown(in_double) +
                     " m for doubles; 1e-12 m in double: " + shots(f));
}

// A sheet with particles around it: within the thickness, approaching, and too fast for anything but the
// continuous test. Every number is a multiple of 2⁻¹² of `unit`, so that moving and scaling round nothing.
ContactScene busy_scene(const HostKind& host, double unit, const Vec3& offset, double thickness, double r) {
  const auto snapped = [&](const Vec3& x) { return Vec3((x * 4096).array().round() / 4096 * unit); };
  ContactScene scene;
  scene.spacing = unit * 0x1p-3;
  SurfaceMotion sheet =
      test::make_grid(9, 9, Vec3(-1, 0, -1) * unit, Vec3(2, 0, 0) * unit, Vec3(0, 0, 2) * unit,
                      mass_of_nodes(host), thickness, r, host.storage);
  Random random(9);
  for (std::size_t i = 0; i < sheet.x_t0.size(); ++i) {
    sheet.x_t0[i] = snapped(sheet.x_t0[i] / unit + random.in_cube(0.02)) + offset;
    sheet.x_t1[i] = sheet.x_t0[i];
  }
  scene.surfaces = {sheet};
  for (int k = 0; k < 60; ++k) {
    const double side = k % 2 ? 1 : -1;
    const Vec3 x(random.uniform(-0.9, 0.9), side * random.uniform(0.12, 0.4), random.uniform(-0.9, 0.9));
    const double speed = k % 3 == 0 ? 1000 : 50;
    const Vec3 v = speed * (0.4 * random.in_cube(1) - Vec3(0, side, 0));
    scene.particles.add(snapped(x) + offset, snapped(v), particle_mass);
  }
  scene.move();
  return scene;
}

// Largest differences of positions, less the offset and in units of `unit`, and of velocities.
struct Difference {
  double position = 0, velocity = 0, speed = 0;
};
Difference compare(const ContactScene& a, const ContactScene& b, double scale, const Vec3& offset) {
  Difference d;
  const auto positions = [&](const std::vector<Vec3>& xs, const std::vector<Vec3>& ys) {
    for (std::size_t i = 0; i < xs.size(); ++i)
      d.position = std::max(d.position, (xs[i] - (ys[i] - offset) / scale).norm());
  };
  const auto velocities = [&](const std::vector<Vec3>& xs, const std::vector<Vec3>& ys) {
    for (std::size_t i = 0; i < xs.size(); ++i) {
      d.velocity = std::max(d.velocity, (xs[i] - ys[i] / scale).norm());
      d.speed = std::max(d.speed, xs[i].norm());
    }
  };
  positions(a.particles.x_t1, b.particles.x_t1);
  velocities(a.particles.velocity, b.particles.velocity);
  for (std::size_t s = 0; s < a.surfaces.size(); ++s) {
    positions(a.surfaces[s].x_t1, b.surfaces[s].x_t1);
    velocities(a.surfaces[s].velocity, b.surfaces[s].velocity);
  }
  return d;
}

TEST(HardGeometry, far_from_the_origin_contact_gives_the_same_answer_or_is_refused) {
  Difference worst[2];
  for (const HostKind& host : host_kinds) {
    SCOPED_TRACE(host.name);
    const bool is_float = host.storage == Storage::float32;
    const double far = is_float ? 0x1p10 : 0x1p20;
    const Vec3 offset(far, -far, far);
    // δ is that of the far place in both: at the origin it would be smaller.
    const double thickness = 0x1p-4, r = far + 2;
    ContactScene here = busy_scene(host, 1, Vec3::Zero(), thickness, r);
    ContactScene there = busy_scene(host, 1, offset, thickness, r);
    const Found f = resolve_checked(here);
    EXPECT_GT(f.total.impacts, 0u);
    EXPECT_GT(f.total.contacts, 0u);
    resolve_checked(there);
    const Difference d = compare(here, there, 1, offset);
    // What contact moves is rounded to the host's numbers, which are coarser there: 0.1 mm in float.
    const double ulp = far * (is_float ? 0x1p-23 : 0x1p-52);
    EXPECT_LE(d.position, 1e-6 + 4 * ulp);
    EXPECT_LE(d.velocity, (1e-6 + 4 * ulp) * d.speed);
    Difference& w = worst[is_float ? 0 : 1];
    w.position = std::max(w.position, d.position);
    w.velocity = std::max(w.velocity, d.velocity / d.speed);
  }
  WorldSettings settings;
  settings.kill_box = {Vec3::Constant(-1e6), Vec3::Constant(1e6)};
  World w(settings);
  test::MockCloth<float> cloth;
  const Status refused = w.attach(cloth, test::sheet_settings(), nullptr);
  EXPECT_FALSE(refused.ok());
  EXPECT_NEAR(smallest_that_would_do(refused.message), 4 * 64 * 0x1p-23 * 1e6, 0.01);
  record_outcome("21", "2^20 m from the origin in double, 2^10 m in float; float at 1e6 m",
                 "positions differ by " + shown(worst[1].position) + " m (double), " +
                     shown(worst[0].position) + " m (float), velocities by " + shown(worst[1].velocity) +
                     " and " + shown(worst[0].velocity) +
                     " of the speed; float at 1e6 m refused: h must be ≥ 30.5 m");
}

TEST(HardGeometry, scaled_by_2_to_the_20_up_and_down_results_are_the_same_bit_for_bit) {
  std::uint64_t compared = 0;
  for (const HostKind& host : host_kinds)
    for (double scale : {0x1p-20, 0x1p20}) {
      SCOPED_TRACE(std::string(host.name) + ", scale " + shown(scale));
      ContactScene one = busy_scene(host, 1, Vec3::Zero(), 0x1p-4, 4);
      ContactScene other = busy_scene(host, scale, Vec3::Zero(), 0x1p-4 * scale, 4 * scale);
      const Found f = resolve_checked(one);
      const Found g = resolve_checked(other);
      EXPECT_GT(f.total.impacts, 0u);
      EXPECT_GT(f.total.contacts, 0u);
      EXPECT_EQ(f.total.impacts, g.total.impacts);
      EXPECT_EQ(f.total.contacts, g.total.contacts);
      const Difference d = compare(one, other, scale, Vec3::Zero());
      EXPECT_EQ(d.position, 0);
      EXPECT_EQ(d.velocity, 0);
      compared += one.particles.id.size() + one.surfaces[0].x_t0.size();
    }
  record_outcome("22", "the same scene 2^20 times smaller and larger",
                 "positions and velocities of " + count(compared) + " points: the same bits");
}

TEST(HardGeometry, with_nothing_or_one_of_everything_a_step_runs) {
  ContactScene nothing;
  resolve_checked(nothing);
  for (const HostKind& host : host_kinds) {
    SCOPED_TRACE(host.name);
    ContactScene no_particles;
    no_particles.surfaces = {square_sheet(host)};
    resolve_checked(no_particles);
    EXPECT_EQ(no_particles.surfaces[0].x_t1, square_sheet(host).x_t0);
    ContactScene no_surface;
    no_surface.particles.add(Vec3::Zero(), Vec3(0, -5000, 0), particle_mass);
    no_surface.move();
    resolve_checked(no_surface);
    EXPECT_EQ(no_surface.particles.x_t1[0], Vec3(0, -5, 0));
    ContactScene one;
    one.surfaces = {mesh_surface({{0, 0, 0}, {0.01, 0, 0}, {0, 0, 0.01}}, {{0, 1, 2}}, host.storage,
                                 mass_of_nodes(host))};
    one.particles.add(Vec3(0.003, 0.01, 0.003), Vec3(0, -20, 0), particle_mass);
    one.move();
    EXPECT_GT(resolve_checked(one).total.impacts, 0u);
  }
  World empty;
  EXPECT_TRUE(empty.step(1e-3).status.ok());
  test::StaticMesh no_triangles;
  no_triangles.nodes = {Vec3::Zero()};
  const Status refused = empty.attach(no_triangles, test::sheet_settings(), nullptr);
  EXPECT_NE(refused.message.find("no triangles"), std::string::npos);
  record_outcome("25", "no particle, no surface, one particle, one triangle; a surface without triangles",
                 "all run; a surface without triangles is refused when it is attached");
}

TEST(HardGeometry, duplicates_give_no_double_impulses_and_seams_that_are_not_welded_let_nothing_through) {
  // Twice and three times the same triangles, of either winding: the same bits as once.
  Found all;
  for (const HostKind& host : host_kinds) {
    SCOPED_TRACE(host.name);
    ContactScene once;
    once.surfaces = {square_sheet(host)};
    Random random(4);
    for (int k = 0; k < 40; ++k)
      once.particles.add(
          Vec3(random.uniform(-0.018, 0.018), random.uniform(0.0005, 0.004), random.uniform(-0.018, 0.018)),
          random.in_cube(1) - Vec3(0, 3, 0), particle_mass);
    ContactScene thrice = once;
    SurfaceMotion& s = thrice.surfaces[0];
    for (const Triangle& t : once.surfaces[0].triangles) s.triangles.push_back({t[2], t[1], t[0]});
    for (const Triangle& t : once.surfaces[0].triangles) s.triangles.push_back({t[1], t[2], t[0]});
    CheckedContact a(once), b(thrice);
    a.run(10);
    b.run(10);
    EXPECT_EQ(a.scene.particles.x_t1, b.scene.particles.x_t1);
    EXPECT_EQ(a.scene.surfaces[0].velocity, b.scene.surfaces[0].velocity);
    all.add(b.found);
  }
  // Two halves whose border nodes coincide but are not the same.
  std::uint64_t aimed = 0, through = 0;
  for (const HostKind& host : host_kinds)
    for (double speed : {3.0, 50.0, 500.0}) {
      SCOPED_TRACE(std::string(host.name) + " at " + shown(speed));
      ContactScene scene;
      for (double x : {-0.02, 0.0})
        scene.surfaces.push_back(test::make_grid(3, 5, Vec3(x, 0, -0.02), Vec3(0.02, 0, 0), Vec3(0, 0, 0.04),
                                                 mass_of_nodes(host), 0.001, 2, host.storage,
                                                 x < 0 ? 1u : 2u));
      Random random(6);
      for (double z : {-0.013, -0.01, -0.0042, 0.0, 0.0071, 0.01})
        for (double tilt : {0.0, 0.4}) {
          const Vec3 displacement =
              Vec3(tilt * random.uniform(-1, 1), -1, tilt * random.uniform(-1, 1)).normalized();
          scene.particles.add(Vec3(0, 0, z) - 0.5 * scene.dt * speed * displacement, speed * displacement,
                              particle_mass);
        }
      scene.move();
      std::vector<std::uint8_t> hits;
      for (std::size_t i = 0; i < scene.particles.id.size(); ++i) hits.push_back(exactly_meets(scene, i));
      all.add(resolve_checked(scene));
      if (host.free) continue;
      for (std::size_t i = 0; i < hits.size(); ++i) {
        aimed += hits[i];
        through += hits[i] && scene.particles.x_t1[i].y() <= 0;
      }
    }
  EXPECT_GT(aimed, 20u);
  EXPECT_EQ(through, 0u);
  EXPECT_EQ(all.total.removed, 0u);
  record_outcome("35", "each triangle three times, of either winding; two halves with a seam not welded",
                 "duplicates: the same bits as once; closed seam: " + count(through) + " of " + count(aimed) +
                     " through; " + count(all.audit.crossings + all.audit.touchings) + " crossings");
}

template <class Scalar>
Found brush_border(bool pinned, double beside, Vec3* impulse) {
  test::ClothSetup setup;
  setup.pinned = pinned;
  setup.world.gravity.setZero();
  impulse->setZero();
  const auto make = [&](int threads) {
    return std::make_unique<test::ClothScene<Scalar>>(
        setup, threads,
        [&](test::ClothScene<Scalar>& s) {
          DiscEmitter jet;
          jet.radius = 0.012;
          jet.center = Vec3(0.1 + beside, 0.03, 0.003);
          jet.speed = 4;
          jet.stop = 0.01;
          EXPECT_TRUE(s.world().add_emitter(jet).ok());
        },
        [impulse, threads](test::ClothScene<Scalar>& s, int k) {
          if (k > 0 && threads == 1)
            *impulse += s.world().report().contact.impulse_on_free_nodes +
                        s.world().report().contact.impulse_on_prescribed;
        });
  };
  return test::run_checked(make, 30, 1e-3);
}

TEST(HardGeometry, a_jet_that_brushes_an_open_border_passes_outside_and_none_of_it_through) {
  Found all;
  double half = 0, clear = 0;
  for (bool pinned : {true, false}) {
    Vec3 impulse;
    all.add(brush_border<float>(pinned, 0.0, &impulse));
    half = std::max(half, impulse.norm());
    all.add(brush_border<double>(pinned, 0.0, &impulse));
    // The nearest of the jet is 12 mm off its axis: 3 mm beside the border, farther than h and than it
    // spreads.
    all.add(brush_border<double>(pinned, 0.015, &impulse));
    clear = std::max(clear, impulse.norm());
  }
  EXPECT_GT(half, 0);
  EXPECT_EQ(clear, 0);
  record_outcome("36", "a 4 m/s jet half on the border of a sheet, and 3 mm beside it",
                 count(all.audit.particles) + " paths, " + count(all.audit.crossings + all.audit.touchings) +
                     " crossings; impulse " + shown(half) + " N s on it, " + shown(clear) + " beside it");
}

TEST(HardGeometry, through_a_hole_only_what_keeps_clear_of_its_rim_passes_and_cracks_are_holes) {
  Found all;
  std::uint64_t aimed = 0, passed = 0, touched = 0;
  for (const HostKind& host : host_kinds)
    for (double speed : {3.0, 500.0}) {
      SCOPED_TRACE(std::string(host.name) + " at " + shown(speed));
      ContactScene scene;
      SurfaceMotion sheet = square_sheet(host, 0.04, 9);
      // Cells around the middle node are missing: a square hole of 1 cm.
      const auto in_hole = [&](const Triangle& t) {
        return std::find(t.begin(), t.end(), 40u) != t.end() ||
               std::all_of(t.begin(), t.end(),
                           [&](std::uint32_t v) { return sheet.x_t0[v].cwiseAbs().maxCoeff() < 0.0051; });
      };
      sheet.triangles.erase(std::remove_if(sheet.triangles.begin(), sheet.triangles.end(), in_hole),
                            sheet.triangles.end());
      scene.surfaces = {sheet};
      for (double x : {0.0, 0.002, 0.0038, 0.0047, 0.005, 0.0053, 0.007})
        for (double z : {0.0, 0.0011, 0.005})
          scene.particles.add(Vec3(x, 0.5 * speed * scene.dt, z), Vec3(0, -speed, 0), particle_mass);
      scene.move();
      const ContactScene proposed = scene;
      std::vector<std::uint8_t> hits;
      for (std::size_t i = 0; i < scene.particles.id.size(); ++i) hits.push_back(exactly_meets(scene, i));
      all.add(resolve_checked(scene));
      for (std::size_t i = 0; i < hits.size(); ++i) {
        ++aimed;
        touched += hits[i];
        const bool is_through = scene.particles.x_t1[i].y() < 0;
        passed += is_through;
        if (hits[i] && !host.free) {
          EXPECT_FALSE(is_through) << "particle " << i;
        }
        const Vec3& from = proposed.particles.x_t0[i];
        if (std::max(from.x(), from.z()) < 0.0039) {  // beyond h of the rim
          EXPECT_EQ(scene.particles.x_t1[i], proposed.particles.x_t1[i])
              << "particle " << i << " is not free";
        }
      }
    }
  EXPECT_GT(passed, 0u);
  EXPECT_EQ(all.total.removed, 0u);
  record_outcome("37", "shots at a hole of 1 cm, its rim and the sheet around it",
                 count(aimed) + " shots, " + count(touched) + " truly meet the rim or the sheet, " +
                     count(passed) + " pass through the hole, " +
                     count(all.audit.crossings + all.audit.touchings) + " crossings");
}

TEST(HardGeometry, a_fan_of_ten_thousand_edges_around_one_vertex_is_correct_and_bounded) {
  Found all;
  const std::uint32_t spokes = 10000;
  std::uint64_t contacts = 0;
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
  EXPECT_EQ(all.total.removed, 0u);
  record_outcome(
      "42", "a fan of 10,000 edges around one vertex",
      shots(all) + "; " + count(all.total.candidates) + " candidates, " + count(contacts) + " records");
}

TEST(HardGeometry, huge_and_tiny_triangles_side_by_side_miss_no_pair) {
  Found all;
  std::uint64_t aimed = 0, maximum = 0;
  for (const HostKind& host : host_kinds) {
    SCOPED_TRACE(host.name);
    // A triangle of 1,000 spacings, and a sheet of triangles of a hundredth of a spacing over it.
    ContactScene scene;
    const double dx = scene.spacing;
    scene.surfaces = {
        mesh_surface({{-500 * dx, 0, -500 * dx}, {500 * dx, 0, -500 * dx}, {0, 0, 500 * dx}}, {{0, 1, 2}},
                     host.storage, mass_of_nodes(host), 0.001, 5, 1),
        test::make_grid(41, 41, Vec3(-20 * dx / 100, 0.02, -20 * dx / 100), Vec3(40 * dx / 100, 0, 0),
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
    for (std::size_t i = 0; i < scene.particles.id.size(); ++i) aimed += exactly_meets(scene, i);
    const Found f = resolve_checked(scene);
    all.add(f);
    maximum = std::max(maximum, f.total.candidates);
  }
  EXPECT_GT(aimed, 400u);
  EXPECT_EQ(all.total.removed, 0u);
  record_outcome("43", "a triangle of 1,000 spacings under a sheet of triangles of dx/100, 200 shots each",
                 shots(all) + ", " + count(aimed) + " true hits, at most " + count(maximum) +
                     " candidates of " + count(200ull * 3201) + " pairs");
}

// A zigzag of `layers` folds within `height`, crumpled by noise that makes folds pass through each other.
void crumple(std::vector<Vec3>& x, std::uint32_t nu, std::uint32_t nv, int layers, double height,
             double width, double noise) {
  Random random(16);
  for (std::uint32_t j = 0; j < nv; ++j)
    for (std::uint32_t i = 0; i < nu; ++i) {
      const double along = static_cast<double>(i) / (nu - 1) * layers;
      const double fold = std::floor(std::min(along, layers - 1e-9)), part = along - fold;
      const double u = static_cast<int>(fold) % 2 ? 1 - part : part;
      x[i + nu * j] = Vec3(width * (u - 0.5), height * along / layers, width * (j / (nv - 1.0) - 0.5)) +
                      random.in_cube(noise);
    }
}

TEST(HardGeometry, crumpled_cloth_of_twelve_layers_through_each_other_lets_nothing_cross) {
  Found all;
  const std::uint32_t nu = 12 * 6 + 1, nv = 9;
  for (const HostKind& host : host_kinds) {
    SCOPED_TRACE(host.name);
    ContactScene scene;
    SurfaceMotion s = test::make_grid(nu, nv, Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 0, 1), mass_of_nodes(host),
                                      0.001, 2, host.storage);
    crumple(s.x_t0, nu, nv, 12, 0.01, 0.04, 0.0015);
    for (Vec3& x : s.x_t0) x = stored(x, host.storage);
    s.x_t1 = s.x_t0;
    Random random(2);
    scene.surfaces = {s};
    // A hail on it from all sides, and particles that begin between the layers where there is room.
    for (int k = 0; k < 120; ++k) {
      const Vec3 out = random.direction();
      scene.particles.add(Vec3(0, 0.005, 0) + 0.06 * out, -random.log_uniform(5, 500) * out, particle_mass);
    }
    for (int k = 0; k < 400; ++k) {
      const Vec3 x(random.uniform(-0.02, 0.02), random.uniform(0, 0.01), random.uniform(-0.02, 0.02));
      double minimum = 1;
      for (const Triangle& t : s.triangles)
        minimum = std::min(minimum, closest_point(x, s.x_t0[t[0]], s.x_t0[t[1]], s.x_t0[t[2]]).distance);
      if (minimum > 2 * s.delta) scene.particles.add(x, random.in_cube(20), particle_mass);
    }
    for (Vec3& v : scene.surfaces[0].velocity) v = host.free ? random.in_cube(5) : Vec3(0, 1, 0);
    CheckedContact check(scene);
    check.run(4);
    EXPECT_EQ(check.found.total.removed, 0u);
    all.add(check.found);
  }
  record_outcome("16", "contact alone: 12 crumpled layers within 10 mm, passing through each other",
                 count(all.audit.particles) + " paths, " + count(all.audit.crossings + all.audit.touchings) +
                     " crossings, " + count(all.total.zone_rounds) + " zone rounds, " +
                     count(all.total.removed) + " removed");
}

template <class Scalar>
class CrumpledPool : public test::WorldScene {
 public:
  CrumpledPool(int threads, double* density) : density_(density) {
    test::GridShape shape;
    shape.nu = 61, shape.nv = 9;
    shape.areal_density = 2;
    cloth_ = std::make_unique<test::MockCloth<Scalar>>(shape);
    std::vector<Vec3> x(cloth_->x.size());
    crumple(x, 61, 9, 12, 0.01, 0.05, 0.0008);
    for (std::size_t i = 0; i < x.size(); ++i) {
      cloth_->x[i] = x[i].template cast<Scalar>();
      cloth_->pin(i);
    }
    WorldSettings settings;
    settings.kill_box = {Vec3::Constant(-1), Vec3::Constant(1)};
    settings.threads = threads;
    FluidSettings fluid;
    fluid.boundary = BoundaryModel::mirrored;
    world_ = std::make_unique<World>(settings, fluid);
    EXPECT_TRUE(world_->attach(*cloth_, test::sheet_settings(), nullptr).ok());
    floor_.add_rectangle(Vec3(-0.2, -0.03, -0.2), Vec3(0.4, 0, 0), Vec3(0, 0, 0.4), 4, 4);
    EXPECT_TRUE(world_->attach(floor_, test::sheet_settings(), nullptr).ok());
    std::vector<Vec3> start, v;
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j < 10; ++j)
        for (int k = 0; k < 8; ++k) {
          start.push_back(0.005 * Vec3(i - 3.5, j + 3.5, k - 3.5));
          v.push_back(Vec3(0, -1, 0));
        }
    EXPECT_TRUE(world_->add_particles(start, v).ok());
  }
  World& world() override { return *world_; }
  void after_step(int) override {
    for (double d : world_->densities()) *density_ = std::max(*density_, d / 1000);
  }

 private:
  std::unique_ptr<test::MockCloth<Scalar>> cloth_;
  test::StaticMesh floor_;
  std::unique_ptr<World> world_;
  double* density_;
};

// The largest λ (share of its density that a particle gets from walls) on a lattice through the crumpled
// cloth.
float max_lambda() {
  test::StaticMesh mesh;
  mesh.add_rectangle(Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 0, 1), 60, 8);
  crumple(mesh.nodes, 61, 9, 12, 0.01, 0.05, 0.0008);
  SurfaceMotion surface = test::surface_of(mesh);
  SurfaceMotion* surfaces[] = {&surface};
  const MeshTopology topology(surface.triangles, surface.x_t0.size());
  const MeshTopology* topologies[] = {&topology};
  std::vector<Vec3> lattice, x;
  for (int i = 0; i < 24; ++i)
    for (int j = 0; j < 16; ++j)
      for (int k = 0; k < 24; ++k) lattice.push_back(0.0021 * Vec3(i - 11.5, j - 3.5, k - 11.5));
  const Workers workers(1);
  fluid::Neighbours neighbours;
  for (std::uint32_t i : neighbours.cell_order(lattice, 0.01, workers)) x.push_back(lattice[i]);
  neighbours.search(x, workers);
  fluid::Boundary boundary{2.0};
  boundary.find({1e-3, particle_mass, 0.01, Vec3::Zero(), x, neighbours, surfaces, topologies}, workers);
  float largest = 0;
  for (const fluid::WallPoint& p : boundary.points()) largest = std::max(largest, p.lambda);
  return largest;
}

TEST(HardGeometry, water_on_crumpled_cloth_never_gets_three_times_as_dense) {
  double density = 0;
  Found all;
  all.add(test::run_checked(
      [&](int threads) { return std::make_unique<CrumpledPool<float>>(threads, &density); }, 40, 1e-3));
  all.add(test::run_checked(
      [&](int threads) { return std::make_unique<CrumpledPool<double>>(threads, &density); }, 40, 1e-3));
  EXPECT_LT(density, 3);
  EXPECT_GT(all.total.impulse_on_prescribed.norm(), 0.05) << "N s: the water did not come down on it";
  const float lambda = max_lambda();
  EXPECT_GT(lambda, 0.5f);
  EXPECT_LE(lambda, 1.0f);
  record_outcome("16", "water with mirrored boundary terms falls on it",
                 count(all.audit.particles) + " paths, " + count(all.audit.crossings + all.audit.touchings) +
                     " crossings; density at most " + shown(density) + " ρ0, λ at most " + shown(lambda) +
                     ", largest speed " + shown(all.speed) + " m/s");
}

// What checks all of these can fail.
void let_a_particle_cross() {
  ContactScene scene;
  scene.settings.ccd = scene.settings.zones = false;
  scene.surfaces = {square_sheet(host_kinds[2])};
  scene.particles.add(Vec3(0.003, 0.02, 0.004), Vec3(0, -40, 0), particle_mass);
  scene.move();
  resolve_checked(scene);
}

TEST(HardGeometry, the_audit_finds_a_crossing_where_contact_does_not_look_along_paths) {
  EXPECT_NONFATAL_FAILURE(let_a_particle_cross(), "crossings");
}

}  // namespace
}  // namespace oilskin
