/// Means along films. Lengths in cells.
#pragma once

#include <algorithm>

#include "reconstruction/film.h"

namespace oilskin::reconstruction {

/// Two particles lie on the same side of the same sheet if their heights over each other's plane agree.
constexpr double height_slack = 0.4, slope_slack = 0.25;  // [dx], per distance

/// Above the grid's films, thinning fades out over this [cells].
constexpr double fade = 0.95;

/// The columns of water up to the first are films; from the second on [dx] they are not.
constexpr double film_up_to = 0.8, bulk_from = 1.4;

/// The kernel of the mean along a film: 4/(π L²) (1 − ρ²/L²)³.
struct FilmKernel {
  explicit FilmKernel(double reach)
      : inverse_(1 / (reach * reach)), norm_(4 / (3.14159265358979323846 * reach * reach)) {}
  double operator()(double rho_squared) const {
    const double u = std::max(0.0, 1 - rho_squared * inverse_);
    return norm_ * u * u * u;
  }

 private:
  double inverse_, norm_;
};

/// 1 where a column of water of this thickness [cells] is a film, 0 where it is not.
inline double thinness(const FilmRule& rule, double thickness) {
  return std::clamp((bulk_from - thickness / rule.spacing) / (bulk_from - film_up_to), 0.0, 1.0);
}

}  // namespace oilskin::reconstruction
