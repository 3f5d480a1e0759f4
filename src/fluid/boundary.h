/// What the fluid knows of the surfaces near it: each wall continues the water as its mirror image.
///
/// For a particle at distance z of a plane the first layer of the image stands 2 z away, and adds
/// λ(z) = κ L(2 a z/H) to its relative density, L the kernel's integral over a plane. κ and a are such that
/// in a lattice that ends half a spacing off the wall, a particle has its rest density and the same pressure
/// as its neighbours: λ is what the lattice lacks, γ = −H dλ/dz 1.03 times twice its pull (κ = 0.54, a = 1.02
/// for H = 2 dx, where the second layer of the image is out of reach). A triangle T does so by the share that
/// it hides of its plane (wall_integral.h), γ_T along its normal towards the particle.
///
/// A pressure model that knows of it does three things: λ_i counts in the density at the start; the density
/// grows by approach at the rate −Σ γ_T·(v_i − v_T)/H; and its pressure pushes particle i by Σ θ_T γ_T [m/s],
/// θ_T = p_T dt/(ρ0 H). What particles get, nodes lose.
///
/// p_T is the pressure at the wall: between a particle and an image that stands deeper it is that of the
/// particle and what the water between it and the wall weighs. With p_i alone the layer on a floor would need
/// half a layer's pressure more than it should have to carry the column.
///
/// The density of a half-space of water behind the wall with mirrored pressure, Λ of (B.1), has
/// the right value and force too, but its force is twice its slope: that does work on the fluid, and columns
/// at rest boil (0.2 m/s where this one stays below 0.02). With the image both follow from one function.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>

#include "core/archive.h"
#include "core/parallel.h"
#include "fluid/neighbours.h"
#include "oilskin/surface_motion.h"

namespace oilskin::fluid {

class Boundary {
 public:
  /// θ_T = at_particle + per_depth d_T [m/s].
  template <class T>
  struct Load {
    T at_particle = 0, per_depth = 0;
    T on(float depth) const { return at_particle + per_depth * static_cast<T>(depth); }
    Load times(T f) const { return {f * at_particle, f * per_depth}; }
  };

  /// A particle near a surface.
  struct Point {
    std::uint32_t particle = 0;
    float lambda = 0;                                 ///< Σ_T λ_T at the start, 0 … 1
    Eigen::Vector3f gamma = Eigen::Vector3f::Zero();  ///< Σ_T γ_T
    /// Σ_T d_T γ_T, d_T: how much deeper the wall is than the particle, in H; 0 where the wall yields.
    Eigen::Vector3f lift = Eigen::Vector3f::Zero();
    float deepest = 0;                 ///< of |d_T|
    std::uint32_t begin = 0, end = 0;  ///< its walls

    void add(float wall_lambda, const Eigen::Vector3f& wall_gamma, float depth) {
      lambda += wall_lambda;
      gamma += wall_gamma;
      lift += depth * wall_gamma;
      deepest = std::max(deepest, std::abs(depth));
    }
    Eigen::Vector3f push(const Load<float>& load) const {
      return load.at_particle * gamma + load.per_depth * lift;
    }
  };

  static constexpr std::uint32_t none = UINT32_MAX;

  /// Pull of the image over that of the lattice. The first layer of settled water stands 0.525 dx off a wall,
  /// where λ is less steep, with a few more particles than the lattice has: 1.02 to 1.04 make its pressure
  /// that of the water around it.
  static constexpr double settled_pull = 1.03;

  /// `support_ratio` H/dx of the lattice.
  explicit Boundary(double support_ratio);

  /// Finds points and walls at x_t0 of the surfaces, which move to x_t1 within dt [s]. `x` are the positions
  /// that `neighbours` was searched for; particle_mass [kg]; `down` is the direction of gravity, or zero.
  void find(double dt, double particle_mass, const Vec3& down, Span<const Vec3> x,
            const Neighbours& neighbours, double support_radius, Span<SurfaceMotion* const> surfaces,
            const Workers& workers);
  void clear();

  bool empty() const { return points_.empty(); }
  const std::vector<Point>& points() const { return points_; }
  /// Index into points(), or none. Valid for every particle if !empty().
  std::uint32_t point_of(std::size_t particle) const { return point_of_[particle]; }

  /// Expected velocities of the walls at the end of the interval if particle k of points() presses on them
  /// with theta[k] (walls that yield have no depth); writes inflow()[k] = Σ_T γ_T·v_T [m/s].
  void predict_wall_velocity(const std::vector<float>& theta, const Workers& workers);
  const std::vector<float>& normal_flux() const { return normal_flux_; }
  /// By how much inflow falls per θ where all particles push alike [1], ≥ 0: a bound of what any of them,
  /// with whatever sign, make of it. 0 at prescribed walls.
  const std::vector<float>& yielding() const { return yielding_; }

  /// Of a pressure iteration that leaves the residuals r: the change x of the particles' pressures with
  /// x_k/step_k + scale Σ_l Y_kl x_l = r_k, Y = −∂ inflow/∂θ, to about a third; x and r share `change`. Where
  /// step_k is 0 the pressure stays.
  void solve_yielding(float scale, const std::vector<float>& step, std::vector<float>& change,
                      const Workers& workers);

