// The continuous test and its rivals at hand on the same queries: false answers against exact arithmetic,
// mean and worst time on one thread, and how often each of our exits is taken.
//
// use: ccd_benchmark [--trace FILE] [--queries N = 2000] [FILE.csv…]
// FILE.csv: labelled queries (tests/ccd/data). The trace of a run gives the pairs that a broad phase hands
// over: oilskin run jet --duration 0.3 --trace FILE --trace-steps 250:256
//
// Bullet is asked as its deformable bodies ask (bernsteinCCD), FCL by intersect_VF. A time is the median and,
// behind it, the least of several passes; the worst single query is the largest of each query's least time.
#include <fcl/narrowphase/detail/traversal/collision/intersect.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "audit/motion_trace.h"
#include "audit/pair_filter.h"
#include "ccd/coplanarity_cubic.h"
#include "ccd/filter.h"
#include "ccd/point_triangle.h"
#include "ccd/queries.h"
#include "ccd_command.h"

// Last, for it defines global names that others use for parameters.
#include <BulletSoftBody/btSoftBodyInternals.h>

using namespace oilskin;
using demo::LabelledQuery;

namespace {

constexpr int kPasses = 9;

struct Set {
  std::string name;
  std::vector<LabelledQuery> queries;
};

bool ours(const ccd::PointTriangleMotion& m) {
  return ccd::point_triangle(m).hit;
}

bool fcls(const ccd::PointTriangleMotion& m) {
  double time = 0;
  Vec3 where;
  return fcl::detail::Intersect<double>::intersect_VF(m.a_t0, m.b_t0, m.c_t0, m.p_t0, m.a_t1, m.b_t1, m.c_t1,
                                                      m.p_t1, &time, &where);
}

/// Bullet reads nodes; filling them is part of what is timed (24 copies).
bool bullets(const ccd::PointTriangleMotion& m) {
  static btSoftBody::Node nodes[4];
  static btSoftBody::Face face;
  const auto set = [](btSoftBody::Node& node, const Vec3& start, const Vec3& end) {
    node.m_x.setValue(start[0], start[1], start[2]);
    node.m_v.setValue(end[0] - start[0], end[1] - start[1], end[2] - start[2]);
  };
  set(nodes[0], m.p_t0, m.p_t1);
  set(nodes[1], m.a_t0, m.a_t1);
  set(nodes[2], m.b_t0, m.b_t1);
  set(nodes[3], m.c_t0, m.c_t1);
  for (int i = 0; i < 3; ++i) face.m_n[i] = &nodes[1 + i];
  btVector3 weights;
  return bernsteinCCD(&face, &nodes[0], 1, SAFE_EPSILON, weights);
}

double nanoseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
}

template <class Test>
void measure(const char* who, const Set& set, Test test) {
  std::size_t found = 0, hits = 0, false_negatives = 0, false_positives = 0;
  for (const LabelledQuery& q : set.queries) {
    const bool hit = test(q.motion);
    hits += q.hit ? 1 : 0;
    false_negatives += q.hit && !hit ? 1 : 0;
    false_positives += !q.hit && hit ? 1 : 0;
  }
  const auto count = static_cast<double>(set.queries.size());
  std::vector<double> mean(kPasses), minimum(set.queries.size(), 1e18);
  for (double& pass : mean) {
    const auto start = std::chrono::steady_clock::now();
    for (const LabelledQuery& q : set.queries) found += test(q.motion) ? 1 : 0;
    pass = nanoseconds_since(start) / count;
  }
  for (int pass = 0; pass < kPasses; ++pass) {
    for (std::size_t i = 0; i < minimum.size(); ++i) {
      const auto start = std::chrono::steady_clock::now();
      found += test(set.queries[i].motion) ? 1 : 0;
      minimum[i] = std::min(minimum[i], nanoseconds_since(start));
    }
  }
  // A use of the results keeps the loops from being optimised away.
  if (found != 2 * kPasses * (hits - false_negatives + false_positives)) std::abort();
  std::sort(mean.begin(), mean.end());
  const double worst = minimum.empty() ? 0 : *std::max_element(minimum.begin(), minimum.end());
  const auto slow = std::count_if(minimum.begin(), minimum.end(), [](double ns) { return ns > 20000; });
  std::printf("  %-8s FN %6zu  FP %6zu  mean %9.1f ns (least %9.1f)  worst %8.2f us  above 20 us: %ld\n", who,
              false_negatives, false_positives, mean[kPasses / 2], mean[0], worst / 1000,
              static_cast<long>(slow));
}

/// The stage of our test that decides a query.
struct Exits {
  std::size_t axis = 0, one_sign = 0, filter_apart = 0, filter_impact = 0, exact = 0;

  void add(const ccd::PointTriangleMotion& m) {
    using namespace ccd::detail;
    const FilterResult result = filter(m);
    if (result.verdict == Verdict::impact) ++filter_impact;
    if (result.verdict == Verdict::unclear) ++exact;
    if (result.verdict != Verdict::apart) return;
    RelativeMotion relative;
    const Vec3 *t0[] = {&m.a_t0, &m.b_t0, &m.c_t0}, *t1[] = {&m.a_t1, &m.b_t1, &m.c_t1};
    bool separated = false;
    for (int k = 0; k < 3; ++k) {
      int positive = 0, negative = 0;
      for (int i = 0; i < 3; ++i) {
        relative.t0[i][k] = (*t0[i])[k] - m.p_t0[k];
        relative.t1[i][k] = (*t1[i])[k] - m.p_t1[k];
        for (double x : {relative.t0[i][k], relative.t1[i][k]})
          (x > 0 ? positive : negative) += x != 0 ? 1 : 0;
      }
      separated = separated || positive == 6 || negative == 6;
    }
    if (separated) {
      ++axis;
      return;
    }
    const CoplanarityCubic cubic(m, relative);
    int signs = 0;
    for (double k : cubic.coefficients().k) signs += cubic.sign(k);
    ++(cubic.bounded() && std::abs(signs) == 4 ? one_sign : filter_apart);
  }
};

