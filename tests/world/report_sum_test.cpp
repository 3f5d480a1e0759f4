// StepReport::add(): the report of several steps.
#include <gtest/gtest.h>

#include "oilskin/world.h"

namespace oilskin {
namespace {

StepReport report_of(std::uint64_t step, double dt) {
  StepReport r;
  r.step = step;
  r.dt = dt;
  r.time = dt * static_cast<double>(step + 1);
  r.substeps = 1;
  return r;
}

TEST(ReportSum, counts_are_added_limits_are_kept_and_the_ends_are_those_of_first_and_last) {
  StepReport a = report_of(4, 0.5), b = report_of(5, 0.25);
  a.emitted = 3, b.emitted = 4;
  a.alive = 30, b.alive = 34;
  a.substeps_needed = 7, b.substeps_needed = 2;
  a.substeps_left_out = 2, b.substeps_left_out = 1;
  b.iteration_limit = 9;
  a.flags = flag_stalled, b.flags = flag_many_holds;
  a.momentum_before = Vec3(1, 0, 0), a.momentum_after = Vec3(2, 0, 0);
  b.momentum_before = Vec3(2, 0, 0), b.momentum_after = Vec3(5, 0, 0);
  a.momentum_gravity = Vec3(1, 0, 0), b.momentum_gravity = Vec3(3, 0, 0);
  a.fluid.density_error_max = 0.5, b.fluid.density_error_max = 0.1;
  a.fluid.converged = false;
  a.contact.contacts = 10, b.contact.contacts = 11;
  a.contact.min_distance = 0.5, b.contact.min_distance = 2;
  a.energy.made_in_step = 1, b.energy.made_in_step = 2;
  a.energy.max_speed = 9, b.energy.max_speed = 8;
  a.energy.water_kinetic = 4, b.energy.water_kinetic = 6;
  a.seconds.ccd = 1, b.seconds.ccd = 2;
  a.messages = {"one", "both"}, b.messages = {"both", "two"};

  StepReport sum;
  sum.add(a);
  EXPECT_EQ(sum.fluid.converged, false);
  sum.add(b);
  EXPECT_EQ(sum.dt, 0.75);
  EXPECT_EQ(sum.substeps, 2);
  EXPECT_EQ(sum.step, 5u);
  EXPECT_EQ(sum.emitted, 7u);
  EXPECT_EQ(sum.alive, 34u);
  EXPECT_EQ(sum.substeps_needed, 7);
  EXPECT_EQ(sum.substeps_left_out, 3);
  EXPECT_EQ(sum.iteration_limit, 9) << "0 is no limit";
  EXPECT_EQ(sum.flags, flag_stalled | flag_many_holds);
  EXPECT_EQ(sum.momentum_before, Vec3(1, 0, 0));
  EXPECT_EQ(sum.momentum_after, Vec3(5, 0, 0));
  EXPECT_EQ(sum.momentum_residual(), Vec3::Zero());
  EXPECT_EQ(sum.fluid.density_error_max, 0.5);
  EXPECT_FALSE(sum.fluid.converged);
  EXPECT_EQ(sum.contact.contacts, 21u);
  EXPECT_EQ(sum.contact.min_distance, 0.5);
  EXPECT_EQ(sum.energy.made_in_step, 3);
  EXPECT_EQ(sum.energy.max_speed, 9);
  EXPECT_EQ(sum.energy.water_kinetic, 6);
  EXPECT_EQ(sum.seconds.ccd, 3);
  EXPECT_EQ(sum.messages, (std::vector<std::string>{"one", "both", "two"}));
}

TEST(ReportSum,
     of_several_worlds_in_one_step_particles_and_momenta_are_added_and_the_step_is_the_first_ones) {
  StepReport a = report_of(4, 0.5), b = report_of(9, 0.5);
  a.substeps = b.substeps = 3;
  a.alive = 30, b.alive = 34;
  a.emitted = 3, b.emitted = 4;
  a.substeps_left_out = 2, b.substeps_left_out = 1;
  a.flags = flag_stalled, b.flags = flag_pressure_diverged;
  a.momentum_before = Vec3(1, 0, 0), a.momentum_after = Vec3(2, 0, 0), a.momentum_gravity = Vec3(1, 0, 0);
  b.momentum_before = Vec3(5, 0, 0), b.momentum_after = Vec3(9, 0, 0), b.momentum_gravity = Vec3(4, 0, 0);
  a.fluid.density_error_max = 0.1, b.fluid.density_error_max = 0.5;
  b.fluid.converged = false;
  a.contact.contacts = 10;
  a.energy.made = 7, b.energy.made = 1;
  a.energy.made_in_step = 2, b.energy.made_in_step = 1;
  b.messages = {"of the second"};
  a.add_world(b);
  EXPECT_EQ(a.step, 4u);
  EXPECT_EQ(a.time, 2.5);
  EXPECT_EQ(a.dt, 0.5);
  EXPECT_EQ(a.substeps, 3);
  EXPECT_EQ(a.alive, 64u);
  EXPECT_EQ(a.emitted, 7u);
  EXPECT_EQ(a.substeps_left_out, 2);
  EXPECT_EQ(a.flags, flag_stalled | flag_pressure_diverged);
  EXPECT_EQ(a.momentum_before, Vec3(6, 0, 0));
  EXPECT_EQ(a.momentum_after, Vec3(11, 0, 0));
  EXPECT_EQ(a.momentum_residual(), Vec3::Zero());
  EXPECT_EQ(a.fluid.density_error_max, 0.5);
  EXPECT_FALSE(a.fluid.converged);
  EXPECT_EQ(a.contact.contacts, 10u);
  EXPECT_EQ(a.energy.made, 7) << "of all of them";
  EXPECT_EQ(a.energy.made_in_step, 2);
  EXPECT_EQ(a.messages, std::vector<std::string>{"of the second"});
}

TEST(ReportSum, a_refused_step_adds_its_reason_alone) {
  StepReport sum, refused = report_of(0, 0.5), later = refused;
  sum.add(report_of(0, 0.5));
  refused.status = Status::refused("first");
  refused.emitted = 9;
  later.status = Status::refused("second");
  sum.add(refused);
  sum.add(later);
  EXPECT_EQ(sum.status.message, "first");
  EXPECT_EQ(sum.emitted, 0u);
  EXPECT_EQ(sum.dt, 0.5);
}

TEST(ReportSum, of_messages_that_differ_in_numbers_the_last_stays) {
  std::vector<std::string> list;
  for (const char* message : {"5 particles of surface 1", "2 particles of surface 2",
                              "1.5e+3 particles of surface 1", "no particles"})
    add_message(message, &list);
  EXPECT_EQ(list, (std::vector<std::string>{"1.5e+3 particles of surface 1", "2 particles of surface 2",
                                            "no particles"}));
}

TEST(ReportSum, messages_are_limited) {
  StepReport sum;
  for (int i = 0; i < 1000; ++i) {
    StepReport r = report_of(0, 1);
    r.messages = {std::string(static_cast<std::size_t>(i + 1), 'x')};
    sum.add(r);
  }
  EXPECT_EQ(sum.messages.size(), 256u);
}

TEST(ReportSum, a_falling_block_keeps_its_momentum_over_many_steps) {
  World world;
  BoxEmitter box;
  box.box = {Vec3::Constant(-0.02), Vec3::Constant(0.02)};
  ASSERT_TRUE(world.add_emitter(box).ok());
  StepReport sum;
  for (int i = 0; i < 20; ++i) sum.add(world.step(0.001));
  EXPECT_GT(sum.emitted, 100u);
  EXPECT_EQ(sum.emitted, world.particle_count());
  EXPECT_LT(sum.momentum_residual().norm(), 1e-14);
  EXPECT_GT(sum.momentum_gravity.norm(), 1e-3);
  EXPECT_EQ(sum.time, world.time());
}

}  // namespace
}  // namespace oilskin
