#include "scene/fields.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace oilskin::demo {
namespace {

std::string short_number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%g", x);
  return text;
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({substitution, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

/// The value as the file has it, cut where it would flood a terminal.
std::string shown(const Json& value) {
  if (value.is_number_float() && !std::isfinite(value.get<double>()))
    return short_number(value.get<double>());
  std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

}  // namespace

std::string Range::text() const {
  const bool from = std::isfinite(minimum), to = std::isfinite(maximum);
  if (from && to)
    return (min_excluded ? "> " : "from ") + short_number(minimum) +
           (min_excluded ? " and at most " : " to ") + short_number(maximum);
  if (from) return std::string(min_excluded ? "> " : ">= ") + short_number(minimum);
  return "finite";
}

std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

std::string suggestion(const std::string& word, const std::vector<std::string>& known) {
  std::string best;
  std::size_t minimum = std::string::npos;
  for (const std::string& name : known) {
    const std::size_t d = edit_distance(word, name);
    if (d < minimum && 2 * d <= std::max(word.size(), name.size())) {
      minimum = d;
      best = name;
    }
  }
  return best.empty() ? "" : "; the nearest is \"" + best + "\"";
}

void Fields::fail(const std::string& key, const std::string& why) const {
  throw SceneError(path_of(key) + ": " + why);
}

const Json* Fields::find(const char* key) {
  known_.push_back(key);
  if (in_ == nullptr) return nullptr;
  const auto it = in_->find(key);
  return it == in_->end() ? nullptr : &*it;
}

const Json* Fields::raw(const char* key) {
  return find(key);
}

double Fields::finite(const Json& value, const std::string& key, const Range& range) const {
  if (!value.is_number()) fail(key, "is " + shown(value) + ", must be a number, " + range.text());
  const double x = value.get<double>();
  if (!std::isfinite(x) || !range.contains(x)) fail(key, "is " + shown(value) + ", must be " + range.text());
  return x;
}

std::vector<double> Fields::numbers(const Json& value, const std::string& key, std::size_t count,
                                    const Range& range) const {
  if (!value.is_array() || value.size() != count)
    fail(key, "is " + shown(value) + ", must be a list of " + std::to_string(count) + " numbers");
  std::vector<double> result;
  for (std::size_t i = 0; i < count; ++i)
    result.push_back(finite(value[i], key + "." + std::to_string(i), range));
  return result;
}

void Fields::number(const char* key, double& value, const Range& range) {
  if (out_ != nullptr) {
    if (std::isfinite(value)) (*out_)[key] = value;  // JSON has no infinity: absent means never or none
  } else if (const Json* found = find(key)) {
    value = finite(*found, key, range);
  }
}

void Fields::integer(const char* key, int& value, const Range& range) {
  if (out_ != nullptr) {
    (*out_)[key] = value;
  } else if (const Json* found = find(key)) {
    const double x =
        finite(*found, key, {std::max(range.minimum, -2147483647.0), std::min(range.maximum, 2147483647.0)});
    if (x != std::floor(x)) fail(key, "is " + shown(*found) + ", must be a whole number, " + range.text());
    value = static_cast<int>(x);
  }
}

void Fields::unsigned_integer(const char* key, std::uint64_t& value) {
  if (out_ != nullptr) {
    (*out_)[key] = value;
  } else if (const Json* found = find(key)) {
    const bool good =
        found->is_number_integer() && (found->is_number_unsigned() || found->get<std::int64_t>() >= 0);
    if (!good) fail(key, "is " + shown(*found) + ", must be a whole number >= 0");
    value = found->get<std::uint64_t>();
  }
}

void Fields::mask(const char* key, std::uint32_t& value) {
  std::uint64_t wide = value;
  unsigned_integer(key, wide);
  if (wide > 0xffffffffu) fail(key, "is " + std::to_string(wide) + ", must fit into 32 bits");
  value = static_cast<std::uint32_t>(wide);
}

void Fields::boolean(const char* key, bool& value) {
  if (out_ != nullptr) {
    (*out_)[key] = value;
  } else if (const Json* found = find(key)) {
    if (!found->is_boolean()) fail(key, "is " + shown(*found) + ", must be true or false");
    value = found->get<bool>();
  }
}

void Fields::text(const char* key, std::string& value) {
  if (out_ != nullptr) {
    (*out_)[key] = value;
  } else if (const Json* found = find(key)) {
    if (!found->is_string()) fail(key, "is " + shown(*found) + ", must be a text");
    value = found->get<std::string>();
  }
}

void Fields::vec3(const char* key, Vec3& value) {
  if (out_ != nullptr) {
    (*out_)[key] = {value.x(), value.y(), value.z()};
  } else if (const Json* found = find(key)) {
    const std::vector<double> x = numbers(*found, key, 3, between(-1e12, 1e12));
    value = Vec3(x[0], x[1], x[2]);
  }
}

void Fields::direction(const char* key, Vec3& value) {
  vec3(key, value);
  if (reading() && !(value.norm() > 1e-9)) fail(key, "is too short, must be longer than 1e-9");
}

void Fields::quaternion(const char* key, std::array<double, 4>& value) {
  if (out_ != nullptr) {
    (*out_)[key] = value;
  } else if (const Json* found = find(key)) {
    const std::vector<double> q = numbers(*found, key, 4, between(-1e6, 1e6));
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(norm > 1e-9)) fail(key, "is too short, must be a quaternion x, y, z, w longer than 1e-9");
    for (int i = 0; i < 4; ++i) value[i] = q[i] / norm;
  }
}

void Fields::pair(const char* key, std::array<double, 2>& value, const Range& range) {
  if (out_ != nullptr) {
    (*out_)[key] = value;
  } else if (const Json* found = find(key)) {
    const std::vector<double> x = numbers(*found, key, 2, range);
    value = {x[0], x[1]};
  }
}

void Fields::pair(const char* key, std::array<int, 2>& value, const Range& range) {
  std::array<double, 2> wide = {double(value[0]), double(value[1])};
  if (out_ != nullptr) {
    (*out_)[key] = value;
    return;
  }
  pair(key, wide, range);
  for (int i = 0; i < 2; ++i) {
    if (wide[i] != std::floor(wide[i]))
      fail(std::string(key) + "." + std::to_string(i), "must be a whole number");
    value[i] = static_cast<int>(wide[i]);
  }
}

void Fields::check_box(const Box& value) const {
  if (reading() && !(value.min.array() <= value.max.array()).all())
    throw SceneError(path_ + ": min and max must be given, and min not exceed max in any coordinate");
}

void Fields::box(const char* key, Box& value) {
  object(key, [&](Fields& f) {
    f.vec3("min", value.min);
    f.vec3("max", value.max);
    f.check_box(value);
  });
}

void Fields::object(const char* key, const Describe& describe) {
  if (out_ != nullptr) {
    Fields inner = writer((*out_)[key]);
    describe(inner);
    return;
  }
  const Json* found = find(key);
  if (found == nullptr) return;
  if (!found->is_object()) fail(key, "is " + shown(*found) + ", must be an object");
  Fields inner = reader(*found, path_of(key));
  describe(inner);
  inner.finish();
}

void Fields::json_object(const char* key, Json& value) {
  if (out_ != nullptr) {
    (*out_)[key] = value;
  } else if (const Json* found = find(key)) {
    if (!found->is_object()) fail(key, "is " + shown(*found) + ", must be an object");
    value = *found;
  }
}

template <class T, class F>
void Fields::optional_value(const char* key, std::optional<T>& value, const F& describe) {
  if (out_ != nullptr ? !value : !has(key)) {
    known_.push_back(key);
    return;
  }
  T x = value.value_or(T());
  describe(x);
  value = x;
}

void Fields::optional_number(const char* key, std::optional<double>& value, const Range& range) {
  optional_value(key, value, [&](double& x) { number(key, x, range); });
}

void Fields::optional_integer(const char* key, std::optional<int>& value, const Range& range) {
  optional_value(key, value, [&](int& x) { integer(key, x, range); });
}

void Fields::optional_boolean(const char* key, std::optional<bool>& value) {
  optional_value(key, value, [&](bool& x) { boolean(key, x); });
}

void Fields::names(const char* key, std::vector<std::string>& values, const std::vector<std::string>& known) {
  if (out_ != nullptr) {
    (*out_)[key] = values;
    return;
  }
  const Json* found = find(key);
  if (found == nullptr) return;
  const std::string all = joined(known);
  if (!found->is_array()) fail(key, "is " + shown(*found) + ", must be a list of words from " + all);
  std::vector<bool> named(known.size(), false);
  for (const Json& item : *found) {
    const std::string word = item.is_string() ? item.get<std::string>() : "";
    const auto at = static_cast<std::size_t>(std::find(known.begin(), known.end(), word) - known.begin());
    if (at == known.size()) fail(key, "has " + shown(item) + ", must be a list of words from " + all);
    if (named[at]) fail(key, "has " + shown(item) + " twice");
    named[at] = true;
  }
  values.clear();
  for (std::size_t i = 0; i < known.size(); ++i)
    if (named[i]) values.push_back(known[i]);
}

std::size_t Fields::chosen(const char* key, std::size_t current, const std::vector<std::string>& names) {
  if (out_ != nullptr) {
    (*out_)[key] = names[current];
    return current;
  }
  const Json* found = find(key);
  if (found == nullptr) return current;
  const std::string all = joined(names);
  if (!found->is_string()) fail(key, "is " + shown(*found) + ", must be one of " + all);
  const std::string word = found->get<std::string>();
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == word) return i;
  fail(key, "is \"" + word + "\", must be one of " + all + suggestion(word, names));
}

void Fields::finish() const {
  if (in_ == nullptr) return;
  for (const auto& item : in_->items()) {
    if (std::find(known_.begin(), known_.end(), item.key()) != known_.end()) continue;
    const std::string nearest = suggestion(item.key(), known_);
    std::vector<std::string> each_once;
    for (const std::string& key : known_)
      if (std::find(each_once.begin(), each_once.end(), key) == each_once.end()) each_once.push_back(key);
    throw SceneError(path_of(item.key()) + ": this key is not known" +
                     (nearest.empty() ? "; known are " + joined(each_once) : nearest));
  }
}

}  // namespace oilskin::demo
