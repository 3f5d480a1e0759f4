/// @file
/// Force fields: accelerations in parts of space, vortices, and wind on the free surface
/// (docs/manual/effects.md).
#pragma once

#include <optional>
#include <variant>

#include "oilskin/effect.h"
#include "oilskin/region.h"

namespace oilskin {

/// The handle of a force field.
struct ForceId {
  /// 0 = none.
  std::uint64_t value = 0;
  /// Whether it is the handle of a force field.
  explicit operator bool() const { return value != 0; }
  /// Whether two handles are the same.
  bool operator==(ForceId o) const { return value == o.value; }
};

/// The same acceleration everywhere in a region, beside gravity.
struct UniformForce {
  /// Where it acts.
  Region region;
  /// [m/s²]
  Vec3 acceleration = Vec3::Zero();
};

/// An acceleration around an axis, by the right-hand rule, with the profile of Rankine's vortex (G.1): it
/// grows with the distance from the axis up to `strength` at `radius`, and falls with 1/distance beyond.
struct VortexForce {
  /// Where it acts.
  Region region;
  /// A point of the axis [m].
  Vec3 center = Vec3::Zero();
  /// The direction of the axis, of any length > 0.
  Vec3 axis = Vec3(0, 1, 0);
  /// [m], > 0.
  double radius = 0.1;
  /// The largest acceleration [m/s²].
  double strength = 0;
};

/// Wind: drag of air on the free surface, ½ ρ_a |u| u (C_d A_⊥ + C_f A) with the velocity u of the air
/// relative to the particle (G.2). A_⊥ is the area that faces the wind, A the whole area of the free surface
/// that the particle stands for. Water within has no such area, nor has water with a surface less than a
/// spacing before it. Farther away surfaces shelter nothing: a region keeps the wind out of a house. The step
/// is exact for the drag alone: no wind, step or spacing gives a particle more than the velocity of the wind.
struct WindForce {
  /// Where it blows.
  Region region;
  /// Of the air [m/s].
  Vec3 velocity = Vec3::Zero();
  /// ρ_a [kg/m³], ≥ 0.
  double air_density = 1.2;
  /// C_d, ≥ 0: of the area that faces the wind.
  double drag_coefficient = 1;
  /// C_f, ≥ 0: of the whole area. 0.0024 is that of wind up to 11 m/s on the sea [LargePond1981].
  double friction_coefficient = 0.0024;
};

/// What a force field is.
using Force = std::variant<UniformForce, VortexForce, WindForce>;

/// Accepted, or the first number that is not finite or out of range.
Status validate(const Force& force);

/// What a force field does.
struct ForceState {
  /// What it is.
  Force force;
  /// ForceFields::set_enabled().
  bool enabled = true;
};

/// An effect that consists of force fields. They act in the order in which they were added, each on the
/// velocity that the earlier ones leave. Between steps they can be added, changed and removed; the saved
/// world has them, with their handles. StepReport::momentum_effects and EnergyReport::work_outside count what
/// they give.
class ForceFields final : public Effect {
 public:
  /// Without any.
  ForceFields();

  /// Adds one. `id`: its handle. Refuses numbers that are not finite or out of range, as set() does.
  Status add(const Force& force, ForceId* id = nullptr);
  /// Replaces one, which keeps its handle. Refuses an unknown handle.
  Status set(ForceId id, const Force& force);
  /// Whether it acts. Refuses an unknown handle.
  Status set_enabled(ForceId id, bool enabled);
  /// Removes one. Returns whether there was one.
  bool remove(ForceId id);
  /// None for an unknown handle.
  std::optional<ForceState> find(ForceId id) const;
  /// How many there are.
  std::size_t size() const { return fields_.size(); }

  std::string name() const override { return "force fields"; }
  /// One spacing where wind blows: walls nearer than that are no free surface.
  double wall_reach() const override;
  /// 0.25 √(H/a) with the largest acceleration a, as for pressure (F.45), of fields whose regions overlap.
  /// Wind needs no limit.
  double longest_interval(const FluidSettings& fluid) const override;
  void act(EffectForces& forces) override;
  /// Moves regions and axes.
  void translate(const Vec3& offset) override;
  std::vector<std::uint8_t> save() const override;
  Status restore(Span<const std::uint8_t> saved) override;

 private:
  struct Field {
    std::uint64_t id = 0;
    bool enabled = true;
    Force force;
  };
  Field* find_field(ForceId id);

  std::vector<Field> fields_;
  std::uint64_t next_id_ = 1;
};

}  // namespace oilskin
