/// @file
/// Reconstructs a triangle mesh of the water from its particles, one that does not intersect the cloth. Works
/// for any particles and any triangle meshes, independently of the simulation. Target:
/// oilskin::reconstruction.
///
/// The field is that of [Zhu2005] with the decay of [Onderik2011] or of [Solenthaler2007], polygonised by
/// marching cubes [Lorensen1987]; at obstacles the visibility criterion of [Huber2013] section 4, cut cells,
/// and a repair loop. docs/manual/water_mesh.md states the promise, docs/theory/reconstruction.md proves it.
///
///     ReconstructionInput input;
///     input.positions = world.positions();
///     input.obstacles.push_back({cloth_vertices, cloth_triangles});
///     ReconstructionOptions options;
///     options.spacing = 0.005;
///     WaterMesh mesh;
///     Status status = reconstruct_surface(input, options, &mesh);
///
/// The mesh is closed and oriented outwards (right-hand rule), every edge has two triangles, and the
/// triangles at a vertex form one fan. The same input gives the same bits for any number of threads.
#pragma once

#include <memory>
#include <optional>

#include "oilskin/types.h"

namespace oilskin {

/// The scalar field whose zero set is the water's surface. k = (1 − |x−x_i|²/R²)³ with the kernel radius R, x̄
/// is the mean of the particles weighted by V_i k with their volumes V_i, and w = Σ V_i W(x−x_i) is the
/// fraction of water.
enum class ReconstructionField {
  /// |x − x̄| − r g(w) (R.5): the radius decreases with w, so no skin spans a gap.
  density_decay,
  /// |x − x̄| − r f(EV), with the largest eigenvalue EV of ∇x̄; takes 2.6 times as long.
  eigenvalue_decay,
  /// |x − x̄| − r; blobs appear in concave places and between drops.
  zhu_bridson,
  /// (½ − w) · slope: no averaging, bumpy, drops are thicker.
  density,
};

/// How the surface behaves at obstacles.
enum class ObstacleMode {
  /// Obstacles are ignored: the surface cuts them.
  none,
  /// The method of [Huber2013] (R.14): hidden particles do not count, and nodes closer to an obstacle than
  /// `gap`, or than half a cell if that is more, are outside. Free of intersections only for distances of
  /// √3 cells. For comparison.
  reset,
  /// No triangle is closer than `gap`. Water that ends before it is unchanged.
  gap,
  /// As `gap`, and water within `touch_range` of an obstacle extends to it: an even film at the gap.
  touch,
  /// Water within `touch_range` of an obstacle passes through it by `overlap_depth`, so that no gap is
  /// visible. For closed obstacles that are drawn opaque. An open sheet lies inside the mesh, and water shows
  /// on its dry side.
  overlap,
  /// As `touch` where an obstacle is wet (`ObstacleMesh::saturation`), as `gap` where it is dry, and
  /// without a step between them.
  wet,
};

/// Options of the reconstruction.
struct ReconstructionOptions {
  /// The rest distance s of the particles [m], 1e-6 … 1e3.
  double spacing = 0.005;
  /// The edge of a grid cell, in spacings, 0.1 … 1. The grid lies on multiples of it.
  double cell = 0.5;
  /// R, in spacings, 1.5 … 4.
  double kernel_radius = 2;
  /// r, in spacings, 0.1 … 1: the distance of the surface from the outermost particles.
  double particle_radius = 0.5;
  /// The scalar field.
  ReconstructionField field = ReconstructionField::density_decay;

  /// The behaviour at obstacles.
  ObstacleMode contact = ObstacleMode::gap;
  /// [m], 0 … 1 spacing: the smallest distance between mesh and obstacles; may be smaller than a cell.
  double gap = 0;
  /// Touch, overlap, wet: in spacings, 0 … 1.5.
  double touch_range = 1;
  /// Wet: the saturation from which on an obstacle is wet, 0 … 1.
  double wet_saturation = 0.5;
  /// Wet: the width of the transition in saturation, as a fraction of `wet_saturation`, 0 … 1. An obstacle is
  /// dry up to the saturation (1 − `wet_blend`) `wet_saturation`. With 0 the mesh has a step.
  double wet_blend = 0.5;
  /// Overlap: [m], 0 … 1 spacing.
  double overlap_depth = 0;

