/// What the methods with a fluid of their own share: particles, surfaces, the step, smoothing.
#pragma once

#include "study/comparators/coupling_method.h"
#include "study/comparators/neighbour_lists.h"
#include "study/comparators/surface_set.h"

namespace oilskin::study {

class ParticleMethod : public CouplingMethod {
 public:
  /// @param particle_volume of water at rest [m³]
  /// @param least_smoothing of XSPH per interval, whatever its length, 0 … 1
  ParticleMethod(const MethodSettings& settings, double particle_volume, double least_smoothing = 0);

  Status attach(SurfaceHost& host, std::size_t* surface) override {
    return surfaces_.attach(host, settings_.thickness, surface);
  }
  Status add_particles(Span<const Vec3> positions, Span<const Vec3> velocities) override;
  Status step(double dt) override;

  Span<const std::uint64_t> ids() const override { return id_; }
  Span<const Vec3> positions() const override { return x_; }
  Span<const Vec3> velocities() const override { return v_; }
  Span<const double> densities() const override { return density_; }
  Span<const double> pressures() const override { return pressure_; }
  double particle_mass() const override { return volume_ * settings_.rest_density; }
  const SurfaceMotion& surface(std::size_t index) const override { return surfaces_[index]; }
  void set_observer(IntervalObserver* observer) override { observer_ = observer; }

 protected:
  /// Moves x_ and v_ through an interval of dt [s], in which surfaces_ move from x_t0 to x_t1. Writes
  /// density_ and pressure_.
  virtual void advance(double dt) = 0;
  /// XSPH at the common rate, and the viscosity ν by the term of [Morris1997], which pairs of neighbours give
  /// each other: momentum stays. `x`: where the pairs of `lists` were searched.
  void smooth(const NeighbourLists& lists, Span<const Vec3> x, double dt);

  const MethodSettings settings_;
  const double volume_, support_;  // V [m³], H = 2 dx [m]
  SurfaceSet surfaces_;
  std::vector<std::uint64_t> id_;
  std::vector<Vec3> x_, v_;
  std::vector<double> density_, pressure_;

 private:
  int intervals_of(double dt) const;
  void remove_outside();

  const double least_smoothing_, xsph_rate_;
  std::uint64_t next_id_ = 1;
  std::vector<Vec3> before_, change_;
  IntervalObserver* observer_ = nullptr;
};

}  // namespace oilskin::study
