/// Bounds of contacts on predicted displacements (F.36).
#pragma once

#include <algorithm>

#include "fluid/pressure/prediction_contact.h"

namespace oilskin::fluid {

/// Finds the contacts of particles that are asked for in ascending order.
class ContactCursor {
 public:
  /// `contacts` sorted by particle; `first` is the first particle that will be asked for.
  ContactCursor(Span<const PredictionContact> contacts, std::size_t first)
      : next_(std::lower_bound(contacts.begin(), contacts.end(), first,
                               [](const PredictionContact& c, std::size_t i) { return c.particle < i; })),
        end_(contacts.end()) {}

  Span<const PredictionContact> of(std::size_t particle) {
    const PredictionContact* first = next_;
    while (next_ != end_ && next_->particle == particle) ++next_;
    return {first, static_cast<std::size_t>(next_ - first)};
  }

 private:
  const PredictionContact *next_, *end_;
};

/// Removes what approaches a sheet beyond the bound, one contact after the other; twice where there are
/// several, since in a corner the later may undo the earlier. `displacement` in units of H, dt_over_h [s/m].
inline void keep_side(Span<const PredictionContact> contacts, double dt_over_h, Vec3& displacement) {
  for (int pass = 0; pass < (contacts.size() > 1 ? 2 : 1); ++pass)
    for (const PredictionContact& c : contacts) {
      const double missing = c.min_normal_velocity * dt_over_h - displacement.dot(c.normal);
      if (missing > 0) displacement += missing * c.normal;
    }
}

}  // namespace oilskin::fluid
