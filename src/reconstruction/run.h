/// A run of the reconstruction: its stages, and what it keeps for the next one.
#pragma once

#include "reconstruction/narrow_band.h"
#include "reconstruction/obstacle_field.h"
#include "reconstruction/obstacle_memory.h"
#include "reconstruction/pieces.h"

namespace oilskin::reconstruction {

/// Refuses arrays of different lengths, numbers that are not finite, and volumes out of range. `spacing` in
/// metres.
Status validate_input(const ReconstructionInput& input, double spacing);

/// The data of a run. Nothing of an earlier run changes the result of the next one.
struct Workspace {
  /// For one run: obstacles far away are left out, and fields are freed as soon as they are not needed.
  bool is_for_one_run = true;
  std::unique_ptr<Workers> workers;
  int threads = 0;  ///< as asked for
  ParticleBlocks particles;
  std::vector<float> volumes;
  Obstacles obstacles;  ///< near the water; none in mode `none`
  Grid grid;
  ObstacleMemory memory;  ///< of what depends on the obstacles alone
  RawMesh mesh;

  /// Memory of the buffers [bytes].
  std::size_t bytes() const;
};

/// Input, options and data of one run.
struct Reconstruction {
  Reconstruction(const ReconstructionInput& i, const ReconstructionOptions& o, ReconstructionReport& r,
                 Workspace& w)
      : input(i),
        options(o),
        report(r),
        space(w),
        workers(*w.workers),
        obstacles(w.obstacles),
        particles(w.particles),
        volumes(w.volumes),
        grid(w.grid) {}

  const ReconstructionInput& input;
  const ReconstructionOptions& options;
  ReconstructionReport& report;
  Workspace& space;
  const Workers& workers;
  Obstacles& obstacles;
  ParticleBlocks& particles;
  std::vector<float>& volumes;
  Grid& grid;
  double cell = options.cell * options.spacing;  ///< [m]
  FieldParameters field = field_parameters(options);
  ContactParameters contact = contact_parameters(options);
  Box obstacle_region;  ///< [m]: obstacles that overlap it are known; none where the mode ignores them
  MemoryPlan memory{options.memory_limit};
  Water water;
  Film film;
  DrawnIn drawn_in;

  // The field
  Status gather_obstacles();
  Status find_narrow_band();
  void find_films();
  void find_drops();
  void measure_blocks();
  void evaluate_field();
  void add_films(std::uint32_t b, FieldBlock& evaluator, const NearParticles& near,
                 const BlockVisibility& visibility, float* values) const;
  std::vector<std::uint8_t> blocks_at_values() const;
  std::vector<std::uint8_t> blocks_with_needed_volumes() const;
  void evaluate_block(std::uint32_t b, FieldBlock& evaluator, NearParticles& near,
                      BlockVisibility& visibility);

  // The mesh
  void remove_small_pieces(RawMesh& mesh);
  bool keeps_gap() const { return contact.promises() && !obstacles.empty(); }
  void mesh_at_obstacles(RawMesh& mesh);
  std::vector<float> fit_to_water(const std::vector<std::array<float, 3>>& polygonised,
                                  const MeshParts& parts, const SurfaceBlocks& blocks, RawMesh& raw);
  std::vector<std::uint32_t> moved_near_obstacles(const std::vector<std::array<float, 3>>& start,
                                                  const RawMesh& raw) const;
  void put_back_what_fails(const std::vector<std::array<float, 3>>& start, RawMesh& raw);
  void append_drops(WaterMesh& mesh);
  void release_field();
  void finish(RawMesh& raw, WaterMesh& mesh);
};

}  // namespace oilskin::reconstruction
