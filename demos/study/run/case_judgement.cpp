#include "study/run/case_judgement.h"

#include <algorithm>
#include <cmath>

namespace oilskin::demo {

double tolerance_at(const ValidationCase& of, const CaseRun& run, const Quantity& quantity) {
  const double coarser = std::max(1.0, run.spacing / of.spacings.back());
  return quantity.tolerance * std::pow(coarser, quantity.order);
}

const char* verdict(const ValidationCase& of, const CaseRun& run, const Quantity& quantity) {
  if (!std::isfinite(quantity.tolerance)) return "";
  return quantity.error() <= tolerance_at(of, run, quantity) ? "ok" : "MISSED";
}

bool passes(const ValidationCase& of, const CaseRun& run) {
  const auto in_tolerance = [&](const Quantity& q) { return q.error() <= tolerance_at(of, run, q); };
  return run.failure.empty() && run.crossings == 0 && !run.quantities.empty() &&
         std::all_of(run.quantities.begin(), run.quantities.end(), in_tolerance);
}

std::optional<double> observed_order(const CaseLevels& levels, const std::string& quantity) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const CaseRun& run : levels.runs)
    for (const Quantity& q : run.quantities) {
      if (q.name != quantity) continue;
      if (!(q.error() > q.uncertainty) || !std::isfinite(q.error())) return {};
      const double a = std::log(run.spacing), b = std::log(q.error());
      n += 1, x += a, y += b, xx += a * a, xy += a * b;
    }
  const double spread = n * xx - x * x;
  if (n < 2 || !(spread > 0)) return {};
  return (n * xy - x * y) / spread;
}

}  // namespace oilskin::demo
