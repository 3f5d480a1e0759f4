// Hosts that break the rules of SurfaceHost: what they give is taken as a new mesh, or refused.
#include <gtest/gtest.h>

#include "oilskin/world.h"
#include "support/static_mesh.h"

namespace oilskin {
namespace {

/// Fills in its mesh in every step, and never says that it has changed.
class CarelessHost : public test::StaticMesh {
 public:
  Storage storage = Storage::float64;

  CarelessHost() { changes = Changes::unknown; }
  Gathered gather(double dt, SurfaceMotion& m) override {
    const bool is_first = m.triangles.empty();
    const Gathered gathered = StaticMesh::gather(dt, m);
    m.triangles = triangles;
    m.storage = storage;
    return {gathered.status, is_first};
  }
};

class CarelessHosts : public testing::Test {
 protected:
  CarelessHosts() : world_(WorldSettings(), FluidSettings(), contact()) {
    host_.add_rectangle(Vec3(-0.1, 0, -0.1), Vec3(0, 0, 0.2), Vec3(0.2, 0, 0), 4, 4);
    EXPECT_TRUE(world_.attach(host_, {}, &id_).ok());
    const Vec3 x[] = {Vec3(0.01, 0.05, 0.02)}, v[] = {Vec3(0, -1, 0)};
    EXPECT_TRUE(world_.add_particles(x, v).ok());
  }
  static ContactSettings contact() {
    ContactSettings s;
    s.verify = true;
    return s;
  }
  void step(int count) {
    for (int k = 0; k < count; ++k) {
      const StepReport& r = world_.step(0.002);
      ASSERT_TRUE(r.status.ok()) << r.status.message;
      EXPECT_EQ(r.contact.crossings_found_by_verify, 0u);
    }
  }
  double height() const { return world_.positions()[0].y(); }

  CarelessHost host_;
  World world_;
  SurfaceId id_;
};

TEST_F(CarelessHosts, a_mesh_that_loses_triangles_is_a_new_one) {
  step(2);
  const std::uint64_t before = world_.surface(id_)->id;
  host_.triangles.resize(10);
  step(2);
  EXPECT_NE(world_.surface(id_)->id, before);
  EXPECT_EQ(world_.surface(id_)->triangles.size(), 10u);
}

TEST_F(CarelessHosts, triangles_that_are_added_stop_water) {
  const std::vector<Triangle> all = host_.triangles;
  host_.triangles = {all.back()};
  step(2);
  host_.triangles = all;
  step(40);
  EXPECT_GT(height(), 0);
}

TEST_F(CarelessHosts, triangles_that_take_the_place_of_others_stop_water) {
  const std::vector<Triangle> all = host_.triangles;
  host_.triangles.assign(all.size(), all.back());
  step(2);
  host_.triangles = all;
  step(40);
  EXPECT_GT(height(), 0);
}

TEST_F(CarelessHosts, another_storage_makes_a_new_surface) {
  step(1);
  const double delta = world_.surface(id_)->delta;
  for (Vec3& x : host_.nodes) x = stored(x, Storage::float32);
  host_.storage = Storage::float32;
  step(1);
  EXPECT_GT(world_.surface(id_)->delta, delta);
}

TEST_F(CarelessHosts, an_index_that_is_out_of_range_leaves_the_surface_out) {
  step(1);
  host_.triangles[3][1] = 25;
  const StepReport& r = world_.step(0.002);
  EXPECT_TRUE(r.status.ok());
  EXPECT_NE(r.flags & flag_surface_refused, 0u);
  ASSERT_FALSE(r.messages.empty());
  EXPECT_NE(r.messages[0].find("triangle 3 has the node index 25"), std::string::npos) << r.messages[0];
}

TEST_F(CarelessHosts, a_host_is_attached_once) {
  const Status again = world_.attach(host_, {}, nullptr);
  EXPECT_NE(again.message.find("the host is attached already"), std::string::npos) << again.message;
  EXPECT_EQ(world_.surface_count(), 1u);
  world_.detach(id_);
  EXPECT_TRUE(world_.attach(host_, {}, &id_).ok());
}

TEST_F(CarelessHosts, a_thickness_beyond_all_lengths_is_refused) {
  CarelessHost other;
  other.nodes = host_.nodes;
  other.triangles = host_.triangles;
  SurfaceSettings settings;
  settings.thickness = 1e15;
  EXPECT_NE(world_.attach(other, settings, nullptr).message.find("< 1e15 m"), std::string::npos);
}

}  // namespace
}  // namespace oilskin
