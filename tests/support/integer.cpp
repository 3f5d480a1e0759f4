#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "support/exact.h"

namespace oilskin::exact {
namespace {

constexpr int kLimbBits = 32;

int bit_length(std::uint32_t x) {
  int length = 0;
  for (; x != 0; x >>= 1) ++length;
  return length;
}

}  // namespace

Integer::Integer(std::int64_t value) : negative_(value < 0) {
  // Negating through the unsigned type is defined for the most negative value too.
  std::uint64_t rest = negative_ ? 0 - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
  for (; rest != 0; rest >>= kLimbBits) magnitude_.push_back(static_cast<std::uint32_t>(rest));
}

Integer Integer::from_double(double value, int shift) {
  if (!std::isfinite(value)) throw std::invalid_argument("exact arithmetic needs finite numbers");
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
  const int total = exponent - 53 + shift;
  const Integer whole(mantissa);
  if (total >= 0) return whole << total;
  if (whole.sign() != 0 && whole.trailing_zeros() < -total) throw std::invalid_argument("not a whole number");
  return whole >> -total;
}

void Integer::trim() {
  while (!magnitude_.empty() && magnitude_.back() == 0) magnitude_.pop_back();
  if (magnitude_.empty()) negative_ = false;
}

int Integer::bits() const {
  if (magnitude_.empty()) return 0;
  return kLimbBits * static_cast<int>(magnitude_.size() - 1) + bit_length(magnitude_.back());
}

int Integer::trailing_zeros() const {
  if (magnitude_.empty()) return 0;
  int i = 0;
  while (!bit(i)) i += magnitude_[i / kLimbBits] == 0 ? kLimbBits : 1;
  return i;
}

bool Integer::bit(int i) const {
  const auto limb = static_cast<std::size_t>(i / kLimbBits);
  return limb < magnitude_.size() && ((magnitude_[limb] >> (i % kLimbBits)) & 1u) != 0;
}

Integer Integer::operator-() const {
  Integer result = *this;
  result.negative_ = !negative_ && !magnitude_.empty();
  return result;
}

int Integer::compare_magnitudes(const Integer& a, const Integer& b) {
  if (a.magnitude_.size() != b.magnitude_.size()) return a.magnitude_.size() < b.magnitude_.size() ? -1 : 1;
  for (std::size_t i = a.magnitude_.size(); i-- > 0;) {
    if (a.magnitude_[i] != b.magnitude_[i]) return a.magnitude_[i] < b.magnitude_[i] ? -1 : 1;
  }
  return 0;
}

Integer Integer::add_magnitudes(const Integer& a, const Integer& b) {
  const Integer& longer = a.magnitude_.size() < b.magnitude_.size() ? b : a;
  const Integer& shorter = &longer == &a ? b : a;
  Integer sum;
  sum.magnitude_.resize(longer.magnitude_.size() + 1);
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i < longer.magnitude_.size(); ++i) {
    carry += longer.magnitude_[i];
    if (i < shorter.magnitude_.size()) carry += shorter.magnitude_[i];
    sum.magnitude_[i] = static_cast<std::uint32_t>(carry);
    carry >>= kLimbBits;
  }
  sum.magnitude_.back() = static_cast<std::uint32_t>(carry);
  sum.trim();
  return sum;
}

Integer Integer::subtract_magnitudes(const Integer& larger, const Integer& smaller) {
  Integer difference;
  difference.magnitude_.resize(larger.magnitude_.size());
  std::int64_t borrow = 0;
  for (std::size_t i = 0; i < larger.magnitude_.size(); ++i) {
    std::int64_t limb = static_cast<std::int64_t>(larger.magnitude_[i]) - borrow;
    if (i < smaller.magnitude_.size()) limb -= smaller.magnitude_[i];
    borrow = limb < 0 ? 1 : 0;
    difference.magnitude_[i] = static_cast<std::uint32_t>(limb + (borrow << kLimbBits));
  }
  difference.trim();
  return difference;
}

Integer Integer::operator+(const Integer& other) const {
  Integer result;
  if (negative_ == other.negative_) {
    result = add_magnitudes(*this, other);
    result.negative_ = negative_ && !result.magnitude_.empty();
    return result;
  }
  const int order = compare_magnitudes(*this, other);
  if (order == 0) return {};
  result = order > 0 ? subtract_magnitudes(*this, other) : subtract_magnitudes(other, *this);
  result.negative_ = order > 0 ? negative_ : other.negative_;
  return result;
}

Integer Integer::operator-(const Integer& other) const {
  return *this + (-other);
}

Integer Integer::operator*(const Integer& other) const {
  Integer product;
  if (sign() == 0 || other.sign() == 0) return product;
  product.magnitude_.assign(magnitude_.size() + other.magnitude_.size(), 0);
  for (std::size_t i = 0; i < magnitude_.size(); ++i) {
    std::uint64_t carry = 0;
    for (std::size_t j = 0; j < other.magnitude_.size(); ++j) {
      carry += static_cast<std::uint64_t>(magnitude_[i]) * other.magnitude_[j] + product.magnitude_[i + j];
      product.magnitude_[i + j] = static_cast<std::uint32_t>(carry);
      carry >>= kLimbBits;
    }
    product.magnitude_[i + other.magnitude_.size()] = static_cast<std::uint32_t>(carry);
  }
  product.negative_ = negative_ != other.negative_;
  product.trim();
  return product;
}

Integer Integer::operator<<(int count) const {
  if (sign() == 0 || count == 0) return *this;
  const auto limbs = static_cast<std::size_t>(count / kLimbBits);
  const int rest = count % kLimbBits;
  Integer result;
  result.negative_ = negative_;
  result.magnitude_.assign(magnitude_.size() + limbs + 1, 0);
  for (std::size_t i = 0; i < magnitude_.size(); ++i) {
    const std::uint64_t wide = static_cast<std::uint64_t>(magnitude_[i]) << rest;
    result.magnitude_[i + limbs] |= static_cast<std::uint32_t>(wide);
    result.magnitude_[i + limbs + 1] |= static_cast<std::uint32_t>(wide >> kLimbBits);
  }
  result.trim();
  return result;
}

Integer Integer::operator>>(int count) const {
  const auto limbs = static_cast<std::size_t>(count / kLimbBits);
  const int rest = count % kLimbBits;
  Integer result;
  if (limbs >= magnitude_.size()) return result;
  result.negative_ = negative_;
  result.magnitude_.assign(magnitude_.size() - limbs, 0);
  for (std::size_t i = limbs; i < magnitude_.size(); ++i) {
    std::uint64_t wide = magnitude_[i];
    if (i + 1 < magnitude_.size()) wide |= static_cast<std::uint64_t>(magnitude_[i + 1]) << kLimbBits;
    result.magnitude_[i - limbs] = static_cast<std::uint32_t>(wide >> rest);
  }
  result.trim();
  return result;
}

bool Integer::operator==(const Integer& other) const {
  return negative_ == other.negative_ && magnitude_ == other.magnitude_;
}

}  // namespace oilskin::exact
