#include "proximity/surface_tree.h"

#include <gtest/gtest.h>

#include "meshes.h"

namespace oilskin::proximity {
namespace {

using namespace proximity_test;

void expect_exact(const SurfaceTree& tree, const MovingMesh& mesh, const std::vector<Box>& boxes) {
  const Workers workers(2);
  Candidates found;
  tree.query(boxes, workers, found);
  ASSERT_EQ(found.begin.size(), boxes.size() + 1);
  EXPECT_EQ(found.begin.back(), found.triangle.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const auto row = found.of(i);
    const bool empty = boxes[i].min.x() > boxes[i].max.x();
    const auto expected = empty ? std::vector<std::uint32_t>() : brute_force(mesh, boxes[i]);
    ASSERT_EQ(std::vector<std::uint32_t>(row.begin(), row.end()), expected) << "box " << i;
    if (i % 50) continue;
    std::vector<std::uint32_t> single = {7};
    tree.query(boxes[i], single);
    ASSERT_EQ(single.size(), expected.size() + 1);
    EXPECT_EQ(single.front(), 7u) << "appends";
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), single.begin() + 1));
  }
}

/// Several steps: the mesh ends each where it starts the next.
void walk(MovingMesh mesh, double distance, const std::vector<Box>& boxes, Random& random,
          Hierarchy hierarchy) {
  SurfaceTree tree;
  for (int step = 0; step < 3; ++step) {
    tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(2), hierarchy);
    expect_exact(tree, mesh, boxes);
    mesh.x_t0 = mesh.x_t1;
    move(mesh, distance, random);
  }
}

class EveryHierarchy : public testing::TestWithParam<Hierarchy> {};
INSTANTIATE_TEST_SUITE_P(SurfaceTree, EveryHierarchy, testing::Values(Hierarchy::flat, Hierarchy::fcl),
                         [](const auto& test) { return test.param == Hierarchy::flat ? "flat" : "fcl"; });

TEST_P(EveryHierarchy, finds_exactly_what_brute_force_finds_on_moving_sheets) {
  Random random(1);
  for (double distance : {0.0, 0.002, 0.2}) {
    const auto boxes = particle_boxes(400, 1, 0.01, 0.005, random);
    walk(sheet(24, distance, random), distance, boxes, random, GetParam());
  }
}

TEST_P(EveryHierarchy, finds_exactly_what_brute_force_finds_on_soups) {
  Random random(2);
  walk(soup(60, 500, 0.1, random), 0.1, particle_boxes(300, 1, 0.3, 0.01, random), random, GetParam());
  walk(soup(3, 200, 0.1, random), 0.1, particle_boxes(300, 1, 0.3, 0.01, random), random, GetParam());
}

TEST_P(EveryHierarchy, finds_exactly_what_brute_force_finds_among_huge_and_tiny_triangles) {
  Random random(3);
  walk(huge_and_tiny(500, random), 0.01, particle_boxes(300, 1, 0.1, 0.001, random), random, GetParam());
}

TEST_P(EveryHierarchy, finds_exactly_what_brute_force_finds_on_fans_of_ten_thousand) {
  Random random(4);
  // At the hub every box reaches thousands of triangles; away from it few.
  const auto mesh = fan(10000, 0.001, random);
  SurfaceTree tree;
  tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
  auto boxes = particle_boxes(64, 0.02, 0.01, 0.001, random);
  const auto far = particle_boxes(64, 1, 0.01, 0.001, random);
  boxes.insert(boxes.end(), far.begin(), far.end());
  expect_exact(tree, mesh, boxes);
}

TEST_P(EveryHierarchy, long_sweeps_and_blocks_of_distant_particles_are_exact) {
  Random random(5);
  const auto mesh = sheet(40, 0.01, random);
  SurfaceTree tree;
  tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
  for (double sweep : {0.0, 0.05, 2.0})
    expect_exact(tree, mesh, particle_boxes(200, 1, sweep, 0.001, random));
}

TEST_P(EveryHierarchy, touching_boxes_overlap) {
  MovingMesh mesh;
  mesh.triangles = {{0, 1, 2}};
  mesh.x_t0 = mesh.x_t1 = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)};
  SurfaceTree tree;
  tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
  std::vector<std::uint32_t> found;
  tree.query({Vec3(1, 0, 1), Vec3(2, 0, 2)}, found);
  EXPECT_EQ(found.size(), 1u);
  tree.query({Vec3(std::nextafter(1.0, 2.0), 0, 1), Vec3(2, 0, 2)}, found);
  EXPECT_EQ(found.size(), 1u);
}

