/// A world with sheets of mock cloth, for hard cases that need fluid.
#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "hard_cases/invariants.h"
#include "support/mock_cloth.h"
#include "support/world_helpers.h"

namespace oilskin::test {

struct ClothSetup {
  WorldSettings world;
  FluidSettings fluid;
  ContactSettings contact;
  GridShape shape;
  int layers = 1;
  double layer_gap = 0.01;  ///< downwards [m]
  bool pinned = false;      ///< every node
  double stiffness = 200;   ///< of springs [N/m]
  Vec3 cloth_gravity = Vec3::Zero();

  ClothSetup() {
    fluid.boundary = BoundaryModel::contact_only;
    world.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
    shape.nu = shape.nv = 9;
    shape.origin = Vec3(-0.1, 0, -0.1);
    shape.u = Vec3(0.2, 0, 0);
    shape.v = Vec3(0, 0, 0.2);
  }
};

template <class Scalar>
class ClothScene : public WorldScene {
 public:
  using Hook = std::function<void(ClothScene&, int)>;

  /// `fill` puts fluid in and changes the cloth before it is attached; `before` runs before each step.
  ClothScene(const ClothSetup& setup, int threads, const std::function<void(ClothScene&)>& fill = {},
             Hook before = {})
      : before_(std::move(before)) {
    WorldSettings settings = setup.world;
    settings.threads = threads;
    world_ = std::make_unique<World>(settings, setup.fluid, setup.contact);
    for (int k = 0; k < setup.layers; ++k) {
      GridShape shape = setup.shape;
      shape.origin.y() -= k * setup.layer_gap;
      cloths.push_back(std::make_unique<MockCloth<Scalar>>(shape));
      cloths.back()->gravity = setup.cloth_gravity;
      cloths.back()->stiffness = setup.stiffness;
      if (setup.pinned)
        for (std::size_t i = 0; i < cloths.back()->x.size(); ++i) cloths.back()->pin(i);
    }
    if (fill) fill(*this);
    for (auto& cloth : cloths) {
      SurfaceId id;
      const Status s = world_->attach(*cloth, sheet_settings(), &id);
      EXPECT_TRUE(s.ok()) << s.message;
      ids.push_back(id);
    }
  }
  World& world() override { return *world_; }
  void before_step(int k) override {
    if (before_) before_(*this, k);
  }
  Vec3 momentum() const {
    Vec3 sum = fluid_momentum(*world_);
    for (const auto& cloth : cloths) sum += cloth->momentum();
    return sum;
  }

  std::vector<std::unique_ptr<MockCloth<Scalar>>> cloths;
  std::vector<SurfaceId> ids;

 private:
  std::unique_ptr<World> world_;
  Hook before_;
};

}  // namespace oilskin::test
