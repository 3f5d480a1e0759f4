/// One JSON object of a scene file, read or written through the same description, so that what is read, what
/// is checked and what is written cannot drift apart.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "oilskin/types.h"

namespace oilskin::demo {

using Json = nlohmann::ordered_json;

/// What is wrong with a scene: names the key, the value and what would be right.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Accepted values of a number.
struct Range {
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  bool min_excluded = false;

  bool contains(double x) const { return (min_excluded ? x > minimum : x >= minimum) && x <= maximum; }
  std::string text() const;
};

inline Range any_number() {
  return {};
}
inline Range positive() {
  return {0, std::numeric_limits<double>::infinity(), true};
}
inline Range not_negative() {
  return {0, std::numeric_limits<double>::infinity(), false};
}
inline Range between(double minimum, double maximum) {
  return {minimum, maximum, false};
}

/// The names with `, ` between them.
std::string joined(const std::vector<std::string>& names);
/// `; the nearest is "NAME"` with the known name that is nearest to `word` by edit distance. Empty where none
/// has half of the letters of the longer of the two.
std::string suggestion(const std::string& word, const std::vector<std::string>& known);

/// Describe an object by naming its keys in turn. Absent keys keep the value they have: the default. finish()
/// refuses keys that nobody named.
class Fields {
 public:
  using Describe = std::function<void(Fields&)>;

  static Fields reader(const Json& object, const std::string& path) { return Fields(&object, nullptr, path); }
  static Fields writer(Json& object) {
    object = Json::object();
    return Fields(nullptr, &object, "");
  }

  bool reading() const { return in_ != nullptr; }
  /// The file holds the key; always false while writing.
  bool has(const char* key) const { return in_ != nullptr && in_->contains(key); }
  const std::string& path() const { return path_; }
  std::string path_of(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

  void number(const char* key, double& value, const Range& range);
  void integer(const char* key, int& value, const Range& range);
  void unsigned_integer(const char* key, std::uint64_t& value);
  void mask(const char* key, std::uint32_t& value);
  void boolean(const char* key, bool& value);
  void text(const char* key, std::string& value);
  /// A list of words from `known`, each once; kept in the order of `known`.
  void names(const char* key, std::vector<std::string>& values, const std::vector<std::string>& known);
  void vec3(const char* key, Vec3& value);
  /// A vector longer than zero.
  void direction(const char* key, Vec3& value);
  void quaternion(const char* key, std::array<double, 4>& value);
  void pair(const char* key, std::array<double, 2>& value, const Range& range);
  void pair(const char* key, std::array<int, 2>& value, const Range& range);
  void box(const char* key, Box& value);
  /// A corner of a box beside its other keys; check_box() afterwards.
  void check_box(const Box& value) const;
  void object(const char* key, const Describe& describe);
  /// An object that is read elsewhere.
  void json_object(const char* key, Json& value);

  void optional_number(const char* key, std::optional<double>& value, const Range& range);
  void optional_boolean(const char* key, std::optional<bool>& value);
  void optional_integer(const char* key, std::optional<int>& value, const Range& range);
  template <class T, class F>
  void optional_object(const char* key, std::optional<T>& value, F describe);
  template <class T, class F>
  void list(const char* key, std::vector<T>& values, F describe);
  template <class E>
  void choice(const char* key, E& value, const std::vector<std::pair<const char*, E>>& names);

  /// The value as it is in the file; null when absent or writing. The key counts as named.
  const Json* raw(const char* key);
  Json* out() { return out_; }
  [[noreturn]] void fail(const std::string& key, const std::string& why) const;

  void finish() const;

 private:
  Fields(const Json* in, Json* out, std::string path) : in_(in), out_(out), path_(std::move(path)) {}
  const Json* find(const char* key);
  double finite(const Json& value, const std::string& key, const Range& range) const;
  std::vector<double> numbers(const Json& value, const std::string& key, std::size_t count,
                              const Range& range) const;
  std::size_t chosen(const char* key, std::size_t current, const std::vector<std::string>& names);
  template <class T, class F>
  void optional_value(const char* key, std::optional<T>& value, const F& describe);

  const Json* in_;
  Json* out_;
  std::string path_;
  std::vector<std::string> known_;
};

template <class T, class F>
void Fields::optional_object(const char* key, std::optional<T>& value, F describe) {
  if (reading() && !has(key)) {
    known_.push_back(key);
    return;
  }
  if (!reading() && !value) return;
  if (reading()) value.emplace();
  object(key, [&](Fields& f) { describe(f, *value); });
}

template <class T, class F>
void Fields::list(const char* key, std::vector<T>& values, F describe) {
  if (!reading()) {
    Json& array = (*out_)[key] = Json::array();
    for (T& value : values) {
      Fields item = writer(array.emplace_back());
      describe(item, value);
    }
    return;
  }
  const Json* array = find(key);
  if (array == nullptr) return;
  if (!array->is_array()) fail(key, std::string("is ") + array->type_name() + ", must be a list of objects");
  values.clear();
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::string where = path_of(key) + "." + std::to_string(i);
    if (!(*array)[i].is_object())
      throw SceneError(where + ": is " + (*array)[i].type_name() + ", must be an object");
    Fields item = reader((*array)[i], where);
    describe(item, values.emplace_back());
    item.finish();
  }
}

template <class E>
void Fields::choice(const char* key, E& value, const std::vector<std::pair<const char*, E>>& names) {
  std::vector<std::string> texts;
  std::size_t current = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    texts.push_back(names[i].first);
    if (names[i].second == value) current = i;
  }
  value = names[chosen(key, current, texts)].second;
}

}  // namespace oilskin::demo