  /// dv += Σ θ_T γ_T, and the nodes' velocities and impulses change by the opposite momentum.
  void push(const std::vector<Load<double>>& load, std::vector<Vec3>& dv, const Workers& workers);

  /// What the hosts did with the load of the last step, once per step: after they were gathered, and before
  /// they are scattered with the impulses of the step. gravity [m/s²]. Surfaces that are not in the list are
  /// forgotten.
  void record_host_response(double dt, const Vec3& gravity, Span<SurfaceMotion* const> surfaces);
  void record_load(double dt, Span<SurfaceMotion* const> surfaces);

  /// For a step that may fail: checkpoint() copies the nodes' memory, roll_back() puts it back.
  void checkpoint() { saved_memory_ = memory_; }
  void roll_back() noexcept { memory_.swap(saved_memory_); }

  /// What is kept from step to step: the nodes' memory.
  void visit(Archive& archive);

 private:
  /// One triangle, or a plane sheet around its closest triangle, in reach of a particle.
  struct Wall {
    std::array<std::uint32_t, 3> node{};  // of nodes_
    std::array<float, 2> weight{};        // of the first two; the third has the rest
    Eigen::Vector3f gamma = Eigen::Vector3f::Zero();
    float lambda = 0, depth = 0;  // d
    std::uint32_t point = 0;

    double share(int corner) const {
      const double a = static_cast<double>(weight[0]), b = static_cast<double>(weight[1]);
      return corner == 0 ? a : corner == 1 ? b : 1 - a - b;
    }
  };
  struct Node {
    std::uint32_t surface = 0, node = 0;
    float inverse_mass = 0;                              // 0 = prescribed
    Eigen::Vector3f velocity = Eigen::Vector3f::Zero();  // of the host's proposal over the interval
    Eigen::Vector3f expected = Eigen::Vector3f::Zero();  // impulse of the load that the host will carry [N s]
  };
  struct WallCorner {
    std::uint32_t wall;
    std::uint8_t corner;
  };
  /// What the walls of a point and of a node have in common: Σ share γ. `other` is the node, in a list of a
  /// point, or the point.
  struct Coupling {
    std::uint32_t other;
    Eigen::Vector3f gamma;
  };
  /// What is kept of a node from step to step. Forces are means over the last few steps.
  struct NodeMemory {
    Vec3 velocity_left = Vec3::Zero();  // [m/s]
    Vec3 load = Vec3::Zero();           // ours [N]
    Vec3 answer = Vec3::Zero();         // the host's, without gravity [N]
  };
  struct SurfaceMemory {
    std::vector<NodeMemory> nodes;
    std::vector<std::uint8_t> repeated;   // per triangle: an earlier one has the same nodes
    std::vector<std::uint8_t> at_border;  // per triangle: a corner of it lies on a border edge
  };
  struct Near;

  void collect_near(Span<const Vec3> x, const Neighbours& neighbours, Span<SurfaceMotion* const> surfaces,
                    const Workers& workers, std::vector<std::vector<Near>>& found) const;
  void make_points(Span<const Vec3> x, Span<SurfaceMotion* const> surfaces, const Workers& workers,
                   const std::vector<std::vector<Near>>& found);
  void integrate(const Vec3& x, Span<SurfaceMotion* const> surfaces, Span<const Near> near, Point& point,
                 std::vector<Wall>& walls) const;
  void drop_hidden(const Vec3& x, Span<SurfaceMotion* const> surfaces, Span<const Near> near, Point& point,
                   std::vector<Wall>& walls) const;
  bool is_plane(Span<SurfaceMotion* const> surfaces, Span<const Near> near, std::size_t nearest) const;
  void number_nodes(double dt, Span<SurfaceMotion* const> surfaces);
  void find_yielding(const Workers& workers);
  void couple(const Workers& workers);
  Eigen::Vector3f impulse_on(std::size_t node, const std::vector<float>& theta) const;
  float normal_flux_at(std::size_t point) const;

  float image_mass_ = 0, image_offset_ = 1;  // κ, 2 a
  double support_radius_ = 1;
  double mass_ = 0;  // of a particle [kg]
  Eigen::Vector3f down_ = Eigen::Vector3f::Zero();
  bool yields_ = false;
  std::vector<Point> points_;
  std::vector<Wall> walls_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> corners_begin_;
  std::vector<WallCorner> corners_;  // of every node
  std::vector<std::uint32_t> of_point_begin_, of_node_begin_;
  std::vector<Coupling> of_point_, of_node_;
  std::vector<std::uint32_t> point_of_;
  std::vector<float> normal_flux_, yielding_;
  std::vector<float> solve_step_, solve_residual_, solve_direction_;
  std::vector<Eigen::Vector3f> wall_velocity_;  // of every node
  std::vector<SurfaceMotion*> surfaces_;
  std::map<std::uint64_t, SurfaceMemory> memory_;  // by surface id
  std::map<std::uint64_t, SurfaceMemory> saved_memory_;
};

}  // namespace oilskin::fluid
