#include "fluid/emission/emission.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/kernels.h"

namespace oilskin::fluid {
namespace {

constexpr double dx = 0.005, rho = 1000, mass = rho * dx * dx * dx;
constexpr double infinity = std::numeric_limits<double>::infinity();

Emission make() {
  return Emission(dx, rho, mass);
}

constexpr Outcome go = Outcome::emitted, no = Outcome::blocked;

std::vector<Outcome> all(std::size_t count, Outcome outcome) {
  return std::vector<Outcome>(count, outcome);
}

DiscEmitter jet(double radius = 5 * dx, double speed = 2) {
  DiscEmitter e;
  e.center = Vec3(0.1, 0.2, 0.3);
  e.direction = Vec3(1, -2, 0.5);
  e.radius = radius;
  e.speed = speed;
  return e;
}

/// Starts over [0, duration) in steps of dt.
std::vector<Start> run(Emission& emission, double duration, double dt, std::vector<double>* times = nullptr) {
  std::vector<Start> found;
  for (int step = 0; step * dt < duration - 1e-9 * dt; ++step) {
    const std::vector<Start>& starts = emission.due(step * dt, dt);
    for (const Start& s : starts) {
      found.push_back(s);
      if (times) times->push_back((step + 1) * dt - s.remaining);
    }
    EXPECT_EQ(emission.settle(all(starts.size(), go)), 0u);
  }
  return found;
}

/// (F.37): the distance of layers [m] of a nozzle with the sites of `layer`.
double layer_distance(const DiscEmitter& e, const std::vector<Start>& layer) {
  return static_cast<double>(layer.size()) * mass / (rho * pi * e.radius * e.radius);
}

TEST(Emission, layers_of_a_nozzle_lie_on_the_lattice_around_the_axis_and_are_a_spacing_apart_or_more) {
  for (double r = 0.5; r < 12; r += 0.0173) {
    Emission emission = make();
    const DiscEmitter e = jet(r * dx);
    ASSERT_TRUE(emission.add(e).ok());
    const std::vector<Start> layer = emission.due(0, 1e-6);
    const Vec3 axis = e.direction.normalized();
    const double distance = layer_distance(e, layer) / dx;
    EXPECT_GE(distance, 1) << r << " spacings: layers on top of each other";
    EXPECT_LE((distance - 1) * pi * r * r, 3 + 1e-9) << r << " spacings: sites that it does not need";
    Vec3 sum = Vec3::Zero();
    double nearest = infinity;
    for (const Start& a : layer) {
      sum += a.position - e.center;
      EXPECT_NEAR((a.position - e.center).dot(axis), 0, 1e-12);
      EXPECT_LE((a.position - e.center).norm(), e.radius + 0.75 * dx);
      EXPECT_LT((a.velocity - 2 * axis).norm(), 1e-12);
      for (const Start& b : layer)
        if (&a < &b && layer.size() < 100) nearest = std::min(nearest, (a.position - b.position).norm());
    }
    EXPECT_LT(sum.norm(), 1e-12) << "the middle is on the axis";
    EXPECT_GT(nearest, dx * (1 - 1e-12));
  }
}

TEST(Emission, nozzle_carries_its_mass_flow) {
  for (const double radius : {0.5 * dx, dx, 1.38 * dx, 2.5 * dx, 4.4 * dx, 5 * dx, 9.7 * dx}) {
    Emission emission = make();
    const DiscEmitter e = jet(radius);
    ASSERT_TRUE(emission.add(e).ok());
    const double layer = layer_distance(e, emission.due(0, 1e-9));
    const double duration = 199.5 * layer / e.speed;  // 200 layers
    Emission again = make();
    ASSERT_TRUE(again.add(e).ok());
    const double emitted = mass * static_cast<double>(run(again, duration, 1.0e-3 * duration).size());
    EXPECT_NEAR(emitted / (rho * pi * radius * radius * e.speed * duration), 1, 0.005) << radius / dx;
  }
}

TEST(Emission, what_is_emitted_does_not_depend_on_the_step) {
  std::vector<double> reference;
  for (const double dt : {0.1, 0.016, 1e-3, 3.7e-4}) {
    Emission emission = make();
    ASSERT_TRUE(emission.add(jet()).ok());
    RainEmitter rain;
    rain.drops_per_second = 700;
    ASSERT_TRUE(emission.add(rain).ok());
    std::vector<double> times;
    run(emission, 0.592, dt, &times);  // 0.592 s is a multiple of two of the steps only
    times.erase(std::remove_if(times.begin(), times.end(), [](double t) { return t >= 0.59; }), times.end());
    std::sort(times.begin(), times.end());
    if (reference.empty()) reference = times;
    ASSERT_EQ(times.size(), reference.size()) << dt;
    for (std::size_t i = 0; i < times.size(); ++i) ASSERT_NEAR(times[i], reference[i], 1e-12);
  }
}

TEST(Emission, remaining_is_the_rest_of_the_step) {
  Emission emission = make();
  DiscEmitter e = jet(dx, 20);
  e.start = 0.25;
  ASSERT_TRUE(emission.add(e).ok());
  EXPECT_TRUE(emission.due(0, 0.25).empty());
  const std::vector<Start> starts = emission.due(0.25, 0.02);
  ASSERT_GT(starts.size(), 4 * 10u);  // a fast nozzle sends many layers within a step
  EXPECT_EQ(starts.front().remaining, 0.02);
  for (std::size_t i = 4; i < starts.size(); i += 4) EXPECT_LT(starts[i].remaining, starts[i - 4].remaining);
  for (const Start& s : starts) EXPECT_GT(s.remaining, 0);
}

TEST(Emission, stops_at_its_end_and_skips_what_came_before_the_first_call) {
  Emission emission = make();
  DiscEmitter e = jet();
  e.stop = 0.1;
  ASSERT_TRUE(emission.add(e).ok());
  EXPECT_LE(emission.due(0.05, 1e-3).size(), 80u);
  EXPECT_NEAR(static_cast<double>(emission.due(0.051, 0.1).size()), 80 * 0.049 * 2 / (1.0186 * dx), 80);
  EXPECT_TRUE(emission.due(0.151, 1).empty());
}

TEST(Emission, blocked_sites_wait_once_each) {
  Emission emission = make();
  ASSERT_TRUE(emission.add(jet(dx, 1)).ok());  // 4 sites, a layer every 6.4 ms
  ASSERT_EQ(emission.due(0, 1e-3).size(), 4u);
  const std::vector<Outcome> blocked = {go, no, no, no};
  EXPECT_EQ(emission.settle(blocked), 3u);
  std::vector<Start> again = emission.due(1e-3, 1e-3);
  ASSERT_EQ(again.size(), 3u);
  for (const Start& s : again) EXPECT_EQ(s.remaining, 1e-3);
  EXPECT_EQ(emission.settle(std::vector<Outcome>{go, no, no}), 2u);
  // A long step with many layers: the two that waited come first, and only one start of a site waits at its
  // end.
  again = emission.due(2e-3, 0.1);
  ASSERT_GT(again.size(), 2u + 4 * 14);
  EXPECT_EQ(again[0].remaining, 0.1);
  EXPECT_EQ(again[1].remaining, 0.1);
  EXPECT_EQ(emission.settle(all(again.size(), no)), again.size());
  EXPECT_EQ(emission.due(0.102, 1e-9).size(), 4u);
}

TEST(Emission, start_right_behind_one_that_waited_is_lost) {
  Emission emission = make();
  ASSERT_TRUE(emission.add(jet(dx, 1)).ok());
  ASSERT_EQ(emission.due(0, 6.3e-3).size(), 4u);
  EXPECT_EQ(emission.settle(std::vector<Outcome>{go, go, no, go}), 1u);
  // The next layer falls due within 0.1 ms; the site that waited sends one start, not two on top of each
  // other.
  EXPECT_EQ(emission.due(6.3e-3, 1e-3).size(), 4u);
}

TEST(Emission, boxes_fill_once_and_lose_what_is_blocked) {
  Emission emission = make();
  BoxEmitter e;
  e.box.min = Vec3(0, 0, 0);
  e.box.max = Vec3(10, 4, 3) * dx;
  e.velocity = Vec3(1, 2, 3);
  e.start = 0.0105;
  ASSERT_TRUE(emission.add(e).ok());
  EXPECT_TRUE(emission.due(0, 0.01).empty());
  const std::vector<Start> starts = emission.due(0.01, 1e-3);
  ASSERT_EQ(starts.size(), 120u);
  for (const Start& s : starts) {
    EXPECT_TRUE(e.box.inflated(-0.49 * dx).contains(s.position));
    EXPECT_EQ(s.velocity, e.velocity);
    EXPECT_NEAR(s.remaining, 5e-4, 1e-12);
  }
  EXPECT_EQ(emission.settle(all(120, no)), 120u);
  EXPECT_TRUE(emission.due(0.011, 1).empty());
}

TEST(Emission, roll_back_repeats_the_starts) {
  Emission emission = make();
  ASSERT_TRUE(emission.add(jet()).ok());
  BoxEmitter box;
  box.box = {Vec3::Zero(), Vec3(4, 4, 4) * dx};
  box.start = 0.0105;
  ASSERT_TRUE(emission.add(box).ok());
  emission.settle(all(emission.due(0, 0.01).size(), no));
  emission.checkpoint();
  const std::vector<Start> first = emission.due(0.01, 0.01);
  emission.settle(all(first.size(), go));
  emission.roll_back();
  const std::vector<Start> again = emission.due(0.01, 0.01);
  ASSERT_EQ(again.size(), first.size());
  EXPECT_GT(first.size(), 64u + 80 + 80) << "those that waited, a layer and the box";
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_EQ(again[k].position, first[k].position);
    EXPECT_EQ(again[k].remaining, first[k].remaining);
  }
  emission.settle(all(again.size(), go));
  emission.commit(0.02);
  for (const Start& s : emission.due(0.02, 0.01)) EXPECT_GT(s.velocity.norm(), 0) << "no second box";
}

TEST(Emission, rain_is_a_function_of_its_seed) {
  auto rain = [](std::uint64_t seed, double radius) {
    Emission emission = make();
    RainEmitter e;
    e.corner = Vec3(-1, 2, -1);
    e.edge_u = Vec3(2, 0, 0);
    e.edge_v = Vec3(0, 0, 2);
    e.drop_radius = radius;
    e.seed = seed;
    EXPECT_TRUE(emission.add(e).ok());
    return run(emission, 1, 0.01);
  };
  const std::vector<Start> a = rain(1, 0), b = rain(1, 0), c = rain(2, 0);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_NEAR(static_cast<double>(a.size()), 1000, 1);
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].position, b[i].position);
    EXPECT_EQ(a[i].position.y(), 2);
    EXPECT_LE(std::max(std::abs(a[i].position.x()), std::abs(a[i].position.z())), 1);
    mean += a[i].position / static_cast<double>(a.size());
  }
  EXPECT_LT((mean - Vec3(0, 2, 0)).norm(), 0.08);
  EXPECT_NE(a[0].position, c[0].position);
  EXPECT_EQ(rain(1, dx).size(), 7 * a.size());  // lattice ball of radius dx: a point and six around it
}

