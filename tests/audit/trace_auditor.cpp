#include "audit/trace_auditor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ostream>
#include <unordered_map>
#include <unordered_set>

#include "audit/pair_filter.h"
#include "audit/triangle_grid.h"
#include "support/exact.h"

namespace oilskin::audit {
namespace {

constexpr std::size_t kMostDetails = 20;
constexpr double kNearTolerance = 1e-12;  // relative to δ

bool finite(const Point& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

bool same_bits(const Point& a, const Point& b) {
  return std::memcmp(a.data(), b.data(), sizeof(Point)) == 0;
}

std::string where(std::uint64_t number) {
  return "interval " + std::to_string(number) + ": ";
}

std::string name(std::uint64_t particle, std::uint64_t surface, std::size_t triangle) {
  return "particle " + std::to_string(particle) + ", surface " + std::to_string(surface) + ", triangle " +
         std::to_string(triangle);
}

/// A triangle that can be tested: its indices are in range and its corners finite.
struct Candidate {
  const Surface* surface;
  std::size_t triangle;
  double delta;

  const Point& corner(bool at_end, int i) const {
    return (at_end ? surface->end : surface->start)[surface->triangles[triangle][i]];
  }
};

bool testable(const Surface& surface, const std::array<std::uint32_t, 3>& triangle) {
  return std::all_of(triangle.begin(), triangle.end(), [&](std::uint32_t i) {
    return i < surface.start.size() && finite(surface.start[i]) && finite(surface.end[i]);
  });
}

/// The swept box, enlarged by δ and a little more so that rounding cannot make it too small.
Bounds swept_bounds(const Candidate& c) {
  Bounds box = bounds_of(c.corner(false, 0), c.corner(true, 0));
  for (int i = 1; i < 3; ++i) {
    extend(&box, c.corner(false, i));
    extend(&box, c.corner(true, i));
  }
  for (int k = 0; k < 3; ++k) {
    const double margin =
        c.delta > 0 ? c.delta + 1e-12 * (c.delta + std::abs(box.low[k]) + std::abs(box.high[k])) : 0;
    box.low[k] -= margin;
    box.high[k] += margin;
  }
  return box;
}

std::vector<Candidate> candidates_of(const Record& record, const Limits& limits) {
  std::vector<Candidate> candidates;
  for (const Surface& surface : record.surfaces) {
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
      if (testable(surface, surface.triangles[i])) candidates.push_back({&surface, i, limits.of(surface.id)});
    }
  }
  return candidates;
}

std::unordered_map<std::uint64_t, std::size_t> indices_by_id(const std::vector<std::uint64_t>& ids) {
  std::unordered_map<std::uint64_t, std::size_t> index;
  index.reserve(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) index.emplace(ids[i], i);
  return index;
}

}  // namespace

void Auditor::report(std::uint64_t* counter, const std::string& what) {
  ++*counter;
  if (summary_.details.size() < kMostDetails) summary_.details.push_back(what);
}

void Auditor::audit(const Record& record) {
  ++summary_.records;
  check_form(record);
  if (summary_.records > 1) check_jumps(record);
  check_pairs(record);
  previous_ = record;
}

void Auditor::check_form(const Record& record) {
  const std::string here = where(record.number);
  if (summary_.records > 1 && record.number <= previous_.number) {
    report(&summary_.invalid, here + "does not come after interval " + std::to_string(previous_.number));
  }
  if (!(std::isfinite(record.length) && record.length > 0)) report(&summary_.invalid, here + "bad length");
  std::unordered_set<std::uint64_t> ids;
  for (std::size_t i = 0; i < record.ids.size(); ++i) {
    const std::string particle = here + "particle " + std::to_string(record.ids[i]);
    if (!ids.insert(record.ids[i]).second) report(&summary_.invalid, particle + " stands twice");
    if (!finite(record.start[i]) || !finite(record.end[i]))
      report(&summary_.invalid, particle + " is not finite");
  }
  ids.clear();
  for (const Surface& surface : record.surfaces) {
    const std::string sheet = here + "surface " + std::to_string(surface.id);
    if (!ids.insert(surface.id).second) report(&summary_.invalid, sheet + " stands twice");
    for (std::size_t i = 0; i < surface.start.size(); ++i) {
      if (finite(surface.start[i]) && finite(surface.end[i])) continue;
      report(&summary_.invalid, sheet + ", vertex " + std::to_string(i) + " is not finite");
    }
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
      const auto& t = surface.triangles[i];
      if (std::max({t[0], t[1], t[2]}) < surface.start.size()) continue;
      report(&summary_.invalid, sheet + ", triangle " + std::to_string(i) + " has an index out of range");
    }
  }
}

