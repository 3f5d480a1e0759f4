// Four and eight floats at a time against one at a time: the same bits.
#include "core/simd.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "support/random.h"

namespace oilskin::simd {
namespace {

using Floats = std::array<float, 8>;

Floats random_floats(test::Random& random) {
  Floats x;
  for (float& v : x) v = static_cast<float>(random.uniform(-2, 2));
  x[random.below(8)] = 0.0f;
  x[random.below(8)] = -0.0f;
  x[random.below(8)] = std::numeric_limits<float>::infinity();
  return x;
}

Floats floats(const F8& a) {
  Floats x;
  a.store(x.data());
  return x;
}

std::uint32_t bits(float x) {
  std::uint32_t b;
  std::memcpy(&b, &x, sizeof b);
  return b;
}

template <class F>
void expect_equal(const F8& result, const F& expected) {
  const Floats x = floats(result);
  for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(bits(x[k]), bits(expected(k))) << k;
}

TEST(Simd, eight_floats_give_the_bits_of_single_floats) {
  test::Random random(11);
  for (int round = 0; round < 200; ++round) {
    const Floats x = random_floats(random), y = random_floats(random);
    const F8 a = F8::load(x.data()), b = F8::load(y.data());
    expect_equal(larger(a, b), [&](std::size_t k) { return x[k] > y[k] ? x[k] : y[k]; });
    expect_equal(smaller(a, b), [&](std::size_t k) { return x[k] < y[k] ? x[k] : y[k]; });
    expect_equal(positive_part(a), [&](std::size_t k) { return x[k] > 0 ? x[k] : 0.0f; });
    expect_equal(a * 0.5f, [&](std::size_t k) { return x[k] * 0.5f; });
    const std::uint32_t mask = greater_mask(a, b);
    for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(mask >> k & 1, x[k] > y[k] ? 1u : 0u);
    expect_equal(cleared(a, mask), [&](std::size_t k) { return mask >> k & 1 ? 0.0f : x[k]; });
  }
}

TEST(Simd, sums_and_products_are_rounded_like_single_floats) {
  test::Random random(13);
  for (int round = 0; round < 200; ++round) {
    Floats x, y;
    for (std::size_t k = 0; k < 8; ++k) {
      x[k] = static_cast<float>(random.uniform(-2, 2));
      y[k] = static_cast<float>(random.uniform(-2, 2));
    }
    const F8 a = F8::load(x.data()), b = F8::load(y.data());
    const auto rounded = [](float v) {
      volatile float stored = v;
      return static_cast<float>(stored);
    };
    expect_equal(a + b, [&](std::size_t k) { return rounded(x[k] + y[k]); });
    expect_equal(a - b, [&](std::size_t k) { return rounded(x[k] - y[k]); });
    expect_equal(a * b, [&](std::size_t k) { return rounded(x[k] * y[k]); });
  }
}

TEST(Simd, records_are_transposed_and_sums_kept_in_double) {
  const Record records[6] = {{0, 1, 2, 3},     {10, 11, 12, 13}, {20, 21, 22, 23},
                             {30, 31, 32, 33}, {40, 41, 42, 43}, {50, 51, 52, 53}};
  const std::uint32_t index[4] = {5, 0, 3, 1};
  const Record4 four(records, index);
  for (int k = 0; k < 4; ++k) {
    const Record& r = records[index[k]];
    EXPECT_EQ(four.x[k], r.x);
    EXPECT_EQ(four.y[k], r.y);
    EXPECT_EQ(four.z[k], r.z);
    EXPECT_EQ(four.w[k], r.w);
  }
  Sum4 sum;
  sum += F4(1e8f);
  sum += F4(1.0f);
  sum += F4(-1e8f);
  EXPECT_EQ(sum.total(), 4);
}

}  // namespace
}  // namespace oilskin::simd
