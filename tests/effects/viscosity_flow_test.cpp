#include "support/channel_flow.h"
#include "support/record.h"
#include <cstdio>
#include <cstdlib>
#include <chrono>
namespace oilskin { namespace {
using test::Channel; using test::ChannelFlow;
TEST(Probe, all) {
  for (auto b : {BoundaryModel::contact_only, BoundaryModel::mirrored})
  for (bool couette : {false,true})
  for (double nu : {0.1, 1.0}) {
    Channel c; c.solver = b==BoundaryModel::mirrored?PressureSolver::dfsph:PressureSolver::pcisph; c.boundary=b; c.viscosity=nu; c.dt=1e-3; c.implicit=true;
    c.across = 8; if (couette) { c.poiseuille=0; c.couette=0.01; }
    ChannelFlow f(c);
    auto t0=std::chrono::steady_clock::now(); int it=0, n=0;
    double end = nu<0.05?0.5: nu<0.5? 0.8:std::getenv("END")?std::atof(std::getenv("END")):1.2;
    while (f.time()<end-1e-9) { f.step(); it+=f.effect().report().iterations; ++n; }
    double s=std::chrono::duration<double>(std::chrono::steady_clock::now()-t0).count();
    double ref = couette? f.moving_wall():f.peak();
    double dxx=f.width/c.across;
    std::printf("%s %s nu %g: steps %d it/step %.1f s %.2f maxdev %.4f mid %.4f first %.4f(%.4f) second %.4f(%.4f) stress %.4f %.4f bal %.4f applied %g conv %d\n", b==BoundaryModel::mirrored?"mirr":"cont", couette?"couette":"pois", nu, n, double(it)/n, s, f.max_deviation()/ref, (f.velocity(0.025)-f.exact(0.025))/ref,
      f.velocity(dxx/2)/ref, f.exact(dxx/2)/ref, f.velocity(1.5*dxx)/ref, f.exact(1.5*dxx)/ref, f.wall_stress(0)/ (couette? f.density*nu*f.moving_wall()/f.width:f.stress_by_balance()), f.wall_stress(1)/(couette? f.density*nu*f.moving_wall()/f.width:f.stress_by_balance()), f.stress_by_balance(), f.effect().report().applied, f.effect().report().converged);
  }
}
}}
