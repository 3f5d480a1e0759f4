/// The loops over pairs of particles, in versions for the instruction sets of the machine. All versions do
/// the same IEEE operations on eight pairs at a time and sum in the same order, without fused multiply-add:
/// they give the same bits.
///
/// Lengths are in units of H: Δ = (x_i − x_j)/H, q = |Δ|. Both sides compute a pair term by the same float
/// operations on the same numbers (differences change sign exactly, everything else commutes), so that f_ij =
/// −f_ji bit for bit. Terms that change velocities are summed in double: the momentum of the fluid is
/// conserved to 1e-16 per particle.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/simd.h"
#include "fluid/pairs/wall_kernels.h"

namespace oilskin::fluid {

using simd::Record;

/// Particles begin ≤ i < end of one chunk.
struct PairRange {
  std::size_t begin, end;
};

/// The neighbour lists of a chunk. Plain pointers, so that no function of a library is compiled for AVX2.
struct PairTable {
  const std::uint32_t* lists;       ///< each padded to a multiple of eight with a record that is far away
  const std::uint32_t* list_begin;  ///< per particle, where its list starts in `lists` and `slopes`
  const std::uint32_t* count;       ///< per particle
  float* slopes;                    ///< per pair: w'(q)/q, 0 for the padding; null = computed in each loop
  const float* mass_ratio;          ///< per particle: mass over that of a new one; null = all are 1
};

/// The pair term of viscosity and XSPH: a Δ − b (v_i − v_j) with a = v_ij·Δ (by_slope w'/q/(q² + 0.01) −
/// by_hat u²) and b = by_laplacian 6 u + (smoothing + min(by_strain |v_ij·Δ|/√(q² + 0.01), most_by_strain))
/// w, u = max(0, 1 − q).
struct PairFriction {
  float by_slope = 0, by_hat = 0, by_laplacian = 0, smoothing = 0, by_strain = 0, most_by_strain = 0;
};

/// Σ_j m_j w'/q Δ ⊗ Δ.
struct SecondMoments {
  float xx, yy, zz, xy, xz, yz;
};

/// Σ_j m_j of w'/q Δ, of w'/q (v_i − v_j)·Δ and of w'/q Δ ⊗ Δ, Σ_j m_j (w'/q)² q².
struct PairRates {
  Record gradient;    ///< w: the squares
  float compression;  ///< of the velocities
  SecondMoments moments;
};

/// A symmetric tensor of each particle: xx, yy, zz and xy, xz, yz. With one more for the padding.
struct Tensors {
  const Record *diagonal, *rest;
};

/// Of a velocity, or in units of H.
struct Change {
  double x, y, z;
};

/// What a pass over the pairs at the start of a step writes, for the particles of a range from 0 on. Null
/// where it is not asked for.
struct StartSums {
  float* density;    ///< Σ_j m_j w
  Change* friction;  ///< Σ_j m_j of the pair term
  PairRates* rates;
  std::uint8_t* is_close;  ///< whether a neighbour is nearer than √close_square
  float close_square;      ///< [H²]
};

/// Places beyond the last candidate: far away.
constexpr std::size_t candidate_padding = 16;

/// Candidates for neighbours. The arrays are AlignedVector and have `candidate_padding` more elements.
struct Candidates {
  const float *x, *y, *z;
  const std::uint32_t* particle;
  std::size_t count;
};

/// The loops of corrected gradients K_i Δ w'/q (F.77).
struct GradientKernels {
  /// Σ_j m_j φ_j w'/q K_j Δ_ij, φ being Record::w: what the pressures of the neighbours do. In float, for
  /// iterations.
  void (*pressure)(const PairTable&, const Record* x, const Tensors& k, PairRange, Record* out);
  /// Σ_j m_j w'/q (φ_i K_i + φ_j K_j) Δ_ij (F.79). In double, for what is applied.
  void (*pressure_exact)(const PairTable&, const Record* x, const Tensors& k, PairRange, Change* out);
  /// Σ_j m_j w'/q (K_i Δ_ij)·(y_i − y_j): the compression by displacements y [H], over D (F.78).
  void (*compression)(const PairTable&, const Record* x, const Tensors& k, const Record* y, PairRange,
                      float* out);
};

struct PairKernels {
  /// Writes the slopes, too, if the table has them. Friction and rates are both asked for, or only friction,
  /// or none.
  void (*start)(const PairTable&, const Record* x, const Record* v, const PairFriction&, PairRange,
                const StartSums&);
  /// Σ_j m_j w(q_ij) without i itself.
  void (*density)(const PairTable&, const Record* x, PairRange, float* out);
  /// Σ_j m_j (s_i + s_j) w'/q Δ_ij: the pressure gradient, s being Record::w. In float, for iterations.
  void (*pressure)(const PairTable&, const Record* x, PairRange, Record* out);
  /// The same in double, for what is applied.
  void (*pressure_exact)(const PairTable&, const Record* x, PairRange, Change* out);
  /// Σ_j m_j w'/q Δ_ij·(y_i − y_j): the compression by displacements y [H], over D (F.29).
  void (*compression)(const PairTable&, const Record* x, const Record* y, PairRange, float* out);
  GradientKernels corrected;
  /// Writes the places of the records [range.begin, range.end) to columns, which have space for eight more.
  /// Reads up to seven records beyond the range.
  void (*columns)(const Record* records, PairRange range, float* x, float* y, float* z);
  /// The candidates closer than 1 to p, in their order, to `out`, which has space for sixteen more. Returns
  /// their number.
  std::size_t (*near)(const Candidates&, const Record& p, std::uint32_t* out);
  /// 2π Λ_T of each edge (B.9), with its sign, to `out`, which has space for `count`.
  void (*edges)(const EdgeBlock*, std::size_t count, float* out);
  /// Bit k of out[b]: occluder k of block b may hide a part of the triangle. A quick test, true for all pairs
  /// of which one hides a part of the other.
  void (*hide)(const OccluderBlock*, std::size_t blocks, const Occluded&, std::uint8_t* out);
  /// The numbers of the triangles whose sphere contains p and whose plane is not farther than `plane_reach`,
  /// in their order. `out` has space for eight more.
  std::size_t (*touching)(const TriangleColumns&, const float* p, float plane_reach, std::uint32_t* out);
  /// closest_point() of triangles[index[k]]; `index` is padded to a multiple of four.
  void (*closest)(const Corners* triangles, const std::uint32_t* index, std::size_t count, const double* p,
                  ClosestBlock* out);
};

/// avx512: the search alone, otherwise avx2; the sums over pairs gain nothing from wider registers.
enum class InstructionSet { baseline, avx2, avx512 };
/// From the slowest to the fastest.
constexpr InstructionSet all_instruction_sets[] = {InstructionSet::baseline, InstructionSet::avx2,
                                                   InstructionSet::avx512};

/// Whether this machine and this build have it.
bool is_available(InstructionSet set);

/// The kernels of the best set that is available.
const PairKernels& pair_kernels();

/// That of pair_kernels().
InstructionSet instruction_set();

/// Those of `set`, which is available, from now on: for tests and measurements. Not while a step runs.
void use(InstructionSet set);

}  // namespace oilskin::fluid
