/// Serialisation: one function both writes and reads, so that the two cannot differ.
#pragma once

#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "oilskin/types.h"

namespace oilskin {

/// Writes values one after the other, or reads them in the same order. After the first refusal all values
/// read as zero or empty, so a visit runs to its end and checks ok() there. A list is never allocated longer
/// than the bytes that are left.
///
/// Numbers are copied in the byte order of the machine; the caller's header records it.
class Archive {
 public:
  explicit Archive(std::vector<std::uint8_t>& out) : out_(&out) {}
  explicit Archive(Span<const std::uint8_t> in) : in_(in) {}

  bool reading() const { return out_ == nullptr; }
  bool ok() const { return status_.ok(); }
  const Status& status() const { return status_; }
  std::size_t left() const { return in_.size() - at_; }
  /// Keeps the first refusal.
  void refuse(std::string why) {
    if (ok()) status_ = Status::refused(std::move(why));
    at_ = in_.size();
  }
  /// When reading: refuses unless `valid`.
  void require(bool valid, const char* what) {
    if (reading() && !valid) refuse(std::string(what) + " makes no sense");
  }

  template <class... T>
  void values(T&... all) {
    (value(all), ...);
  }

  /// A list of any type: f(element) visits an element, which takes `min_bytes` or more.
  template <class T, class F>
  void list(std::vector<T>& all, std::size_t min_bytes, const F& f) {
    resize(all, min_bytes);
    for (T& one : all) f(one);
  }

  /// What may be missing: f(value) visits it if it is there.
  template <class T, class F>
  void optional(std::optional<T>& one, const F& f) {
    bool has = one.has_value();
    value(has);
    if (!has) one.reset();
    if (!has) return;
    if (!one) one.emplace();
    f(*one);
  }

  void value(bool& x) {
    std::uint8_t byte = x ? 1 : 0;
    value(byte);
    require(byte <= 1, "a truth value");
    x = byte == 1;
  }
  void value(Vec3& x) { copy(x.data(), 3 * sizeof(double)); }
  void value(Box& x) { values(x.min, x.max); }
  template <class T, class = std::enable_if_t<std::is_arithmetic_v<T> || std::is_enum_v<T>>>
  void value(T& x) {
    copy(&x, sizeof x);
  }
  template <class T>
  void value(std::vector<T>& all) {
    static_assert(std::is_same_v<T, Vec3> || std::is_same_v<T, Triangle> || std::is_arithmetic_v<T>,
                  "visit the elements through list()");
    resize(all, sizeof(T));
    if (!all.empty()) copy(all.data(), all.size() * sizeof(T));
  }

 private:
  template <class T>
  void resize(std::vector<T>& all, std::size_t min_bytes) {
    std::uint64_t count = all.size();
    value(count);
    if (!reading()) return;
    if (count > left() / min_bytes) {
      refuse("a list is longer than the bytes that are left");
      count = 0;
    }
    all.clear();
    all.resize(static_cast<std::size_t>(count));
  }

  void copy(void* data, std::size_t bytes) {
    if (!reading()) {
      const auto* from = static_cast<const std::uint8_t*>(data);
      out_->insert(out_->end(), from, from + bytes);
      return;
    }
    if (bytes > left()) {
      std::memset(data, 0, bytes);
      refuse("the bytes end too early");
      return;
    }
    std::memcpy(data, in_.data() + at_, bytes);
    at_ += bytes;
  }

  std::vector<std::uint8_t>* out_ = nullptr;
  Span<const std::uint8_t> in_;
  std::size_t at_ = 0;
  Status status_;
};

static_assert(sizeof(Vec3) == 24 && sizeof(Triangle) == 12, "lists are copied as one block");

}  // namespace oilskin
