/// A triangle mesh of the water's surface from its particles, and one that never cuts the cloth. Works for
/// any particles and any triangle meshes; knows nothing of the simulation. Target: oilskin::reconstruction.
///
/// The field is that of [Zhu2005] with the decay of [Onderik2011] or of [Solenthaler2007], polygonised by
/// marching cubes [Lorensen1987]; at obstacles the visibility criterion of [Huber2013] section 4, cut cells,
/// and a repair loop. docs/manual/water_mesh.md says what is promised, docs/theory/reconstruction.md why it
/// holds.
///
///     ReconstructionInput input;
///     input.positions = world.positions();
///     input.obstacles.push_back({cloth_vertices, cloth_triangles});
///     ReconstructionOptions options;
///     options.spacing = 0.005;
///     WaterMesh mesh;
///     Status status = reconstruct_surface(input, options, &mesh);
///
/// The mesh is closed, oriented outwards (right-hand rule), every edge has two triangles and the triangles at
/// a vertex form one fan. The same input gives the same bits for any number of threads.
#pragma once

#include <optional>

#include "oilskin/types.h"

namespace oilskin {

/// The scalar field whose zero is the surface. k = (1 − |x−x_i|²/R²)³, R the kernel radius, x̄ the mean of the
/// particles weighted by V_i k, V_i their volumes, w = Σ V_i W(x−x_i) the share of space that is water.
enum class ReconstructionField {
  density_decay,  ///< (R.5) |x − x̄| − r g(w): the radius r fades where w does, so nothing spans a gap
  eigenvalue_decay,  ///< |x − x̄| − r f(EV), EV the largest eigenvalue of ∇x̄; the mesh takes 2.6 times as long
  zhu_bridson,  ///< |x − x̄| − r; blobs appear in hollows and between drops
  density,      ///< (½ − w) · slope: no averaging, bumpy, drops are thicker
};

enum class ObstacleMode {
  none,  ///< obstacles are ignored: the surface cuts them
  /// That of [Huber2013] (R.14): hidden particles do not count, nodes nearer than `gap` (or half a cell, if
  /// that is more) to an obstacle are outside. Free of intersections only for distances of √3 cells. For
  /// comparison.
  reset,
  /// The surface stays away by `gap`: nothing is nearer. Water that ends before it stays where it is.
  gap,
  /// As gap, and water within `touch_range` of an obstacle is drawn to it: an even film at the gap.
  touch,
  /// Water within `touch_range` of an obstacle passes through it by `overlap_depth`, so that no sliver of air
  /// shows between the two. For closed obstacles that are drawn opaque. An open sheet is pierced: it lies
  /// inside the water's mesh, and water shows on the dry side.
  overlap,
};

struct ReconstructionOptions {
  double spacing = 0.005;  ///< rest distance s of the particles [m], 1e-6 … 1e3
  double cell = 0.5;  ///< edge of a grid cell, in spacings, 0.1 … 1. The grid lies on world multiples of it
  double kernel_radius = 2;  ///< R, in spacings, 1.5 … 4
  double particle_radius =
      0.5;  ///< r, in spacings, 0.1 … 1: how far the surface lies from the outermost particles
  ReconstructionField field = ReconstructionField::density_decay;

  ObstacleMode contact = ObstacleMode::gap;
  double gap = 0;  ///< [m], 0 … 1 spacing: no triangle is nearer to an obstacle; may be smaller than a cell
  double touch_range = 1;    ///< touch, overlap: in spacings, 0 … 1.5
  double overlap_depth = 0;  ///< overlap: [m], 0 … 1 spacing

  /// λ|μ steps [Taubin1995] that leave the volume as it is, 0 … 1000. Near obstacles vertices move only as
  /// far as the gap allows.
  int smoothing_iterations = 0;
  std::optional<Box> clip;  ///< only what lies inside, to 1 % of a cell; the mesh is closed along the sides
  double min_blob = 0;  ///< pieces of water of less volume are left out, in s³, ≥ 0; a drop has about 0.5
  double memory_limit =
      4e9;          ///< [bytes] of working memory, > 0; what would need more is refused before it starts
  int threads = 0;  ///< 0 = one per hardware thread

