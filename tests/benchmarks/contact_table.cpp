// Tables 1 and 2 of [Huber2013] with our stages: what a smaller thickness and no-slip cost over the scene
// `jet`. One row for each thickness and slip law; seconds of wall time over the whole run, without `verify`
// and pictures.
//
// use: contact_table [simulated seconds = 0.5] [threads = 0, all]
#include <cstdio>
#include <cstdlib>

#include "checks/totals.h"
#include "hosts/bullet_simulation.h"
#include "scene/scene_library.h"

using namespace oilskin;
using namespace oilskin::demo;

namespace {

struct Row {
  double thickness;
  const char* slip;
};

void print_row(const Row& row, double duration, int threads) {
  RunOptions options;
  options.scene = "jet";
  options.duration = duration;
  options.set = {"cloth.0.thickness=" + std::to_string(row.thickness),
                 std::string("cloth.0.slip={\"model\": \"") + row.slip + "\"}", "contact.verify=false"};
  const Scene scene = load_scene(options);
  SimulationOptions simulation_options;
  simulation_options.threads = threads;
  const auto simulation = make_simulation(scene, simulation_options);
  Totals totals;
  while (totals.simulated < duration - 0.5 * scene.dt) totals.add(simulation->step(scene.dt));
  const StageSeconds& s = totals.seconds;
  const double fluid = s.neighbours + s.pressure + s.other_fluid;
  const double contact = s.gather + s.proximity + s.impulses + s.ccd + s.zones;
  std::printf("%8.4f  %-14s %7.2f %7.2f %9.2f %8.2f %8.2f %6.2f %6.2f %7.2f %8.2f %9llu %9llu %6llu\n",
              row.thickness, row.slip, simulation->host_seconds(), fluid, contact, s.proximity, s.impulses,
              s.ccd, s.zones, s.gather, contact / fluid,
              static_cast<unsigned long long>(totals.contact.contacts),
              static_cast<unsigned long long>(totals.contact.impacts),
              static_cast<unsigned long long>(totals.contact.zone_rounds));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const double duration = argc > 1 ? std::atof(argv[1]) : 0.5;
  const int threads = argc > 2 ? std::atoi(argv[2]) : 0;
  std::printf("jet, %.2f s simulated; seconds of wall time\n", duration);
  std::printf(
      "   h [m]  slip             cloth   fluid   contact proximity impulses   ccd  zones  gather  "
      "contact/fluid  "
      "contacts  meetings  zones\n");
  for (const Row& row : {Row{0.0005, "free"}, Row{0.001, "free"}, Row{0.001, "strict_no_slip"},
                         Row{0.005, "free"}, Row{0.0005, "strict_no_slip"}, Row{0.005, "strict_no_slip"}})
    print_row(row, duration, threads);
  std::printf(
      "The paper (i7-2600), h = 0.0005: cloth 26.8, fluid 2.97, contact 29.3; 0.001: 26.3, 2.95, 25.3; 0.001 "
      "no-slip: "
      "27.0, 3.21, 21.4; 0.005: 27.7, 3.66, 7.2\n");
  return 0;
}
