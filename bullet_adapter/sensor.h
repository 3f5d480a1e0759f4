/// An attached object that is no wall but measures.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include "oilskin/bullet_sensor.h"
#include "oilskin/world.h"
#include "shape_region.h"

namespace oilskin::bullet {

/// Where the particles were before a step, by id.
class ParticlesBefore {
 public:
  explicit ParticlesBefore(const World& world);
  /// Of each particle that the world has now; null where it did not exist.
  std::vector<const Vec3*> positions_of(const World& world) const;

 private:
  std::vector<std::pair<std::uint64_t, Vec3>> sorted_;
};

class Sensor {
 public:
  explicit Sensor(const btCollisionObject* object) : object_(object) {}

  /// Is the object one that measures?
  static bool is_sensor(const btCollisionObject& object);
  /// Reads the shape. Refuses shapes without a volume.
  Status read();
  /// Before a step of fluids: the first time, counts what is inside. A fluid that was added since appears.
  void begin(Span<World* const> worlds);
  /// After the step; the flow within it. `starts`: per fluid, ParticlesBefore::positions_of().
  btFluidFlow end(Span<World* const> worlds, const std::vector<std::vector<const Vec3*>>& starts);
  /// What is inside of the k-th fluid vanishes; with the last fluid all measurements do.
  void forget_fluid(std::size_t k, bool is_last);
  /// The motion up to the next step is a teleport.
  void forget_motion() { teleported_ = true; }

  const btFluidReading& reading() const { return reading_; }

  /// What a sensor remembers from step to step.
  struct State {
    std::optional<Eigen::Affine3d> to_local;
    bool teleported = false;
    std::vector<std::vector<std::uint64_t>> inside;  // of each fluid
    btFluidReading reading;
  };
  State state() const { return {to_local_, teleported_, inside_, reading_}; }
  void set_state(State state);

 private:
  using Inside = std::vector<std::uint64_t>;  // ids, sorted
  void add_flow_of(const World& world, const std::vector<const Vec3*>& starts, const Eigen::Affine3d& then,
                   const Eigen::Affine3d& now, Inside& inside, btFluidFlow& flow);

  const btCollisionObject* object_;
  std::vector<double> signature_;
  std::optional<ShapeRegion> region_;
  std::optional<Eigen::Affine3d> to_local_;  // after the last step
  bool teleported_ = false;
  std::vector<Inside> inside_;  // of each fluid
  btFluidReading reading_;
};

}  // namespace oilskin::bullet
