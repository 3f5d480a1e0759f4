// Worlds drawn at random in which nothing but gravity and nozzles does work: energy must not rise by itself.
// OILSKIN_WORLDS_FIRST=<seed> OILSKIN_WORLDS_COUNT=1 OILSKIN_WORLDS_TABLE=1 runs one again and prints it;
// OILSKIN_WORLDS_SCENES=<folder> writes its scene file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "hosts/bullet_simulation.h"
#include "scene/scene_reader.h"
#include "support/random.h"
#include "support/record.h"

namespace oilskin::demo {
namespace {

using test::Random;

template <class T, std::size_t n>
T one_of(Random& random, const T (&values)[n]) {
  return values[random.below(n)];
}

enum class Place { cloth, hammock, tank, slot };
constexpr const char* names_of_places[] = {"cloth", "hammock", "tank", "slot"};

struct Drawn {
  Scene scene;
  Place place = Place::cloth;
  double mass_ratio = 0;  ///< cloth over water; 0 = no cloth
  int steps_a_frame = 1;
  std::string what;
};

Body box(const Vec3& min, const Vec3& max, double thickness) {
  Body body;
  body.shape = BoxShape{0.5 * (min + max), 0.5 * (max - min)};
  body.surface.thickness = thickness;
  return body;
}

/// A floor at y = 0 and four walls around x in from … inside.x, z in 0 … inside.z.
void add_tank(Scene& scene, double from, const Vec3& inside, double wall, double thickness) {
  const Vec3 lo(from - wall, -wall, -wall), hi(inside.x() + wall, inside.y(), inside.z() + wall);
  scene.bodies.push_back(box(lo, Vec3(hi.x(), 0, hi.z()), thickness));
  scene.bodies.push_back(box(Vec3(lo.x(), 0, lo.z()), Vec3(from, hi.y(), hi.z()), thickness));
  scene.bodies.push_back(box(Vec3(inside.x(), 0, lo.z()), hi, thickness));
  scene.bodies.push_back(box(Vec3(from, 0, lo.z()), Vec3(inside.x(), hi.y(), 0), thickness));
  scene.bodies.push_back(box(Vec3(from, 0, inside.z()), Vec3(inside.x(), hi.y(), hi.z()), thickness));
}

class Drawing {
 public:
  explicit Drawing(std::uint64_t seed) : random_(Random(seed).bits()) {
    Scene& s = drawn_.scene;
    s.name = "energy_" + std::to_string(seed);
    s.world.gravity = Vec3(0, -9.81, 0);
    s.world.kill_box = {Vec3::Constant(-3), Vec3::Constant(3)};
    draw_fluid();
    drawn_.place = one_of(random_, {Place::cloth, Place::cloth, Place::hammock, Place::tank, Place::slot});
    const double water = add_water();
    if (drawn_.place == Place::cloth || drawn_.place == Place::hammock) {
      add_cloth(water);
    } else {
      add_walls();
    }
    describe();
  }
  /// Adds a sink where the water goes, an age at which it ends, and a force field.
  void add_fields() {
    Scene& s = drawn_.scene;
    const double wide = side_ * s.fluid.spacing;
    const Vec3 corner(random_.uniform(0, 0.8) * wide, -0.5 * wide, random_.uniform(0, 0.8) * wide);
    s.sinks.push_back(box_region({corner, corner + Vec3(0.3, 1, 0.3) * wide}));
    s.max_age = random_.uniform(0.15, 0.45);
    const Vec3 aside = Vec3(random_.uniform(-1, 1), 0, random_.uniform(-1, 1));
    VortexForce vortex;
    vortex.center = Vec3(0.5, 0, 0.5) * wide;
    vortex.radius = 0.3 * wide;
    vortex.strength = random_.uniform(-5, 5);
    WindForce wind;
    wind.velocity = 5 * aside;
    s.effects.forces = {UniformForce{Region(), 3 * aside}, vortex, wind};
    s.effects.forces = {s.effects.forces[random_.below(3)]};
    static constexpr const char* names[] = {"uniform", "vortex", "wind"};
    drawn_.what += std::string(", sink, ages, ") + names[s.effects.forces[0].index()];
  }
  Drawn take() { return std::move(drawn_); }

 private:
  void draw_fluid() {
    Scene& s = drawn_.scene;
    FluidSettings& f = s.fluid;
    f.spacing = random_.log_uniform(0.004, 0.02);
    f.solver = one_of(random_, {PressureSolver::pcisph, PressureSolver::pcisph, PressureSolver::dfsph,
                                PressureSolver::dfsph, PressureSolver::mcg03});
    f.stiffness = 20;
    f.boundary = BoundaryModel::contact_only;
    if (f.solver != PressureSolver::mcg03)
      f.boundary = one_of(random_, {BoundaryModel::contact_only, BoundaryModel::mirrored});
    f.max_substeps = one_of(random_, {1, 1, 8});
    drawn_.steps_a_frame = one_of(random_, {1, 2, 4, 8, 16});
    s.dt = 1.0 / 60 / drawn_.steps_a_frame;
    s.duration = 0.5;
    s.host = one_of(random_, {HostKind::bullet, HostKind::mock});
    thickness_ = std::max(f.spacing * random_.uniform(0.2, 0.5), 1e-3);
  }

