/// @file
/// Types that all public headers use.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

/// SPH water for cloth that no particle crosses.
namespace oilskin {

/// A position [m], velocity [m/s] or impulse [N s].
using Vec3 = Eigen::Vector3d;
/// The indices of three nodes.
using Triangle = std::array<std::uint32_t, 3>;

/// A view of an array that it does not own (std::span needs C++20).
template <class T>
class Span {
 public:
  /// An empty view.
  Span() = default;
  /// A view of `size` values from `data` on.
  Span(T* data, std::size_t size) : data_(data), size_(size) {}
  /// A view of all values of a vector.
  template <class U, class = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
  Span(std::vector<U>& v) : data_(v.data()), size_(v.size()) {}
  /// A read-only view of all values of a vector.
  template <class U, class = std::enable_if_t<std::is_convertible_v<const U (*)[], T (*)[]>>>
  Span(const std::vector<U>& v) : data_(v.data()), size_(v.size()) {}
  /// A read-only view of what `s` views.
  template <class U, class = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
  Span(Span<U> s) : data_(s.data()), size_(s.size()) {}
  /// A view of all values of an array.
  template <class U, std::size_t N, class = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
  Span(U (&array)[N]) : data_(array), size_(N) {}

  /// The first value; null for a view without an array.
  T* data() const { return data_; }
  /// The number of values.
  std::size_t size() const { return size_; }
  /// Whether there are no values.
  bool empty() const { return size_ == 0; }
  /// Value i < size(), not checked.
  T& operator[](std::size_t i) const { return data_[i]; }
  /// The first value.
  T* begin() const { return data_; }
  /// Behind the last value.
  T* end() const { return data_ + size_; }
  /// A view of the first n ≤ size() values.
  Span first(std::size_t n) const { return {data_, n}; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

/// An axis-aligned box; empty until something is added.
struct Box {
  /// The smallest coordinates [m].
  Vec3 min = Vec3::Constant(std::numeric_limits<double>::infinity());
  /// The largest coordinates [m].
  Vec3 max = Vec3::Constant(-std::numeric_limits<double>::infinity());

  /// Extends the box to contain a point.
  void add(const Vec3& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  /// Extends the box to contain another.
  void add(const Box& b) {
    min = min.cwiseMin(b.min);
    max = max.cwiseMax(b.max);
  }
  /// The box with all sides moved outwards by r [m].
  Box inflated(double r) const { return {min - Vec3::Constant(r), max + Vec3::Constant(r)}; }
  /// Whether the closed boxes share a point.
  bool overlaps(const Box& b) const {
    return min.x() <= b.max.x() && b.min.x() <= max.x() && min.y() <= b.max.y() && b.min.y() <= max.y() &&
           min.z() <= b.max.z() && b.min.z() <= max.z();
  }
  /// Whether all of `b` lies in the closed box.
  bool contains(const Box& b) const {
    return (min.array() <= b.min.array()).all() && (b.max.array() <= max.array()).all();
  }
  /// Whether a point lies in the closed box.
  bool contains(const Vec3& p) const {
    return (min.array() <= p.array()).all() && (p.array() <= max.array()).all();
  }
};

/// The outcome of an operation that can be refused. A refusal leaves the state unchanged; its message names
/// the fault and a value that is accepted.
struct [[nodiscard]] Status {
  /// Why the operation was refused; empty if it was accepted.
  std::string message;

  /// Whether the operation was accepted.
  bool ok() const { return message.empty(); }
  /// The status of success.
  static Status accepted() { return {}; }
  /// The status of a refusal for the reason `why`, which is not empty.
  static Status refused(std::string why) { return {std::move(why)}; }
};

}  // namespace oilskin
