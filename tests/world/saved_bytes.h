/// What tests of saving share.
#pragma once

#include <gtest/gtest.h>

#include "oilskin/world.h"

namespace oilskin::test {

using Bytes = std::vector<std::uint8_t>;

inline Bytes save(const World& w) {
  Bytes bytes;
  const Status s = w.save(&bytes);
  EXPECT_TRUE(s.ok()) << s.message;
  return bytes;
}

inline FluidSettings dfsph() {
  FluidSettings f;
  f.solver = PressureSolver::dfsph;
  return f;
}

}  // namespace oilskin::test