TEST(Emission, refuses_invalid_settings_with_a_message) {
  Emission emission = make();
  auto refused = [&](auto change, auto emitter, const char* word) {
    change(emitter);
    const Status s = emission.add(emitter);
    EXPECT_FALSE(s.ok());
    EXPECT_NE(s.message.find(word), std::string::npos) << s.message;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused([&](DiscEmitter& e) { e.center.x() = nan; }, jet(), "center");
  refused([&](DiscEmitter& e) { e.direction.setZero(); }, jet(), "direction");
  refused([&](DiscEmitter& e) { e.radius = 0; }, jet(), "radius");
  refused([&](DiscEmitter& e) { e.radius = infinity; }, jet(), "radius");
  refused([&](DiscEmitter& e) { e.radius = 0.49 * dx; }, jet(), "radius");
  refused([&](DiscEmitter& e) { e.radius = 1001 * dx; }, jet(), "radius");
  refused([&](DiscEmitter& e) { e.speed = -1; }, jet(), "speed");
  refused([&](DiscEmitter& e) { e.speed = 1e200; }, jet(), "speed");
  refused([&](DiscEmitter& e) { e.start = nan; }, jet(), "start");
  refused([&](DiscEmitter& e) { e.stop = -1; }, jet(), "stop");
  BoxEmitter box;
  refused([&](BoxEmitter&) {}, box, "box.min");
  box.box = {Vec3::Zero(), Vec3(1, 1, 0.001)};
  refused([&](BoxEmitter&) {}, box, "no particle fits in");
  refused([&](BoxEmitter& e) { std::swap(e.box.min, e.box.max); }, box, "at least box.min");
  refused([&](BoxEmitter& e) { e.box.max = Vec3::Constant(1e6); }, box, "5e7");
  refused([&](RainEmitter& e) { e.drops_per_second = 0; }, RainEmitter{}, "drops_per_second");
  refused([&](RainEmitter& e) { e.edge_u.z() = nan; }, RainEmitter{}, "edge_u");
  refused([&](RainEmitter& e) { e.drop_radius = -1; }, RainEmitter{}, "drop_radius");
  refused([&](RainEmitter& e) { e.drop_radius = 201 * dx; }, RainEmitter{}, "200 spacings");
  MeshEmitter mesh;
  refused([&](MeshEmitter&) {}, mesh, "no triangles");
  mesh.vertices = {Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  mesh.triangles = {{0, 1, 3}};
  refused([&](MeshEmitter&) {}, mesh, "vertex 3");
  mesh.triangles = {{0, 1, 2}};
  refused([&](MeshEmitter&) {}, mesh, "no point of the lattice");
  refused([&](MeshEmitter& e) { e.vertices[1].y() = infinity; }, mesh, "vertex 1");
  EXPECT_TRUE(emission.due(0, 1).empty());
}

// --- meshes

MeshEmitter cuboid(const Vec3& size) {
  MeshEmitter m;
  for (int i = 0; i < 8; ++i)
    m.vertices.push_back(Vec3((i & 1) * size[0], ((i >> 1) & 1) * size[1], ((i >> 2) & 1) * size[2]));
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

/// Rings of longitude and latitude: poles and rings lie exactly on rows of the lattice.
MeshEmitter sphere(double radius, std::uint32_t rings, std::uint32_t sectors) {
  MeshEmitter m;
  m.vertices.push_back(Vec3(0, 0, radius));
  for (std::uint32_t r = 1; r < rings; ++r)
    for (std::uint32_t s = 0; s < sectors; ++s) {
      const double theta = pi * r / rings, phi = 2 * pi * s / sectors;
      m.vertices.push_back(
          radius * Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)));
    }
  m.vertices.push_back(Vec3(0, 0, -radius));
  const std::uint32_t last = static_cast<std::uint32_t>(m.vertices.size()) - 1;
  auto at = [&](std::uint32_t r, std::uint32_t s) { return 1 + (r - 1) * sectors + s % sectors; };
  for (std::uint32_t s = 0; s < sectors; ++s) {
    m.triangles.push_back({0, at(1, s), at(1, s + 1)});
    m.triangles.push_back({last, at(rings - 1, s + 1), at(rings - 1, s)});
    for (std::uint32_t r = 1; r + 1 < rings; ++r) {
      m.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      m.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
  }
  return m;
}

std::vector<Vec3> inside(const MeshEmitter& mesh, double spacing) {
  std::vector<Vec3> points;
  const Status s = lattice_inside(mesh, spacing, &points);
  EXPECT_TRUE(s.ok()) << s.message;
  return points;
}

TEST(MeshFill, cube_on_the_lattice_is_exact) {
  EXPECT_EQ(inside(cuboid(Vec3(10, 10, 10) * dx), dx).size(), 1000u);
  EXPECT_EQ(inside(cuboid(Vec3(7, 4, 9) * dx), dx).size(), 7u * 4 * 9);
  MeshEmitter reversed = cuboid(Vec3(7, 4, 9) * dx);
  for (Triangle& t : reversed.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(inside(reversed, dx).size(), 7u * 4 * 9);
}

TEST(MeshFill, sphere_has_its_volume) {
  for (const double spacing : {0.05, 0.0425, 0.033}) {
    const double radius = 0.5;
    const std::vector<Vec3> points = inside(sphere(radius, 40, 64), spacing);
    const double volume = static_cast<double>(points.size()) * std::pow(spacing, 3);
    EXPECT_NEAR(volume / (4.0 / 3 * pi * std::pow(radius, 3)), 1, 0.03) << spacing;
    for (const Vec3& p : points) EXPECT_LT(p.norm(), radius);
  }
}

TEST(MeshFill, many_faces_and_points_take_no_time) {
  // 5,000 faces and 120,000 points; a minute here would mean a test of every pair.
  EXPECT_GT(inside(sphere(0.5, 50, 51), 0.0163).size(), 100000u);
}

TEST(MeshFill, vertices_exactly_on_rows) {
  // An octahedron whose corners and edges all lie on rows of the lattice.
  MeshEmitter m;
  const double r = 0.055;  // 22 half spacings: an odd number of points per axis, one through the centre
  for (int k = 0; k < 3; ++k)
    for (const double sign : {-1.0, 1.0}) m.vertices.push_back(sign * r * Vec3::Unit(k));
  for (std::uint32_t a = 0; a < 2; ++a)
    for (std::uint32_t b = 2; b < 4; ++b)
      for (std::uint32_t c = 4; c < 6; ++c) {
        const bool even = (a + b + c) % 2 != 0;
        m.triangles.push_back(even ? Triangle{a, b, c} : Triangle{a, c, b});
      }
  std::size_t strictly_inside = 0;
  const double spacing = 0.01;
  const std::vector<Vec3> points = inside(m, spacing);
  for (int a = -6; a <= 6; ++a)
    for (int b = -6; b <= 6; ++b)
      for (int c = -6; c <= 6; ++c) strictly_inside += std::abs(a) + std::abs(b) + std::abs(c) <= 5;
  EXPECT_EQ(points.size(), strictly_inside);
  for (const Vec3& p : points) EXPECT_LT(p.lpNorm<1>(), r);
}

TEST(MeshFill, overlapping_shells_and_cavities) {
  MeshEmitter two = cuboid(Vec3(8, 8, 8) * dx);  // a second shell inside, same orientation: still inside
  MeshEmitter inner = cuboid(Vec3(4, 4, 4) * dx);
  const std::uint32_t base = 8;
  for (const Vec3& v : inner.vertices) two.vertices.push_back(v + Vec3::Constant(2 * dx));
  MeshEmitter hollow = two;
  for (const Triangle& t : inner.triangles) {
    two.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    hollow.triangles.push_back({t[1] + base, t[0] + base, t[2] + base});
  }
  EXPECT_EQ(inside(two, dx).size(), 512u);
  EXPECT_EQ(inside(hollow, dx).size(), 512u - 64);
}

TEST(MeshFill, open_mesh_falls_back_to_solid_angles) {
  MeshEmitter open = cuboid(Vec3(8, 8, 8) * dx);
  open.triangles.resize(10);  // without the face at +x
  const std::size_t n = inside(open, dx).size();
  EXPECT_GT(n, 300u);
  EXPECT_LE(n, 512u);
}

TEST(MeshFill, emitter_starts_all_points_once) {
  Emission emission = make();
  MeshEmitter mesh = cuboid(Vec3(5, 5, 5) * dx);
  mesh.velocity = Vec3(0, -1, 0);
  ASSERT_TRUE(emission.add(mesh).ok());
  EXPECT_EQ(emission.due(0, 1e-3).size(), 125u);
  EXPECT_TRUE(emission.due(1e-3, 1e-3).empty());
}

}  // namespace
}  // namespace oilskin::fluid
