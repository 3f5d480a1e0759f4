/// Sparse systems of equations without symmetry, one thread, sums in fixed order.
#pragma once

#include <vector>

#include "oilskin/types.h"

namespace oilskin {

/// A square matrix by rows; the diagonal is kept apart.
struct SparseMatrix {
  /// Per row, into column and value; one more than there are rows.
  std::vector<std::uint32_t> begin;
  std::vector<std::uint32_t> column;
  std::vector<double> value;
  /// > 0.
  std::vector<double> diagonal;

  std::size_t size() const { return diagonal.size(); }
  /// y = A x
  void multiply(const std::vector<double>& x, std::vector<double>& y) const;
};

/// Solves A x = b, by BiCGSTAB [Vorst1992] with the diagonal as preconditioner, and by a direct method where
/// that does not converge.
class SparseSolver {
 public:
  /// `x`: first guess, then the solution. `weight`: per row; `magnitude`: of the solution. The solution is
  /// accepted when no residual times its weight exceeds `tolerance` × `magnitude`, or rounding. False: A is
  /// singular, and x is of no use.
  bool solve(const SparseMatrix& a, const std::vector<double>& b, const std::vector<double>& weight,
             double tolerance, double magnitude, std::vector<double>& x);

  /// Of the last solve; 0 for the direct method.
  int iterations() const { return iterations_; }

 private:
  void start(const SparseMatrix& a, const std::vector<double>& b, const std::vector<double>& x);
  bool iterate(const SparseMatrix& a, std::vector<double>& x);
  static double limit(const SparseMatrix& a, const std::vector<double>& weight, double tolerance,
                      double magnitude);
  bool is_solved(const std::vector<double>& weight, double limit) const;

  int iterations_ = 0;
  double rho_ = 1;
  std::vector<double> r_, shadow_, p_, v_, t_, y_, inverse_;
};

}  // namespace oilskin