void Auditor::check_surface_jump(const Surface& before, const Surface& now, std::uint64_t number) {
  const std::string sheet = where(number) + "surface " + std::to_string(now.id);
  if (before.end.size() != now.start.size() || before.triangles != now.triangles) {
    report(&summary_.jumps, sheet + " changed its mesh but not its id");
    return;
  }
  for (std::size_t i = 0; i < now.start.size(); ++i) {
    if (!same_bits(before.end[i], now.start[i])) {
      report(&summary_.jumps, sheet + ", vertex " + std::to_string(i) + " jumps");
    }
  }
}

void Auditor::check_jumps(const Record& record) {
  const auto before = indices_by_id(previous_.ids);
  for (std::size_t i = 0; i < record.ids.size(); ++i) {
    const auto found = before.find(record.ids[i]);
    if (found == before.end() || same_bits(previous_.end[found->second], record.start[i])) continue;
    report(&summary_.jumps, where(record.number) + "particle " + std::to_string(record.ids[i]) + " jumps");
  }
  for (const Surface& now : record.surfaces) {
    for (const Surface& surface : previous_.surfaces) {
      if (surface.id == now.id) check_surface_jump(surface, now, record.number);
    }
  }
}

void Auditor::check_pairs(const Record& record) {
  const std::vector<Candidate> candidates = candidates_of(record, limits_);
  std::vector<Bounds> boxes;
  boxes.reserve(candidates.size());
  for (const Candidate& c : candidates) boxes.push_back(swept_bounds(c));
  TriangleGrid grid(boxes);
  summary_.particles += record.ids.size();
  summary_.triangles += candidates.size();

  for (std::size_t p = 0; p < record.ids.size(); ++p) {
    if (!finite(record.start[p]) || !finite(record.end[p])) continue;
    grid.for_each_overlap(bounds_of(record.start[p], record.end[p]), [&](std::uint32_t index) {
      const Candidate& c = candidates[index];
      const Pair pair{{record.start[p], c.corner(false, 0), c.corner(false, 1), c.corner(false, 2)},
                      {record.end[p], c.corner(true, 0), c.corner(true, 1), c.corner(true, 2)}};
      ++summary_.pairs;
      const bool path_clear = certainly_apart(pair);
      const bool end_clear = !(c.delta > 0) || certainly_beyond(pair, c.delta);
      if (path_clear && end_clear) return;
      ++summary_.exact_pairs;
      const auto what = [&] { return name(record.ids[p], c.surface->id, c.triangle); };
      if (!path_clear) {
        const exact::Answer answer = exact::point_triangle({pair.start, pair.end});
        if (answer.hit && answer.crosses)
          report(&summary_.crossings, where(record.number) + what() + " cross");
        if (answer.hit && !answer.crosses)
          report(&summary_.touchings, where(record.number) + what() + " touch");
      }
      const auto& x = pair.end;
      if (!end_clear && exact::nearer_than(x[0], x[1], x[2], x[3], c.delta * (1 - kNearTolerance))) {
        report(&summary_.too_near, where(record.number) + what() + " are too near at the end");
      }
    });
  }
}

std::ostream& operator<<(std::ostream& out, const Summary& s) {
  for (const std::string& detail : s.details) out << detail << '\n';
  if (s.findings() > s.details.size()) out << "… and " << s.findings() - s.details.size() << " more\n";
  return out << "records " << s.records << ", particles " << s.particles << ", triangles " << s.triangles
             << ", pairs " << s.pairs << ", tested exactly " << s.exact_pairs << ", crossings " << s.crossings
             << ", touchings " << s.touchings << ", too near " << s.too_near << ", jumps " << s.jumps
             << ", invalid " << s.invalid << '\n';
}

bool audit_stream(std::istream& in, const Limits& limits, Summary* summary, std::string* error) {
  Auditor auditor(limits);
  Record record;
  ReadResult result = ReadResult::kRecord;
  while ((result = read_record(in, &record, error)) == ReadResult::kRecord) auditor.audit(record);
  *summary = auditor.summary();
  if (result == ReadResult::kMalformed)
    *error = "record " + std::to_string(summary->records + 1) + ": " + *error;
  if (result == ReadResult::kEnd && summary->records == 0) *error = "holds no record";
  return result == ReadResult::kEnd && summary->records > 0;
}

}  // namespace oilskin::audit
