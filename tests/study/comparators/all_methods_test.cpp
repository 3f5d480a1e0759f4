// What holds for every method, behind the one interface.
#include "method_helpers.h"
#include "study/comparators/leak_table.h"
#include "study/comparators/water_cases.h"

namespace oilskin::study {
namespace {

TEST(AllMethods, momentum_of_water_and_free_sheet_is_kept) {
  for (Method which : all_methods) {
    const std::unique_ptr<CouplingMethod> method = make_method(which, weightless());
    SheetSettings shape;
    shape.size = 0.1, shape.cells = 10, shape.held = Held::none, shape.areal_density = 2;
    Sheet sheet(shape);
    ASSERT_TRUE(method->attach(sheet.host()).ok());
    add_water(*method, {Vec3(-0.015, 0.005, -0.015), Vec3(0.015, 0.02, 0.015)}, Vec3(0.1, -1, 0.2));
    const Vec3 start = method->momentum();
    for (int k = 0; k < 30; ++k) {
      sheet.advance(1e-3, Vec3::Zero());
      ASSERT_TRUE(method->step(1e-3).ok());
    }
    EXPECT_LT((method->momentum() + sheet_momentum(*method) - start).norm(), 1e-9 * start.norm())
        << name_of(which);
    EXPECT_LT(sheet_momentum(*method).y(), 0.05 * start.y()) << name_of(which) << ": the sheet is pushed";
  }
}

TEST(AllMethods, what_the_water_loses_the_prescribed_sheet_gets) {
  for (Method which : all_methods) {
    const std::unique_ptr<CouplingMethod> method = make_method(which, weightless());
    Sheet sheet(rigid());
    ASSERT_TRUE(method->attach(sheet.host()).ok());
    add_water(*method, {Vec3(-0.015, 0.005, -0.015), Vec3(0.015, 0.02, 0.015)}, Vec3(0, -1, 0));
    for (int k = 0; k < 20; ++k) {
      const Vec3 before = method->momentum();
      sheet.advance(1e-3, Vec3::Zero());
      ASSERT_TRUE(method->step(1e-3).ok());
      const Vec3 gained = load_of(method->surface(0)).impulse;
      ASSERT_LT((method->momentum() + gained - before).norm(), 1e-11) << name_of(which) << " step " << k;
    }
  }
}

TEST(AllMethods, a_drop_far_from_everything_falls_freely) {
  for (Method which : all_methods) {
    const std::unique_ptr<CouplingMethod> method = make_method(which, {});
    const Vec3 x(0, 1, 0), v(1, 2, 0);
    ASSERT_TRUE(method->add_particles(Span<const Vec3>(&x, 1), Span<const Vec3>(&v, 1)).ok());
    for (int k = 0; k < 100; ++k) ASSERT_TRUE(method->step(1e-3).ok());
    EXPECT_NEAR(method->velocities()[0].y(), 2 - 0.981, 1e-10) << name_of(which);
    EXPECT_NEAR(method->positions()[0].x(), 0.1, 1e-12) << name_of(which);
    EXPECT_EQ(method->ids()[0], 1u) << name_of(which);
  }
}

TEST(AllMethods, settings_out_of_range_are_refused) {
  MethodSettings settings;
  settings.spacing = -1;
  for (Method which : all_methods) EXPECT_THROW(make_method(which, settings), std::invalid_argument);
  for (Method which : all_methods) EXPECT_FALSE(make_method(which, {})->step(-1).ok());
}

/// Tank and column of the study, shorter.
TEST(AllMethods, the_floor_of_a_tank_carries_the_weight_of_the_water) {
  for (Method which : all_methods) {
    ColumnCase column;
    column.method = which, column.layers = 8, column.duration = 0.2;
    const ColumnResult result = run(column);
    EXPECT_EQ(result.leaks.particles, 0u) << name_of(which);
    EXPECT_NEAR(result.force_over_weight, 1, 1e-6) << name_of(which);
  }
}

}  // namespace
}  // namespace oilskin::study