TEST_P(EveryHierarchy, no_triangles_give_no_candidates) {
  SurfaceTree tree;
  const Workers workers(1);
  const std::vector<Box> boxes(20, Box{Vec3::Zero(), Vec3::Ones()});
  Candidates found;
  tree.query(boxes, workers, found);
  EXPECT_TRUE(found.triangle.empty());
  const std::vector<Vec3> nodes(5, Vec3::Zero());
  tree.update({}, nodes, nodes, Workers(1), GetParam());
  tree.query(boxes, workers, found);
  EXPECT_EQ(found.begin, std::vector<std::uint32_t>(21, 0));
  EXPECT_GT(tree.bounds().min.x(), tree.bounds().max.x());
  tree.query(Span<const Box>(), workers, found);
  EXPECT_EQ(found.begin.size(), 1u);
}

TEST_P(EveryHierarchy, one_degenerate_and_many_duplicate_triangles_are_fine) {
  Random random(6);
  MovingMesh mesh;
  mesh.x_t0 = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)};
  move(mesh, 0.1, random);
  const auto boxes = particle_boxes(100, 1, 0.1, 0.01, random);
  for (const auto& triangles : {std::vector<Triangle>{{0, 1, 2}}, std::vector<Triangle>{{1, 1, 1}},
                                std::vector<Triangle>(1000, Triangle{0, 1, 2}),
                                std::vector<Triangle>{{0, 1, 2}, {2, 1, 0}, {0, 0, 1}}}) {
    mesh.triangles = triangles;
    SurfaceTree tree;
    tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
    EXPECT_EQ(tree.builds(), 1u);
    expect_exact(tree, mesh, boxes);
  }
}

TEST_P(EveryHierarchy, deep_trees_of_crowding_centroids_are_traversed) {
  Random random(7);
  MovingMesh mesh;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    for (int k = 0; k < 3; ++k) mesh.x_t0.push_back(Vec3::Constant(std::pow(0.5, i)) + random.in_cube(1e-9));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  mesh.x_t1 = mesh.x_t0;
  SurfaceTree tree;
  tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
  expect_exact(tree, mesh, particle_boxes(100, 0.01, 0.01, 0.001, random));
}

TEST_P(EveryHierarchy, sweep_starts_at_the_corrected_positions_not_at_the_last_proposal) {
  Random random(8);
  auto mesh = sheet(12, 0.01, random);
  SurfaceTree tree;
  tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
  for (int step = 0; step < 20; ++step) {
    // Contact moved nodes after the proposal was handed to the tree: far enough to leave all old boxes.
    for (Vec3& x : mesh.x_t1) x += Vec3(0, 0.5 + 0.1 * step, 0) + random.in_cube(0.2);
    mesh.x_t0 = mesh.x_t1;
    move(mesh, 0.01, random);
    tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (std::uint32_t node : mesh.triangles[t]) {
        std::vector<std::uint32_t> found;
        tree.query({mesh.x_t0[node], mesh.x_t0[node]}, found);
        ASSERT_TRUE(std::binary_search(found.begin(), found.end(), t)) << "step " << step;
      }
    }
    expect_exact(tree, mesh, particle_boxes(50, 1, 0.1, 0.05, random));
  }
}

TEST_P(EveryHierarchy, first_build_already_sweeps) {
  MovingMesh mesh;
  mesh.triangles = {{0, 1, 2}};
  mesh.x_t0 = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)};
  for (const Vec3& x : mesh.x_t0) mesh.x_t1.push_back(x + Vec3(0, 5, 0));
  SurfaceTree tree;
  tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
  EXPECT_EQ(tree.bounds().min, Vec3(0, 0, 0));
  EXPECT_EQ(tree.bounds().max, Vec3(1, 5, 1));
}

TEST_P(EveryHierarchy, refits_while_the_mesh_keeps_its_size_and_rebuilds_when_it_grows) {
  Random random(9);
  auto mesh = sheet(16, 0.0, random);
  SurfaceTree tree;
  for (int step = 0; step < 50; ++step) {
    tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
    mesh.x_t0 = mesh.x_t1;
    for (Vec3& x : mesh.x_t1) x += Vec3(0.003, 0.001, 0);
  }
  EXPECT_EQ(tree.builds(), 1u);
  for (Vec3& x : mesh.x_t1) x *= 2.5;
  mesh.x_t0 = mesh.x_t1;
  tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
  EXPECT_EQ(tree.builds(), 2u);
  expect_exact(tree, mesh, particle_boxes(100, 2, 0.1, 0.05, random));
  tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
  EXPECT_EQ(tree.builds(), 2u) << "the size after the last build counts";
}

