/// Water inside a box stays still for a while.
#include "checks/check.h"

#include <algorithm>

#include "geometry/pool.h"

namespace oilskin::demo {
namespace {

struct Place {
  Box within;
  double from = 0, to = never;  // [s]
  double speed = 0.05;          // largest root of the mean square at any moment [m/s]
  double seen = -1;             // that was seen [m/s]; < 0 before the first look
};

void describe_place(Fields& f, Place& p) {
  f.box("within", p.within);
  if (f.reading() && !f.has("within")) f.fail("within", "is missing: the box whose water is to be at rest");
  f.number("from", p.from, not_negative());
  f.number("to", p.to, not_negative());
  f.number("speed", p.speed, positive());
}

/// A list of boxes, which may be empty.
class AtRest : public Check {
 public:
  void describe(Fields& f) override { f.list("at_rest", places_, describe_place); }
  void check_scene(const Scene&) const override {
    for (std::size_t i = 0; i < places_.size(); ++i)
      if (!(places_[i].to > places_[i].from))
        throw SceneError("acceptance.at_rest." + std::to_string(i) + ".to: must be later than \"from\"");
  }

  void after_step(const Moment& now) override {
    const World& world = now.simulation.world();
    for (Place& p : places_)
      if (now.t > p.from && now.t <= p.to)
        p.seen = std::max(p.seen, rms_speed_within(world.positions(), world.motions(), p.within));
  }

  /// Water that was not looked at to the end was not seen to be at rest.
  std::vector<CheckResult> results(const RunEnd& end) override {
    std::vector<CheckResult> all;
    for (const Place& p : places_) {
      const bool whole = p.to == never || end.scene.duration >= p.to;
      const std::string name = "at_rest." + std::to_string(all.size());
      all.push_back(at_most(name, whole && p.seen >= 0 ? p.seen : never, p.speed));
    }
    return all;
  }

 private:
  std::vector<Place> places_;
};

}  // namespace

std::unique_ptr<Check> make_at_rest() {
  return std::make_unique<AtRest>();
}

}  // namespace oilskin::demo