  /// Above y = 0 and within x, z in 0 … side_ dx. Returns its mass [kg].
  double add_water() {
    const double dx = drawn_.scene.fluid.spacing;
    side_ = 8 + static_cast<int>(random_.below(5));
    const double fall = random_.uniform(0, 6) * dx, middle = 0.5 * side_ * dx;
    if (random_.below(2) == 0) {
      const Vec3 cells(2 + random_.below(side_ - 3), 1 + random_.below(6), 2 + random_.below(side_ - 3));
      const Vec3 corner(middle - 0.5 * dx * cells.x(), thickness_ + 0.5 * dx + fall,
                        middle - 0.5 * dx * cells.z());
      FilledBox block;
      block.box = {corner, corner + dx * (cells + Vec3::Constant(0.01))};
      drawn_.scene.emitters.emplace_back(block);
      return 1000 * cells.prod() * dx * dx * dx;
    }
    DiscEmitter nozzle;
    nozzle.radius = random_.uniform(1, std::min(6.0, 0.45 * side_)) * dx;
    nozzle.center = Vec3(middle, thickness_ + 2 * dx + fall, middle);
    nozzle.speed = random_.log_uniform(0.3, 3);
    const double area = 3.14159265 * nozzle.radius * nozzle.radius;
    const double volume = std::min(400 * dx * dx * dx, area * nozzle.speed * 0.4);
    nozzle.stop = volume / (area * nozzle.speed);
    drawn_.scene.emitters.emplace_back(nozzle);
    return 1000 * volume;
  }

  void add_cloth(double water) {
    const double dx = drawn_.scene.fluid.spacing, size = (side_ + 4) * dx;
    drawn_.mass_ratio = random_.log_uniform(0.05, 50);
    Cloth cloth;
    const int nodes = 9 + 2 * static_cast<int>(random_.below(5));
    cloth.grid = {nodes, nodes};
    cloth.size = {size, size};
    cloth.center = Vec3(0.5 * side_ * dx, 0, 0.5 * side_ * dx);
    cloth.areal_density = drawn_.mass_ratio * water / (size * size);
    cloth.pins.kind = drawn_.place == Place::hammock ? PinKind::corners : PinKind::border;
    cloth.substeps = 1;
    cloth.surface.thickness = thickness_;
    drawn_.scene.cloth.push_back(cloth);
  }

  void add_walls() {
    const double dx = drawn_.scene.fluid.spacing;
    const Vec3 inside(side_ * dx, 20 * dx, side_ * dx);
    const bool has_slot = drawn_.place == Place::slot;
    const double gap = random_.uniform(1, 4) * dx, from = has_slot ? -gap - 3 * dx : 0;
    add_tank(drawn_.scene, from, inside, 3 * dx, thickness_);
    if (!has_slot) return;
    // A wall beside the water, which it passes under into the slot.
    drawn_.scene.bodies.push_back(
        box(Vec3(from + gap, gap, 0.1 * dx), Vec3(-dx, 20 * dx, inside.z() - 0.1 * dx), thickness_));
  }

  void describe() {
    static constexpr const char* solvers[] = {"mcg03", "pcisph", "dfsph"};
    const FluidSettings& f = drawn_.scene.fluid;
    std::ostringstream s;
    s << std::setprecision(3) << names_of_places[static_cast<int>(drawn_.place)] << ' '
      << solvers[static_cast<int>(f.solver)]
      << (f.boundary == BoundaryModel::mirrored ? " mirrored" : " contact")
      << (drawn_.scene.host == HostKind::mock ? " mock" : " bullet") << " dx " << 1e3 * f.spacing << " mm, "
      << drawn_.steps_a_frame << " a frame, sub " << f.max_substeps;
    if (drawn_.mass_ratio > 0) s << ", cloth " << drawn_.mass_ratio;
    s << (std::holds_alternative<FilledBox>(drawn_.scene.emitters[0].shape) ? ", block" : ", nozzle");
    drawn_.what = s.str();
  }

