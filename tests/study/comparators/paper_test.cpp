// [Huber2013] Fig. 4: at a thickness of 1 mm and steps of 1 ms, repulsion alone leaks, with the continuous
// test nothing does.
#include "method_helpers.h"
#include "study/comparators/leak_table.h"

namespace oilskin::study {
namespace {

LeakResult jet(Method method, double dt, double speed) {
  LeakCase c;
  c.method = method, c.dt = dt, c.speed = speed;
  c.layers = 5, c.duration = 0.02;
  return run(c);
}

TEST(Paper, repulsion_alone_leaks_and_the_continuous_test_stops_that) {
  const LeakResult repulsion = jet(Method::repulsion, 1e-3, 3);
  EXPECT_GT(repulsion.leaks.beyond, repulsion.particles / 10);
  EXPECT_EQ(jet(Method::paper, 1e-3, 3).leaks.passages, 0u);
}

TEST(Paper, the_library_does_not_leak_where_discrete_methods_do) {
  EXPECT_EQ(jet(Method::oilskin, 1.0 / 60, 50).leaks.passages, 0u);
  for (Method discrete :
       {Method::repulsion, Method::penalty, Method::boundary_particles, Method::position_based}) {
    const LeakResult r = jet(discrete, 1.0 / 60, 50);
    EXPECT_GT(r.leaks.beyond, r.particles / 2) << name_of(discrete);
  }
}

}  // namespace
}  // namespace oilskin::study
