/// What the host of a surface did with loads so far, and is expected to do with those of this step.
#pragma once

#include <vector>

#include "oilskin/types.h"

namespace oilskin::contact {

/// One value per node; of a body two, of its velocity and of its angular velocity. Both lists are empty where
/// nothing is known, and nodes and bodies yield by their masses.
struct HostSupport {
  std::vector<Vec3> velocity;  ///< as the host proposed it, at the start of the step [m/s]
  std::vector<Vec3> carried;  ///< change of velocity by loads, from then to the end of the interval, that the
                              ///< host is expected to undo [m/s]
};

}  // namespace oilskin::contact