  Random random_;
  Drawn drawn_;
  double thickness_ = 0.001;
  int side_ = 8;  // [dx]
};

struct Verdict {
  double made = 0;   ///< largest of lasting made/scale
  double risen = 0;  ///< largest of risen/scale
  double total =
      0;  ///< largest of (made + work of the host)/scale: all that rose in a world with passive cloth
  double dry = 0;  ///< largest work of the host on its dry cloth over the scale
  bool flagged = false;
  std::uint64_t drained = 0, aged = 0;
  double work_outside = 0;  ///< of force fields [J]
};

/// `made` less what impulses that free nodes have yet to take explain of a peak of one step, as in `risen`.
double lasting(const EnergyReport& e, double made_before) {
  return std::max(std::min(e.made, made_before), e.made - std::max(0.0, e.transfer));
}

Verdict judge(const Drawn& drawn) {
  Verdict v;
  SimulationOptions options;
  options.threads = 1;
  const auto wet = make_simulation(drawn.scene, options);
  const int steps = static_cast<int>(std::lround(drawn.scene.duration / drawn.scene.dt));
  double scale = 0, made_before = 0;
  for (int k = 0; k < steps; ++k) {
    const StepReport& r = wet->step(drawn.scene.dt);
    const EnergyReport& e = r.energy;
    if (e.scale > 0) v.made = std::max(v.made, lasting(e, made_before) / e.scale);
    made_before = e.made;
    v.risen = std::max(v.risen, e.risen_fraction());
    if (e.scale > 0) v.total = std::max(v.total, (e.made + e.work_host) / e.scale);
    v.flagged |= (r.flags & flag_energy_made) != 0;
    scale = e.scale;
    v.drained += r.removed_by_sinks;
    v.aged += r.removed_by_age;
    v.work_outside = e.work_outside;
  }
  if (drawn.scene.cloth.empty()) return v;
  options.emitters = false;
  const auto dry = make_simulation(drawn.scene, options);
  for (int k = 0; k < steps; ++k) v.dry = std::max(v.dry, dry->step(drawn.scene.dt).energy.work_host / scale);
  return v;
}

std::uint64_t from_environment(const char* name, std::uint64_t value) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : value;
}

/// The long form fails in 12 of 2,000 worlds (docs/manual/testing.md).
constexpr double limit = 0.01;

void print(std::uint64_t seed, const Drawn& drawn, const Verdict& v) {
  std::cout << std::setw(6) << seed << std::setprecision(3) << std::setw(10) << 100 * v.made << std::setw(10)
            << 100 * v.risen << std::setw(10) << 100 * v.total << std::setw(10) << 100 * v.dry
            << (v.made > limit ? " FAILS " : " ok    ") << (v.flagged ? "flag " : "     ") << drawn.what
            << '\n';
}

void write_scene_file(const Drawn& drawn) {
  if (const char* folder = std::getenv("OILSKIN_WORLDS_SCENES"))
    std::ofstream(std::string(folder) + "/" + drawn.scene.name + ".json") << write_scene(drawn.scene).dump(2);
}

TEST(EnergyWorlds, energy_never_rises_by_itself) {
  const std::uint64_t first = from_environment("OILSKIN_WORLDS_FIRST", 1);
  const std::uint64_t count = from_environment("OILSKIN_WORLDS_COUNT", 30);
  const bool table = from_environment("OILSKIN_WORLDS_TABLE", 0) != 0;
  if (table) std::cout << "  seed    made %   risen %   total %     dry %\n";
  std::uint64_t gains_dry = 0, failed = 0, judged = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const Drawn drawn = Drawing(seed).take();
    write_scene_file(drawn);
    const Verdict v = judge(drawn);
    if (table) print(seed, drawn, v);
    gains_dry += v.dry > limit;
    failed += v.made > limit;
    if (v.dry > limit) continue;
    ++judged;
    EXPECT_LE(v.made, limit) << "seed " << seed << ": " << drawn.what;
  }
  test::record("worlds whose dry cloth gains", gains_dry);
  test::record("worlds that make energy", failed);
  test::record("worlds judged", judged);
  EXPECT_GE(2 * judged, count);
}

// Their energies are those of water that leaves, and of work from outside.
TEST(EnergyWorlds, sinks_ages_and_force_fields_do_not_let_energy_rise) {
  const std::uint64_t first = from_environment("OILSKIN_WORLDS_FIRST", 1);
  const std::uint64_t count = from_environment("OILSKIN_WORLDS_COUNT", 12);
  const bool table = from_environment("OILSKIN_WORLDS_TABLE", 0) != 0;
  std::uint64_t judged = 0, drained = 0, aged = 0, worked = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    Drawing drawing(seed);
    drawing.add_fields();
    const Drawn drawn = drawing.take();
    write_scene_file(drawn);
    const Verdict v = judge(drawn);
    if (table) print(seed, drawn, v);
    drained += v.drained;
    aged += v.aged;
    worked += v.work_outside != 0;
    if (v.dry > limit) continue;
    ++judged;
    EXPECT_LE(v.made, limit) << "seed " << seed << ": " << drawn.what;
  }
  test::record("worlds with fields judged", judged);
  EXPECT_GE(2 * judged, count);
  EXPECT_GT(drained, 100 * count / 12);
  EXPECT_GT(aged, 100 * count / 12);
  EXPECT_GE(2 * worked, count);
}

}  // namespace
}  // namespace oilskin::demo
