/// Surfaces drawn at random: meshes of every kind, and a host that moves them anyhow.
#pragma once

#include "oilskin/surface_motion.h"
#include "support/random.h"

namespace oilskin::test {

enum class MeshKind { grid, layers, folds, crumpled, bag };
enum class SheetMotion { still, shaken, carried, closing, turning, free_flight };
const char* name_of(MeshKind kind);
const char* name_of(SheetMotion motion);

/// Where a surface may go.
struct Arena {
  Vec3 center = Vec3::Zero();
  double half = 1;  ///< [m]
};

struct SheetPlan {
  MeshKind mesh = MeshKind::grid;
  SheetMotion motion = SheetMotion::still;
  Storage storage = Storage::float64;
  double edge = 0.01;                       ///< of the mesh [m]
  double displacement = 1;                  ///< of a node in a step, in edges, at most
  double pins = 0;                          ///< share of prescribed nodes
  bool pins_agree = true;                   ///< prescribed nodes move alike
  bool holdable = true;                     ///< contact may hold prescribed nodes
  bool movable = true;                      ///< contacts may move the positions of free nodes
  double lightest = 1e-6, heaviest = 1e-3;  ///< mass of a node [kg]
};

class RandomSheet : public SurfaceHost {
 public:
  RandomSheet(const SheetPlan& plan, const Vec3& at, Random& random);

  /// Before a step: what the next gather will propose.
  void propose(Random& random, const Arena& arena, const Vec3& gravity, double dt);
  /// Puts the sheet somewhere else; needs World::reset_motion().
  void jump(Random& random, const Arena& arena);
  void change_a_pin(Random& random);
  void spoil() { spoilt_ = true; }  ///< the next gathers propose a node that is nowhere …
  void mend() { spoilt_ = false; }

  Gathered gather(double dt, SurfaceMotion& motion) override;
  void scatter(SurfaceMotion& motion) override;

  const SheetPlan& plan() const { return plan_; }
  const std::vector<Vec3>& nodes() const { return x_; }
  double reach() const;  ///< largest coordinate that a free node is to have [m]
  std::size_t triangle_count() const { return triangles_.size(); }

 private:
  void add_grid(std::uint32_t nu, std::uint32_t nv, const Vec3& corner, const Vec3& u, const Vec3& v);
  void make_mesh(Random& random, const Vec3& at);
  void make_folds(Random& random, const Vec3& u, const Vec3& v);
  void crumple(Random& random);
  void spoil_triangles(Random& random);
  void make_masses(Random& random);
  Vec3 displacement_of(std::size_t node, Random& random, double size) const;

  SheetPlan plan_;
  std::vector<Vec3> x_, v_, target_;
  std::vector<double> inverse_mass_;
  std::vector<Triangle> triangles_;
  Vec3 drift_ = Vec3::Zero(), center_ = Vec3::Zero();  ///< of the step to come
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
  double squeeze_ = 0;
  bool spoilt_ = false;
};

}  // namespace oilskin::test