  /// The mesh encloses the volume of the water: drops of one particle are spheres, water that lies on an
  /// obstacle in a layer is a sheet as thick as the water per area there (not in mode `none`), and the mesh
  /// is moved by what it lacks, on average over a few spacings. Modes `reset` and `overlap`, which change the
  /// volume, never do so. With a clip box only drops, films and small pieces keep theirs.
  bool keep_volume = true;

  /// λ|μ steps [Taubin1995], 0 … 1000. Vertices move by a cell at most, at obstacles only as far as the gap
  /// allows.
  int smoothing_iterations = 0;
  /// Only what lies inside; the mesh is closed along the sides of the box, to 1 % of a cell. Its edges are
  /// bevelled by up to a cell.
  std::optional<Box> clip;
  /// Pieces of water of a smaller volume are left out, in s³, ≥ 0; a particle has about 1.
  double min_blob = 0;
  /// Fill WaterMesh::nearest.
  bool nearest = false;
  /// Working memory [bytes], > 0. Input that needs more is refused before the work starts.
  double memory_limit = 4e9;
  /// 0 = all hardware threads, or those of set_job_system(). The results do not depend on it.
  int threads = 0;

  /// Accepted, or the first field that is out of range.
  Status validate() const;
};

/// A quantity of the particles that is interpolated at the vertices.
struct ParticleAttribute {
  /// `components` values for each particle.
  Span<const float> values;
  /// The number of values per particle, ≥ 1.
  int components = 1;
};

/// Cloth, the hull of a body, a level: any triangles, open or closed, also degenerate ones. The gap holds for
/// these numbers, and for them rounded to float.
struct ObstacleMesh {
  /// [m]
  Span<const Vec3> vertices;
  /// Indices of vertices.
  Span<const Triangle> triangles;
  /// Wet: the fraction of the pores that holds water, as many as vertices, or none; finite. Linear over a
  /// triangle. An obstacle without it is dry.
  Span<const float> saturation = {};
};

/// Particles and obstacles.
struct ReconstructionInput {
  /// [m]; particles 2²⁰ cells away or more, and those of which position or velocity is not finite, are
  /// skipped.
  Span<const Vec3> positions;
  /// [m/s], as many as positions, or none.
  Span<const Vec3> velocities;
  /// The water of each particle, m/ρ0 [m³], 0 … 1000 s³, as many as positions; or none: each has s³. A
  /// particle with 0 is as if it were not there.
  Span<const double> volumes = {};
  /// More quantities of the particles.
  std::vector<ParticleAttribute> attributes;
  /// Meshes that the water must not intersect.
  std::vector<ObstacleMesh> obstacles;
};

/// A triangle mesh of the water.
struct WaterMesh {
  /// A vector of floats.
  using Float3 = std::array<float, 3>;
  /// A quantity of the vertices.
  struct Attribute {
    /// `components` values for each vertex.
    std::vector<float> values;
    /// The number of values per vertex.
    int components = 1;
  };

