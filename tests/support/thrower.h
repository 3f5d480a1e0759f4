/// An effect that throws.
#pragma once

#include <stdexcept>

#include "oilskin/effect.h"

namespace oilskin::test {

/// Throws while asked to.
class Thrower : public Effect {
 public:
  bool throws_in_act = false, throws_in_exchange = false;

  std::string name() const override { return "thrower"; }
  void act(EffectForces&) override { throw_if(throws_in_act); }
  void exchange(EffectExchange&) override { throw_if(throws_in_exchange); }

 private:
  static void throw_if(bool asked) {
    if (asked) throw std::runtime_error("thrown by a test");
  }
};

}  // namespace oilskin::test
