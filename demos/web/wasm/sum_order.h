// Included before every source of the page's module. Where Eigen has vectors of two doubles, as on x86-64 and
// ARM, it adds three doubles as (a + b) + c; where it has none, as here, as a + (b + c). With this the sums
// are those of the desktop. Sums of floats stay as they are: three do not fill a vector there.
#pragma once

#ifdef __cplusplus
#include <Eigen/Core>

#ifdef EIGEN_VECTORIZE
#error "Eigen has vectors here, so its order is that of the desktop without this file"
#endif

namespace Eigen::internal {

template <class Function, class Evaluator>
struct redux_novec_unroller<Function, Evaluator, 0, 3> {
  using Scalar = typename Evaluator::Scalar;
  static EIGEN_STRONG_INLINE Scalar run(const Evaluator& of, const Function& add) {
    const Scalar a = at(of, 0), b = at(of, 1), c = at(of, 2);
    return std::is_same<Scalar, double>::value ? add(add(a, b), c) : add(a, add(b, c));
  }

 private:
  /// As Eigen's own: lists are by columns or by rows.
  static Scalar at(const Evaluator& of, int k) {
    constexpr int inner = Evaluator::InnerSizeAtCompileTime;
    return of.coeffByOuterInner(k / inner, k % inner);
  }
};

}  // namespace Eigen::internal
#endif
