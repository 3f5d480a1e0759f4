// Candidates through the rounds of an interval: whatever moves, no pair that may intersect is left out, and
// few particles are queried again where little moves.
#include "contact/candidates.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/particle_arrays.h"
#include "support/random.h"
#include "support/surface_of.h"

namespace oilskin::contact {
namespace {

struct Creep;

/// Particles around a sheet of free nodes, all of which move a little.
class Rounds : public testing::TestWithParam<int> {
 protected:
  static constexpr std::size_t count = 3000;

  Rounds() : random_(7), workers_(GetParam()) {
    test::StaticMesh mesh;
    mesh.add_rectangle(Vec3(-0.1, 0, -0.1), Vec3(0.2, 0, 0), Vec3(0, 0, 0.2), 24, 24);
    surface_ = test::surface_of(mesh, 1);
    for (std::size_t i = 0; i < surface_.x_t0.size(); ++i) {
      surface_.x_t0[i] += random_.in_cube(0.002);
      surface_.x_t1[i] = surface_.x_t0[i] + random_.in_cube(0.001);
    }
    // Sorted in space, as those of a fluid: groups are of consecutive particles.
    for (std::size_t p = 0; p < count; ++p) {
      const double along = -0.12 + 0.24 * double(p) / double(count);
      const Vec3 x(along, random_.uniform(-0.01, 0.01), random_.uniform(-0.12, 0.12));
      particles_.add(x, Vec3::Zero(), 1);
      particles_.x_t1.back() += random_.in_cube(0.002);
    }
    motion_ = particles_.motion();
    geometry_.analyse(surface_);
    context_.dt = 0.001;
    context_.settings = &settings_;
    context_.workers = &workers_;
    context_.particles = &motion_;
    context_.liquids.emplace_back(motion_);
    context_.surfaces = surfaces_;
    context_.geometry = geometries_;
    context_.particle_stamp.assign(count, 1);
    context_.out_of_play.assign(count, 0);
    context_.node_stamp.resize(1);
    context_.surface_stamp.assign(1, 0);
  }

  void move_node(double by = 0.01) { move_node(nodes(), by, 0); }
  void move_node(std::size_t below, double by, double up) {
    const std::uint32_t node = random_.below(std::uint32_t(below));
    context_.set_node_end(0, node, surface_.x_t1[node] + random_.in_cube(by) + Vec3(0, up, 0));
  }
  std::size_t nodes() const { return surface_.x_t1.size(); }
  void move_particle(double by = 0.01, double up = 0) {
    const std::uint32_t p = random_.below(std::uint32_t(count));
    if (!context_.out_of_play[p])
      context_.set_particle_end(p, motion_.x_t1[p] + random_.in_cube(by) + Vec3(0, up, 0));
  }
  void creep(const Creep& creep);
  /// By all pairs: what may intersect is among the candidates. Returns the number of such pairs.
  std::size_t expect_complete() {
    std::vector<Box> swept(surface_.triangles.size());
    for (std::size_t t = 0; t < swept.size(); ++t)
      for (const std::uint32_t v : surface_.triangles[t]) {
        swept[t].add(surface_.x_t0[v]);
        swept[t].add(surface_.x_t1[v]);
      }
    std::size_t pairs = 0;
    for (std::uint32_t p = 0; p < count; ++p) {
      if (context_.out_of_play[p]) continue;
      Box path;
      path.add(motion_.x_t0[p]);
      path.add(motion_.x_t1[p]);
      path = path.inflated(2 * surface_.delta);
      const Span<const std::uint32_t> near = candidates_.surfaces_near(p);
      const Span<CandidatePair> found = near.empty() ? Span<CandidatePair>() : candidates_.of(0, p);
      for (std::uint32_t t = 0; t < surface_.triangles.size(); ++t) {
        if (!swept[t].overlaps(path)) continue;
        ++pairs;
        const bool is_there = std::any_of(found.begin(), found.end(),
                                          [t](const CandidatePair& pair) { return pair.triangle == t; });
        EXPECT_TRUE(is_there) << "particle " << p << ", triangle " << t;
      }
    }
    return pairs;
  }

  test::Random random_;
  Workers workers_;
  ContactSettings settings_;
  SurfaceMotion surface_;
  SurfaceGeometry geometry_;
  test::ParticleArrays particles_;
  ParticleMotion motion_;
  SurfaceMotion* surfaces_[1] = {&surface_};
  SurfaceGeometry* geometries_[1] = {&geometry_};
  Context context_;
  CandidateSet candidates_;
};

TEST_P(Rounds, keep_the_candidates_complete) {
  candidates_.collect(context_);
  std::size_t pairs = expect_complete(), few = 0;
  for (int round = 0; round < 24; ++round) {
    const int nodes = round % 6 == 5 ? 200 : round % 4;
    ++context_.epoch;
    for (int n = 0; n < nodes; ++n) move_node();
    for (int n = 0; n < 5; ++n) move_particle();
    if (round % 5 == 0) context_.out_of_play[random_.below(std::uint32_t(count))] = 1;
    const std::vector<std::uint32_t> queried = candidates_.refresh(context_);
    EXPECT_TRUE(std::is_sorted(queried.begin(), queried.end()));
    few += nodes < 4 && queried.size() < count / 5;
    pairs += expect_complete();
  }
  EXPECT_GT(pairs, 10000u) << "the case tests nothing";
  EXPECT_EQ(few, 20u) << "where few nodes move, few particles are queried again";
}

/// Nodes of the first ones that go up and particles that go down, in a round [m].
struct Creep {
  std::size_t nodes;
  int moves;
  double up;
  int particle_moves;
  double down;
};

void Rounds::creep(const Creep& creep) {
  candidates_.collect(context_);
  std::size_t pairs = 0, none = 0;
  constexpr int rounds = 120;
  for (int round = 0; round < rounds; ++round) {
    ++context_.epoch;
    for (int n = 0; n < creep.moves; ++n) move_node(creep.nodes, 2e-5, creep.up);
    for (int n = 0; n < creep.particle_moves; ++n) move_particle(1e-4, -creep.down);
    none += candidates_.refresh(context_).empty();
    pairs += expect_complete();
  }
  EXPECT_GT(pairs, 10000u) << "the case tests nothing";
  EXPECT_GT(none, 0u) << "the tree may keep boxes that triangles leave by little";
  EXPECT_LT(none, std::size_t(rounds));
}

TEST_P(Rounds, keep_the_candidates_complete_where_a_sheet_creeps) {
  creep({nodes(), 100, 3e-5, 1000, 3e-4});
}

TEST_P(Rounds, keep_the_candidates_complete_where_a_part_of_a_sheet_creeps) {
  creep({50, 2, 3e-4, 300, 3e-4});
}

/// So many that all lists are made anew in between.
TEST_P(Rounds, keep_the_candidates_complete_through_hundreds) {
  candidates_.collect(context_);
  std::size_t all = 0;
  for (int round = 0; round < 400; ++round) {
    ++context_.epoch;
    move_node();
    all += candidates_.refresh(context_).size() > count / 2;
  }
  EXPECT_GT(all, 0u);
  EXPECT_LT(all, 40u);
  expect_complete();
}

INSTANTIATE_TEST_SUITE_P(Threads, Rounds, testing::Values(1, 2));

}  // namespace
}  // namespace oilskin::contact
