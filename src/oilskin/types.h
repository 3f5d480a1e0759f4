/// The few types that every public header speaks.
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

namespace oilskin {

using Vec3 = Eigen::Vector3d;                   ///< position [m], velocity [m/s], impulse [N s]
using Triangle = std::array<std::uint32_t, 3>;  ///< indices of three nodes

/// A view of `size()` values that somebody else owns (std::span comes with C++20 only).
template <class T>
class Span {
 public:
  Span() = default;
  Span(T* data, std::size_t size) : data_(data), size_(size) {}
  template <class U, class = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
  Span(std::vector<U>& v) : data_(v.data()), size_(v.size()) {}
  template <class U, class = std::enable_if_t<std::is_convertible_v<const U (*)[], T (*)[]>>>
  Span(const std::vector<U>& v) : data_(v.data()), size_(v.size()) {}
  template <class U, class = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
  Span(Span<U> s) : data_(s.data()), size_(s.size()) {}

  template <class U, std::size_t N, class = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
  Span(U (&array)[N]) : data_(array), size_(N) {}

  T* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T& operator[](std::size_t i) const { return data_[i]; }
  T* begin() const { return data_; }
  T* end() const { return data_ + size_; }
  Span first(std::size_t n) const { return {data_, n}; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

/// An axis-aligned box; empty until something is added.
struct Box {
  Vec3 min = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 max = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec3& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  void add(const Box& b) {
    min = min.cwiseMin(b.min);
    max = max.cwiseMax(b.max);
  }
  Box inflated(double r) const { return {min - Vec3::Constant(r), max + Vec3::Constant(r)}; }
  bool overlaps(const Box& b) const {
    return min.x() <= b.max.x() && b.min.x() <= max.x() && min.y() <= b.max.y() && b.min.y() <= max.y() &&
           min.z() <= b.max.z() && b.min.z() <= max.z();
  }
  bool contains(const Box& b) const {
    return (min.array() <= b.min.array()).all() && (b.max.array() <= max.array()).all();
  }
  bool contains(const Vec3& p) const {
    return (min.array() <= p.array()).all() && (p.array() <= max.array()).all();
  }
};

/// The outcome of something that can be refused. A refusal leaves the state as it was, and its message says
/// where the fault lies and what would be right.
struct [[nodiscard]] Status {
  std::string message;  ///< empty: accepted

  bool ok() const { return message.empty(); }
  static Status accepted() { return {}; }
  static Status refused(std::string why) { return {std::move(why)}; }
};

}  // namespace oilskin
