// Four and eight floats at a time against one at a time: the same bits.
#include "core/simd.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
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
    expect_equal(a / b, [&](std::size_t k) { return rounded(x[k] / y[k]); });
    expect_equal(root(a * a), [&](std::size_t k) { return std::sqrt(rounded(x[k] * x[k])); });
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

TEST(Simd, eight_sums_are_added_in_pairs_from_the_halves) {
  test::Random random(17);
  Floats x, y;
  std::array<double, 8> sum{}, products{};
  F8 floats_sum(0.0f);
  Floats float_sum{};
  Sum8 doubles_sum, products_sum;
  for (int round = 0; round < 50; ++round) {
    for (std::size_t k = 0; k < 8; ++k) {
      x[k] = static_cast<float>(random.uniform(-2, 2));
      y[k] = static_cast<float>(random.uniform(-2, 2));
      float_sum[k] += x[k];
      sum[k] += static_cast<double>(x[k]);
      products[k] += static_cast<double>(x[k]) * static_cast<double>(y[k]);
    }
    floats_sum += F8::load(x.data());
    doubles_sum += F8::load(x.data());
    products_sum.add_product(F8::load(x.data()), F8::load(y.data()));
  }
  const auto in_order = [](const auto& s) {
    return ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
  };
  EXPECT_EQ(total(floats_sum), in_order(float_sum));
  EXPECT_EQ(doubles_sum.total(), in_order(sum));
  EXPECT_EQ(products_sum.total(), in_order(products));
}

TEST(Simd, eight_records_and_eight_values_are_gathered_by_index) {
  std::array<Record, 12> records;
  std::array<float, 12> values;
  for (std::size_t k = 0; k < 12; ++k) {
    const float f = static_cast<float>(k);
    records[k] = {10 * f, 10 * f + 1, 10 * f + 2, 10 * f + 3};
    values[k] = 7 * f;
  }
  const std::array<std::uint32_t, 8> index = {11, 0, 3, 3, 7, 1, 10, 5};
  const Record8 eight(records.data(), index.data());
  expect_equal(eight.x, [&](std::size_t k) { return records[index[k]].x; });
  expect_equal(eight.y, [&](std::size_t k) { return records[index[k]].y; });
  expect_equal(eight.z, [&](std::size_t k) { return records[index[k]].z; });
  expect_equal(eight.w, [&](std::size_t k) { return records[index[k]].w; });
  expect_equal(F8::gather(values.data(), index.data()), [&](std::size_t k) { return values[index[k]]; });
}

}  // namespace
}  // namespace oilskin::simd
