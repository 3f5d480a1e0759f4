// More particles in one place than lists of neighbours can hold: the step is refused, and nothing is lost.
#include <gtest/gtest.h>

#include "fluid/neighbours.h"
#include "support/random.h"
#include "world/driven_sheet.h"

namespace oilskin::test {
namespace {

std::vector<Vec3> at(const Vec3& place, std::size_t count) {
  return std::vector<Vec3>(count, place);
}

TEST(Crowd, of_twenty_thousand_particles_in_one_point_is_refused_and_changes_nothing) {
  for (const int threads : {1, 2}) {
    World w(box(0.5, Vec3(0, -9.81, 0), threads), cut_into(4));
    Driven sheet(0.2);
    SurfaceId id;
    ASSERT_TRUE(w.attach(sheet, SurfaceSettings(), &id).ok());
    DiscEmitter nozzle;
    nozzle.center = Vec3(0.1, 0.1, 0.1);
    ASSERT_TRUE(w.add_emitter(nozzle).ok());
    ASSERT_TRUE(w.step(1e-3).status.ok());
    const std::size_t before = w.particle_count();
    const std::vector<Vec3> crowd = at(Vec3(0, 0.05, 0), 20000);
    ASSERT_TRUE(w.add_particles(crowd, std::vector<Vec3>(crowd.size(), Vec3::Zero())).ok());
    const std::uint64_t hash = w.state_hash();
    const int writes = sheet.writes;
    const StepReport& r = w.step(1e-3);
    EXPECT_NE(r.status.message.find("20000 lie in a cube"), std::string::npos) << r.status.message;
    EXPECT_EQ(r.substeps, 0);
    EXPECT_EQ(r.alive, before + 20000);
    EXPECT_EQ(w.state_hash(), hash);
    EXPECT_EQ(sheet.writes, writes) << "the host keeps its motion";
    EXPECT_EQ(w.step_count(), 1u);
    std::uint64_t removed = 0;
    ASSERT_TRUE(w.remove_particles(Box{Vec3(-0.01, 0.04, -0.01), Vec3(0.01, 0.06, 0.01)}, &removed).ok());
    EXPECT_EQ(removed, 20000u);
    EXPECT_TRUE(w.step(1e-3).status.ok());
    EXPECT_EQ(w.step_count(), 2u);
  }
}

/// Ten times as dense as water, which nothing but a mistake makes, still runs.
TEST(Crowd, of_ten_times_the_density_of_water_is_not_one) {
  World w(box(0.5), cut_into(1));
  Random random(1);
  const double spacing = w.fluid_settings().spacing;
  std::vector<Vec3> x;
  for (int i = 0; i < 10 * 1000; ++i) x.push_back(random.in_cube(5 * spacing));
  ASSERT_TRUE(w.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())).ok());
  EXPECT_TRUE(w.step(1e-4).status.ok());
}

TEST(Crowd, is_counted_by_pairs_in_adjacent_cells) {
  const Workers workers(1);
  fluid::Neighbours neighbours;
  const auto search = [&](std::vector<Vec3> x) {
    neighbours.cell_order(x, 0.01, workers);
    neighbours.search(x, workers);
  };
  EXPECT_NO_THROW(search(at(Vec3(0.005, 0.005, 0.005), 5000)));  // 2.5e7 of 2.7e7
  EXPECT_THROW(search(at(Vec3(0.005, 0.005, 0.005), 6000)), fluid::TooCrowded);
  std::vector<Vec3> apart = at(Vec3(0.005, 0.005, 0.005), 4000);
  for (int i = 0; i < 4000; ++i) apart.emplace_back(1, 1, 1);
  EXPECT_NO_THROW(search(apart)) << "3.2e7 of 3.3e7";
}

}  // namespace
}  // namespace oilskin::test
