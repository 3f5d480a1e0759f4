/// A world whose settings, surfaces, emitters and events are drawn from a seed, and its judge.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fuzz/random_sheet.h"
#include "fuzz/random_world.h"
#include "oilskin/force_fields.h"
#include "oilskin/world.h"
#include "support/trace_watch.h"

namespace oilskin::test {

template <class T, std::size_t n>
T one_of(Random& random, const T (&values)[n]) {
  return values[random.below(n)];
}

inline bool chance(Random& random, double p) {
  return random.uniform() < p;
}

class DrawnWorld {
 public:
  DrawnWorld(std::uint64_t seed, bool large, int threads);
  WorldVerdict run();

 private:
  struct Sheet {
    std::unique_ptr<RandomSheet> host;
    SurfaceSettings settings;
    SurfaceId id;  ///< none while it is detached
    bool spoilt = false;
  };
  struct Drain {
    SinkId id;
    Region region;
    bool enabled = true;
  };
  struct Before {
    std::uint64_t alive = 0;
    double node_momentum = 0;   ///< Σ m |v|
    bool out_of_range = false;  ///< a surface proposes to be where δ was not chosen for
  };

  // Drawing
  void draw_settings(int threads);
  FluidSettings draw_fluid();
  ContactSettings draw_contact();
  SlipSettings draw_slip();
  SheetPlan draw_sheet();
  void add_sheet();
  void add_emitters();
  void add_water(std::uint32_t count);
  Vec3 place(double share = 0.3) { return arena_.center + random_.in_cube(share * arena_.half); }
  Vec3 beside_a_sheet();
  Vec3 speed();
  void describe();
  Vec3 place_of_field();
  Region draw_region();
  Force draw_force();
  void add_fields();

  // Running
  void disturb();
  void disturb_fields();
  void note_births(double time);
  void kick();
  void step();

  // Judging
  void expect(bool holds, const std::string& what);
  double node_momentum() const;
  void check_finite();
  void check_counts(const StepReport& r, const Before& before);
  void check_momentum(const StepReport& r, const Before& before);
  void check_energy(const StepReport& r);
  void check_promise(const StepReport& r);
  void check_fields(const StepReport& r);
  bool nothing_is_driven() const;

  Random random_, fields_random_;
  const std::uint64_t seed_;
  const bool large_;
  double dx_ = 0.005, dt_ = 1e-3;
  Arena arena_;
  double reach_ = 1;  ///< largest coordinate of the kill box [m]
  WorldSettings world_settings_;
  bool leaks_allowed_ = false, something_passed_ = false, all_slip_free_ = true;
  ForceFields fields_;
  std::vector<ForceId> forces_;
  std::vector<Drain> drains_;
  double max_age_ = std::numeric_limits<double>::infinity();  ///< [s]
  std::map<std::uint64_t, double> latest_birth_;              ///< of each id [s], where ages are limited
  std::unique_ptr<World> world_;
  std::vector<Sheet> sheets_;
  TraceWatch watch_;
  WorldVerdict verdict_;
};

}  // namespace oilskin::test