void report(const Set& set) {
  std::size_t hits = 0;
  Exits exits;
  for (const LabelledQuery& q : set.queries) {
    hits += q.hit ? 1 : 0;
    exits.add(q.motion);
  }
  const double percent = 100.0 / static_cast<double>(std::max<std::size_t>(set.queries.size(), 1));
  std::printf("%s: %zu queries, %zu hits\n", set.name.c_str(), set.queries.size(), hits);
  std::printf(
      "  exits: axis or rest %.2f %%, cubic of one sign %.2f %%, separated %.2f %%, met %.2f %%, exact %.3f "
      "%%\n",
      exits.axis * percent, exits.one_sign * percent, exits.filter_apart * percent,
      exits.filter_impact * percent, exits.exact * percent);
  measure("oilskin", set, ours);
  measure("Bullet", set, bullets);
  measure("FCL", set, fcls);
  std::fflush(stdout);
}

// ---- Pairs of a run ----

struct Box {
  audit::Point low, high;

  void add(const audit::Point& x) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], x[k]);
      high[k] = std::max(high[k], x[k]);
    }
  }
  bool overlaps(const Box& other) const {
    for (int k = 0; k < 3; ++k) {
      if (high[k] < other.low[k] || other.high[k] < low[k]) return false;
    }
    return true;
  }
};

Vec3 to_vec(const audit::Point& x) {
  return {x[0], x[1], x[2]};
}

/// Every particle and every triangle whose boxes over the interval overlap.
void append_pairs(const audit::Record& record, Set* set) {
  for (const audit::Surface& s : record.surfaces) {
    std::vector<Box> boxes;
    for (const auto& t : s.triangles) {
      Box box{s.start[t[0]], s.start[t[0]]};
      for (const std::uint32_t v : t) {
        box.add(s.start[v]);
        box.add(s.end[v]);
      }
      boxes.push_back(box);
    }
    for (std::size_t p = 0; p < record.ids.size(); ++p) {
      Box path{record.start[p], record.start[p]};
      path.add(record.end[p]);
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (!path.overlaps(boxes[i])) continue;
        const auto& t = s.triangles[i];
        const audit::Pair pair{{record.start[p], s.start[t[0]], s.start[t[1]], s.start[t[2]]},
                               {record.end[p], s.end[t[0]], s.end[t[1]], s.end[t[2]]}};
        LabelledQuery q;
        q.motion = {to_vec(pair.start[0]), to_vec(pair.start[1]), to_vec(pair.start[2]),
                    to_vec(pair.start[3]), to_vec(pair.end[0]),   to_vec(pair.end[1]),
                    to_vec(pair.end[2]),   to_vec(pair.end[3])};
        q.hit = !audit::certainly_apart(pair) && exact::point_triangle({pair.start, pair.end}).hit;
        set->queries.push_back(q);
      }
    }
  }
}

bool read_trace(const std::string& file, Set* set) {
  std::ifstream in(file, std::ios::binary);
  audit::Record record;
  std::string error = "cannot be opened";
  auto result = in ? audit::ReadResult::kRecord : audit::ReadResult::kMalformed;
  while (result == audit::ReadResult::kRecord) {
    result = audit::read_record(in, &record, &error);
    if (result == audit::ReadResult::kRecord) append_pairs(record, set);
  }
  if (result == audit::ReadResult::kMalformed) std::fprintf(stderr, "%s: %s\n", file.c_str(), error.c_str());
  return result == audit::ReadResult::kEnd;
}

Set family_set(std::size_t index, int count) {
  const test::Family& family = test::families()[index];
  Set set{family.name, {}};
  test::Random random(1000 + index);
  for (int i = 0; i < (family.wide ? count / 10 : count); ++i) {
    const test::Corners x = family.make(random);
    set.queries.push_back({test::to_motion(x), exact::point_triangle(test::to_exact(x)).hit});
  }
  return set;
}

void append(const Set& from, Set* to) {
  to->queries.insert(to->queries.end(), from.queries.begin(), from.queries.end());
}

}  // namespace

int main(int argc, char** argv) {
  int count = 2000;
  Set files{"handcrafted", {}}, broad_phase{"broad-phase pairs", {}}, adversarial{"all families", {}};
  for (int i = 1; i < argc; ++i) {
    const bool has_value = i + 1 < argc;
    if (std::strcmp(argv[i], "--queries") == 0 && has_value) {
      count = std::atoi(argv[++i]);
    } else if (std::strcmp(argv[i], "--trace") == 0 && has_value) {
      if (!read_trace(argv[++i], &broad_phase)) return 2;
    } else {
      Set one{argv[i], {}};
      std::string error;
      if (!demo::read_queries(argv[i], &one.queries, &error)) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return 2;
      }
      append(one, &files);
    }
  }
  if (!files.queries.empty()) report(files);
  if (!broad_phase.queries.empty()) report(broad_phase);
  for (std::size_t i = 0; i < test::families().size() && count > 0; ++i) {
    const Set set = family_set(i, count);
    append(set, &adversarial);
    report(set);
  }
  if (count > 0) report(adversarial);
  return 0;
}