  /// [m]; the gap holds for these floats.
  std::vector<Float3> positions;
  /// Unit, outward: the mean of the adjacent triangles, weighted by area; of drops, that of the ellipsoid.
  std::vector<Float3> normals;
  /// Indices of positions.
  std::vector<Triangle> triangles;
  /// [m/s], if the input has velocities.
  std::vector<Float3> velocities;
  /// As in the input.
  std::vector<Attribute> attributes;
  /// If ReconstructionOptions::keep_volume: of the film on an obstacle near the vertex, or between two [m]; 0
  /// away from films, where water is 1.4 spacings deep and deeper, and for drops.
  std::vector<float> thickness;
  /// If ReconstructionOptions::nearest: the number in the input of the nearest particle that the vertex sees,
  /// the smallest where several are. A vertex that sees none has the nearest one.
  std::vector<std::uint32_t> nearest;
  /// Stands in `nearest` for no particle.
  static constexpr std::uint32_t no_particle = 0xffffffffu;
};

/// Wall time per stage [s].
struct ReconstructionSeconds {
  /// Sorting particles, finding the blocks that the surface passes.
  double blocks = 0;
  /// Distances from obstacles, volumes, field, visibility.
  double field = 0;
  /// Repair.
  double contact = 0;
  /// Cut edges, marching cubes, blobs.
  double mesh = 0;
  /// Smoothing, normals, attributes.
  double vertices = 0;
};

/// Report of a reconstruction.
struct ReconstructionReport {
  /// Particles that are not finite, or too far away.
  std::size_t particles_skipped = 0;
  /// Blocks of 8³ nodes that hold values.
  std::size_t blocks = 0;
  /// Grid edges that an obstacle crosses.
  std::size_t cut_edges = 0;
  /// Nodes set outside for cut edges and by repair.
  std::size_t nodes_cleared = 0;
  /// Iterations of the repair.
  int repair_rounds = 0;
  /// Pieces of obstacles that lay inside the water.
  std::size_t components_freed = 0;
  /// Pieces of water smaller than ReconstructionOptions::min_blob.
  std::size_t blobs_removed = 0;
  /// Drops of one particle.
  std::size_t drops = 0;
  /// Such drops for which an obstacle leaves no space, that reach out of the clip box, or that are not larger
  /// than ReconstructionOptions::min_blob.
  std::size_t drops_left_out = 0;
  /// Vertices that smoothing, or the fit of the volume, moved off obstacles, or back, because they came too
  /// close.
  std::size_t vertices_held = 0;
  /// The volume inside the mesh [m³].
  double volume = 0;
  /// Working memory as planned, without input and output [bytes].
  double bytes = 0;
  /// Wall time by stage.
  ReconstructionSeconds seconds;
};

/// The most water of a particle that is accepted [m³]: 1000 s³, and a little for rounding. `spacing` in
/// metres.
double max_particle_volume(double spacing);

/// Makes the mesh. Refuses options out of range, arrays of different lengths, obstacles with numbers that are
/// not finite or indices out of range, and more memory than allowed; the mesh is then unchanged. Without
/// particles the mesh is empty.
Status reconstruct_surface(const ReconstructionInput& input, const ReconstructionOptions& options,
                           WaterMesh* mesh, ReconstructionReport* report = nullptr);

/// Makes one mesh after another, and keeps its memory between them: for a mesh in every frame. What depends
/// on the obstacles alone is kept, too, as long as they have the same numbers. reconstruct() gives the bits
/// of reconstruct_surface(), whatever it was called with before. One thread at a time may use it.
///
///     WaterMesher mesher;
///     for (each frame) status = mesher.reconstruct(input, options, &mesh);
class WaterMesher {
 public:
  WaterMesher();
  ~WaterMesher();
  /// Takes what the other has kept; the other may only be assigned to or destroyed then.
  WaterMesher(WaterMesher&&) noexcept;
  /// Takes what the other has kept; the other may only be assigned to or destroyed then.
  WaterMesher& operator=(WaterMesher&&) noexcept;

  /// As reconstruct_surface(), with the same refusals. `mesh` serves best if it is that of the last call: its
  /// memory is used, too.
  Status reconstruct(const ReconstructionInput& input, const ReconstructionOptions& options, WaterMesh* mesh,
                     ReconstructionReport* report = nullptr);