TEST_P(EveryHierarchy, rebuilds_when_neighbours_in_the_tree_drift_apart) {
  Random random(10);
  auto mesh = soup(300, 0, 0, random);
  for (std::uint32_t i = 0; i < 100; ++i) mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  auto place = [&](double spread) {
    for (std::uint32_t i = 0; i < 100; ++i) {
      const Vec3 c = random.in_cube(spread);
      for (std::uint32_t k = 0; k < 3; ++k) mesh.x_t0[3 * i + k] = c + Vec3::Unit(k) * 0.01;
    }
    mesh.x_t1 = mesh.x_t0;
  };
  SurfaceTree tree;
  place(1);
  tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
  place(4);  // leaves as large as before, the tree above them not
  tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
  EXPECT_EQ(tree.builds(), 2u);
}

TEST_P(EveryHierarchy, changed_topology_is_a_new_tree) {
  Random random(11);
  const auto boxes = particle_boxes(100, 1, 0.1, 0.02, random);
  SurfaceTree tree;
  std::size_t builds = 0;
  auto mesh = sheet(10, 0.01, random);
  auto update = [&] {
    tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
    EXPECT_EQ(tree.builds(), ++builds);
    expect_exact(tree, mesh, boxes);
  };
  update();
  std::swap(mesh.triangles[3], mesh.triangles[90]);  // same triangles, other numbers
  update();
  mesh.triangles.pop_back();
  update();
  mesh = sheet(14, 0.01, random);
  update();
  mesh.x_t0.emplace_back(9, 9, 9);  // a node more, unused
  mesh.x_t1.emplace_back(9, 9, 9);
  update();
  tree.update({}, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
  update();
}

TEST_P(EveryHierarchy, any_number_of_threads_gives_the_same_candidates) {
  Random random(12);
  const auto mesh = sheet(40, 0.01, random);
  SurfaceTree tree;
  tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
  const auto boxes = particle_boxes(5000, 1, 0.02, 0.01, random);
  Candidates one, many;
  tree.query(boxes, Workers(1), one);
  for (int threads : {2, 3, 7}) {
    tree.query(boxes, Workers(threads), many);
    EXPECT_EQ(one.begin, many.begin);
    EXPECT_EQ(one.triangle, many.triangle);
  }
}

TEST_P(EveryHierarchy, notices_that_only_one_end_of_the_motion_changed) {
  Random random(14);
  auto mesh = sheet(10, 0, random);
  const auto boxes = particle_boxes(100, 1, 0.1, 0.02, random);
  SurfaceTree tree;
  for (int step = 0; step < 6; ++step) {
    // Nothing, the end, nothing, the start, …: one node far away is enough.
    if (step % 4 == 1) mesh.x_t1[37] += Vec3(0, 0.4, 0);
    if (step % 4 == 3) mesh.x_t0[12] -= Vec3(0, 0.4, 0);
    tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
    expect_exact(tree, mesh, boxes);
  }
}

TEST(SurfaceTree, hierarchies_may_alternate) {
  Random random(15);
  auto mesh = sheet(12, 0.01, random);
  const auto boxes = particle_boxes(100, 1, 0.1, 0.02, random);
  SurfaceTree tree;
  for (int step = 0; step < 6; ++step) {
    const Hierarchy hierarchy = step % 3 == 1 ? Hierarchy::fcl : Hierarchy::flat;
    tree.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), hierarchy);
    expect_exact(tree, mesh, boxes);
    if (step % 2 == 0) continue;  // the same motion for the other
    mesh.x_t0 = mesh.x_t1;
    move(mesh, 0.002, random);
  }
  EXPECT_EQ(tree.builds(), 1u);
}

TEST_P(EveryHierarchy, can_be_moved) {
  Random random(13);
  const auto mesh = sheet(10, 0.01, random);
  SurfaceTree a;
  a.update(mesh.triangles, mesh.x_t0, mesh.x_t1, Workers(1), GetParam());
  SurfaceTree b = std::move(a);
  expect_exact(b, mesh, particle_boxes(50, 1, 0.1, 0.02, random));
}

}  // namespace
}  // namespace oilskin::proximity
