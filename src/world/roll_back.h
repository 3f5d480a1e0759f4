/// A step that fails leaves no trace.
#pragma once

namespace oilskin::world {

/// Puts the world back to its checkpoint if an exception ends the step.
template <class Impl>
class RollBack {
 public:
  explicit RollBack(Impl& world) : world_(&world) { world.checkpoint(); }
  ~RollBack() {
    if (world_) world_->roll_back();
  }
  RollBack(const RollBack&) = delete;
  RollBack& operator=(const RollBack&) = delete;
  void dismiss() noexcept { world_ = nullptr; }

 private:
  Impl* world_;
};

}  // namespace oilskin::world