  /// Names the first field that is wrong, its value and what would be right.
  Status validate() const;
};

/// A quantity of particles that the mesh should carry, too: `components` values for each of the particles.
struct ParticleAttribute {
  Span<const float> values;
  int components = 1;
};

/// Cloth, a body's hull, a level: any triangles, open or closed, degenerate ones included. The promise holds
/// for these numbers, and for them rounded to float.
struct ObstacleMesh {
  Span<const Vec3> vertices;  ///< [m]
  Span<const Triangle> triangles;
};

struct ReconstructionInput {
  Span<const Vec3>
      positions;  ///< [m]; particles that are not finite or farther out than 2²⁰ cells are skipped
  Span<const Vec3> velocities;  ///< [m/s], as many as positions, or none
  std::vector<ParticleAttribute> attributes;
  std::vector<ObstacleMesh> obstacles;
};

struct WaterMesh {
  using Float3 = std::array<float, 3>;
  struct Attribute {
    std::vector<float> values;  ///< `components` for each vertex
    int components = 1;
  };

  std::vector<Float3> positions;  ///< [m]; the promise is made for these floats
  std::vector<Float3> normals;    ///< unit, outward: mean of the triangles around, weighted by area
  std::vector<Triangle> triangles;
  std::vector<Float3> velocities;     ///< [m/s], if the input has velocities
  std::vector<Attribute> attributes;  ///< as in the input
};

/// Seconds of wall time.
struct ReconstructionSeconds {
  double blocks = 0;    ///< sorting particles, finding the blocks that the surface passes
  double field = 0;     ///< volumes and field, visibility included
  double contact = 0;   ///< distances, cut edges, repair
  double mesh = 0;      ///< marching cubes, blobs
  double vertices = 0;  ///< smoothing, normals, attributes
};

struct ReconstructionReport {
  std::size_t particles_skipped = 0;  ///< not finite, or too far out
  std::size_t blocks = 0;             ///< of 8³ nodes, that hold values
  std::size_t cut_edges = 0;          ///< of the grid, that an obstacle crosses
  std::size_t nodes_cleared = 0;      ///< set outside by the rule of cut edges and by repair
  int repair_rounds = 0;
  std::size_t components_freed = 0;  ///< pieces of obstacles that lay inside the water
  std::size_t blobs_removed = 0;
  std::size_t vertices_held = 0;  ///< by smoothing, where a move would have come too near
  double volume = 0;              ///< [m³] inside the mesh
  double bytes = 0;               ///< working memory as planned, beside input and output
  ReconstructionSeconds seconds;
};

/// Refused: wrong options, arrays of different lengths, obstacles with values that are not finite or indices
/// out of range, more memory than allowed. The mesh is then as it was. No particles give an empty mesh.
Status reconstruct_surface(const ReconstructionInput& input, const ReconstructionOptions& options,
                           WaterMesh* mesh, ReconstructionReport* report = nullptr);

/// What a mesh is worth: all zero but `min_distance` and `components`, where it is as promised.
struct MeshCheck {
  std::size_t intersecting_pairs = 0;    ///< triangles of mesh and obstacle that cannot be shown to be apart
  std::size_t near_pairs = 0;            ///< that cannot be shown to be farther apart than the gap
  std::size_t submerged_components = 0;  ///< connected pieces of obstacles that have a point inside the mesh
  std::size_t open_edges = 0;            ///< with one triangle
  std::size_t crowded_edges = 0;         ///< with more than two
  std::size_t misoriented_edges = 0;     ///< with two that pass it in the same direction
  std::size_t pinched_vertices = 0;      ///< whose triangles form more than one fan
  /// [m] a lower bound, if some pair is within gap + 1e-3 of the mesh's largest extent; infinite otherwise.
  double min_distance = std::numeric_limits<double>::infinity();
  std::size_t components = 0;  ///< of the mesh
  double volume = 0;           ///< [m³], signed

  /// Closed, manifold, and (with no intersecting pair) no point of an obstacle inside or nearer than the gap.
  bool clean() const {
    return intersecting_pairs + near_pairs + submerged_components + open_edges + crowded_edges +
               misoriented_edges + pinched_vertices ==
           0;
  }
};

/// The acceptance test, for any triangle mesh. If no pair intersects, each piece of an obstacle is wholly
/// inside or wholly outside, so one point of it tells. `gap` [m] ≥ 0. Indices in range, values finite
/// (asserted).
MeshCheck check_mesh(const WaterMesh& mesh, Span<const ObstacleMesh> obstacles, double gap, int threads = 0);

}  // namespace oilskin