  /// Memory that is kept for the next call [bytes]. It is that of the largest call so far; a new object frees
  /// it.
  std::size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Options of the ellipsoids.
struct EllipsoidOptions {
  /// The rest distance s of the particles [m], 1e-6 … 1e3.
  double spacing = 0.005;
  /// The radius of the neighbourhood that gives a particle its shape, in spacings, 1 … 4.
  double reach = 2;
  /// The longest axis over the shortest one that neighbours can give, 1 … 20; k_r of [Yu2013]. At an obstacle
  /// an ellipsoid may become flatter.
  double max_stretch = 4;
  /// With fewer neighbours, a particle is a sphere, 0 … 1000; N_ε of [Yu2013].
  int min_neighbours = 6;
  /// How far a particle moves to the mean of its neighbours, 0 … 1; λ of [Yu2013]. Near obstacles it moves by
  /// half of its distance from the gap at most.
  double smoothing = 0;
  /// [m], 0 … 1 spacing: ellipsoids are farther than this from obstacles.
  double gap = 0;
  /// 0 = all hardware threads, or those of set_job_system(). The results do not depend on it.
  int threads = 0;

  /// Accepted, or the first field that is out of range.
  Status validate() const;
};

/// A particle drawn as an ellipsoid: for renderers that splat particles instead of drawing a mesh.
struct WaterEllipsoid {
  /// The centre [m].
  std::array<float, 3> position;
  /// Unit vectors along the axes; orthonormal to 1e-6, right-handed.
  std::array<std::array<float, 3>, 3> axes;
  /// The half axes [m], the longest first; 0 for particles that are not finite, have no water, or are nearer
  /// to an obstacle than the gap.
  std::array<float, 3> radii;
  /// The water that a ray along the shortest axis crosses, averaged over the ellipse that it covers [m]:
  /// 4/3 of the shortest half axis.
  float thickness;
};

/// An ellipsoid per particle, in the order of the input, from the covariance of its neighbours [Yu2013]
/// (R.35)–(R.38). It has the volume of its water, unless an obstacle leaves too little space. Neighbours
/// behind an obstacle do not count, and no ellipsoid touches a triangle of an obstacle or comes nearer to it
/// than the gap, up to the rounding of the result to float. Takes positions, volumes and obstacles of the
/// input. Refuses options out of range, and input that reconstruct_surface() refuses; `ellipsoids` is then
/// unchanged.
Status make_ellipsoids(const ReconstructionInput& input, const EllipsoidOptions& options,
                       std::vector<WaterEllipsoid>* ellipsoids);

/// The faults of a mesh. In a mesh without a fault all counts except `components` are zero.
struct MeshCheck {
  /// Pairs of a triangle of the mesh and one of an obstacle that are not certified to be disjoint.
  std::size_t intersecting_pairs = 0;
  /// Such pairs that are not certified to be farther apart than the gap.
  std::size_t too_close_pairs = 0;
  /// Connected pieces of obstacles with a point inside the mesh.
  std::size_t submerged_components = 0;
  /// Edges with one triangle.
  std::size_t open_edges = 0;
  /// Edges with more than two triangles.
  std::size_t crowded_edges = 0;
  /// Edges with two triangles that traverse them in the same direction.
  std::size_t misoriented_edges = 0;
  /// Vertices whose triangles form more than one fan.
  std::size_t pinched_vertices = 0;
  /// Connected pieces of the mesh that are inside out: they enclose a negative volume, and are no bubbles in
  /// a piece that encloses a positive one.
  std::size_t turned_components = 0;
  /// A lower bound of the distance to obstacles [m] if a pair is within gap + 1e-3 of the mesh's largest
  /// extent; otherwise infinite.
  double min_distance = std::numeric_limits<double>::infinity();
  /// Connected pieces of the mesh.
  std::size_t components = 0;
  /// The signed volume [m³].
  double volume = 0;

  /// Whether the mesh is closed, manifold and not inside out, and no point of an obstacle lies inside or
  /// closer than the gap.
  bool clean() const {
    return intersecting_pairs + too_close_pairs + submerged_components + open_edges + crowded_edges +
               misoriented_edges + pinched_vertices + turned_components ==
           0;
  }
};

/// Checks any triangle mesh. If no pair intersects, each piece of an obstacle is entirely inside or outside,
/// so one of its points decides. `gap` [m] ≥ 0. Indices in range and finite numbers are asserted.
MeshCheck check_mesh(const WaterMesh& mesh, Span<const ObstacleMesh> obstacles, double gap, int threads = 0);

}  // namespace oilskin
