// The auditor must find what is wrong with a trace, and nothing else.
#include "audit/trace_auditor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include "audit/pair_filter.h"
#include "support/exact.h"

namespace oilskin::audit {
namespace {

template <class T>
void append(std::string* bytes, const T* data, std::size_t count) {
  bytes->append(reinterpret_cast<const char*>(data), count * sizeof(T));
}

void append(std::string* bytes, std::uint64_t value) {
  append(bytes, &value, 1);
}

/// Written by hand from the description of the format.
std::string to_bytes(const Record& record) {
  std::string bytes = "OILSTEP1";
  append(&bytes, record.number);
  append(&bytes, &record.length, 1);
  append(&bytes, record.ids.size());
  append(&bytes, record.ids.data(), record.ids.size());
  append(&bytes, record.start.data(), record.start.size());
  append(&bytes, record.end.data(), record.end.size());
  append(&bytes, record.surfaces.size());
  for (const Surface& surface : record.surfaces) {
    append(&bytes, surface.id);
    append(&bytes, surface.start.size());
    append(&bytes, surface.triangles.size());
    append(&bytes, surface.start.data(), surface.start.size());
    append(&bytes, surface.end.data(), surface.end.size());
    append(&bytes, surface.triangles.data(), surface.triangles.size());
  }
  return bytes;
}

struct Outcome {
  bool whole;
  Summary summary;
  std::string error;
};

Outcome audit_bytes(const std::string& bytes, const Limits& limits = {}) {
  std::istringstream in(bytes);
  Outcome outcome;
  outcome.whole = audit_stream(in, limits, &outcome.summary, &outcome.error);
  return outcome;
}

Outcome audit_records(const std::vector<Record>& records, const Limits& limits = {}) {
  std::string bytes;
  for (const Record& record : records) bytes += to_bytes(record);
  return audit_bytes(bytes, limits);
}

constexpr double kDelta = 0.001;

double wave(double x, double y, double phase) {
  return 0.02 * std::sin(7 * x + 5 * y + phase);
}

/// A wavy sheet of n × n nodes around z = 0 over the unit square, at a phase of its wave.
std::vector<Point> sheet_nodes(int n, double phase) {
  std::vector<Point> nodes;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const double x = i / (n - 1.0), y = j / (n - 1.0);
      nodes.push_back({x, y, wave(x, y, phase)});
    }
  }
  return nodes;
}

std::vector<std::array<std::uint32_t, 3>> sheet_triangles(std::uint32_t n) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t j = 0; j + 1 < n; ++j) {
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      const std::uint32_t a = j * n + i;
      triangles.push_back({a, a + 1, a + n});
      triangles.push_back({a + 1, a + n + 1, a + n});
    }
  }
  return triangles;
}

/// Particles that ride 5 to 25 mm above the sheet and slide along; `count` intervals that follow each other.
std::vector<Record> clean_trace(int count, int sheet = 12, int particles = 200) {
  std::mt19937_64 engine(1);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<Record> records(count);
  std::vector<Point> nodes = sheet_nodes(sheet, 0), positions;
  const auto above = [&](double x, double y, double phase) {
    return Point{x, y, wave(x, y, phase) + 0.005 + 0.02 * uniform()};
  };
  for (int i = 0; i < particles; ++i) {
    const double x = uniform(), y = uniform();
    positions.push_back(above(x, y, 0));
  }
  for (int r = 0; r < count; ++r) {
    Record& record = records[r];
    record.number = r + 1;
    record.length = 0.001;
    record.start = positions;
    for (int i = 0; i < particles; ++i) record.ids.push_back(1000 - i);
    const double phase = 0.1 * (r + 1);
    for (Point& p : positions) {
      const double x = p[0] + 0.02 * uniform() - 0.01, y = p[1] + 0.01 * uniform();
      p = above(x, y, phase);
    }
    record.end = positions;
    record.surfaces.resize(1);
    record.surfaces[0].id = 5;
    record.surfaces[0].start = nodes;
    nodes = sheet_nodes(sheet, phase);
    record.surfaces[0].end = nodes;
    record.surfaces[0].triangles = sheet_triangles(sheet);
  }
  return records;
}

/// A single triangle at rest under one particle.
Record falling_particle(const Point& from, const Point& to) {
  Record record;
  record.number = 1;
  record.length = 1;
  record.ids = {7};
  record.start = {from};
  record.end = {to};
  record.surfaces.resize(1);
  record.surfaces[0].id = 3;
  record.surfaces[0].start = record.surfaces[0].end = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  record.surfaces[0].triangles = {{0, 1, 2}};
  return record;
}

Limits with_delta(double delta) {
  Limits limits;
  limits.delta = delta;
  return limits;
}

TEST(TraceAuditor, clean_trace_passes) {
  const Outcome outcome = audit_records(clean_trace(6), with_delta(kDelta));
  EXPECT_TRUE(outcome.whole) << outcome.error;
  EXPECT_EQ(outcome.summary.findings(), 0u) << outcome.summary;
  EXPECT_EQ(outcome.summary.records, 6u);
  EXPECT_EQ(outcome.summary.particles, 1200u);
  EXPECT_EQ(outcome.summary.triangles, 6u * 242);
  EXPECT_GT(outcome.summary.pairs, 100u);
}

TEST(TraceAuditor, finds_a_crossing) {
  std::vector<Record> records = clean_trace(3);
  records[1].end[17][2] = records[2].start[17][2] = -0.05;
  records[2].end[17][2] = -0.05;
  const Outcome outcome = audit_records(records);
  EXPECT_TRUE(outcome.whole);
  EXPECT_GE(outcome.summary.crossings, 1u);
  EXPECT_EQ(outcome.summary.jumps, 0u);
  ASSERT_FALSE(outcome.summary.details.empty());
  EXPECT_EQ(outcome.summary.details[0].find("interval 2: particle 983, surface 5"), 0u) << outcome.summary;
}

TEST(TraceAuditor, finds_a_crossing_there_and_back) {
  // The triangle folds over the particle and past it: both ends look harmless from the point's own path.
  Record record = falling_particle({.25, .25, .1}, {.25, .25, .1});
  for (Point& v : record.surfaces[0].end) v[2] = 1;
  const Summary summary = audit_records({record}).summary;
  EXPECT_EQ(summary.crossings, 1u);
  EXPECT_EQ(summary.touchings, 0u);
}

TEST(TraceAuditor, finds_touchings) {
  const auto touch = [](const Point& from, const Point& to) {
    const Summary summary = audit_records({falling_particle(from, to)}).summary;
    EXPECT_EQ(summary.crossings, 0u);
    return summary.touchings;
  };
  EXPECT_EQ(touch({.25, .25, 1}, {.25, .25, 0}), 1u);          // at the end
  EXPECT_EQ(touch({.25, .25, 0}, {.25, .25, 1}), 1u);          // at the start
  EXPECT_EQ(touch({.25, .25, 0}, {.25, .25, 0}), 1u);          // at rest
  EXPECT_EQ(touch({-1, .25, 0}, {1, .25, 0}), 1u);             // in the plane
  EXPECT_EQ(touch({.25, .25, 1}, {.25, .25, 0x1p-1074}), 0u);  // by a hair not
  EXPECT_EQ(touch({2, 2, 1}, {2, 2, -1}), 0u);
}

TEST(TraceAuditor, finds_touching_of_degenerate_triangles) {
  Record record = falling_particle({.5, 0, 1}, {.5, 0, -1});
  record.surfaces[0].triangles = {{0, 1, 1}, {0, 0, 0}};
  EXPECT_EQ(audit_records({record}).summary.touchings, 1u);
}

TEST(TraceAuditor, finds_pairs_that_are_too_close) {
  const auto too_near = [](double height, const Limits& limits) {
    return audit_records({falling_particle({.25, .25, 1}, {.25, .25, height})}, limits).summary.too_near;
  };
  EXPECT_EQ(too_near(kDelta, with_delta(kDelta)), 0u);
  EXPECT_EQ(too_near(kDelta * (1 - 0.9e-12), with_delta(kDelta)), 0u);
  EXPECT_EQ(too_near(kDelta * (1 - 1.1e-12), with_delta(kDelta)), 1u);
  EXPECT_EQ(too_near(0.5 * kDelta, with_delta(kDelta)), 1u);
  EXPECT_EQ(too_near(0.5 * kDelta, {}), 0u);
  Limits named;
  named.delta_of[3] = kDelta;
  EXPECT_EQ(too_near(0.5 * kDelta, named), 1u);
  named.delta_of = {{4, kDelta}};
  EXPECT_EQ(too_near(0.5 * kDelta, named), 0u);
}

TEST(TraceAuditor, finds_jumps) {
  std::vector<Record> records = clean_trace(3);
  records[1].start[3][0] = std::nextafter(records[1].start[3][0], 2);
  records[2].surfaces[0].start[8][1] += 1e-9;
  const Summary summary = audit_records(records).summary;
  EXPECT_EQ(summary.jumps, 2u) << summary;
  EXPECT_EQ(summary.findings(), 2u);
}

TEST(TraceAuditor, new_and_removed_ids_are_no_jumps) {
  std::vector<Record> records = clean_trace(2);
  records[1].ids[0] = 77777;
  records[1].start[0] = {0.5, 0.5, 0.2};
  records[1].end[0] = {0.5, 0.5, 0.19};
  records[1].surfaces[0].id = 6;
  for (Point& v : records[1].surfaces[0].start) v[2] -= 1;
  for (Point& v : records[1].surfaces[0].end) v[2] -= 1;
  EXPECT_EQ(audit_records(records).summary.findings(), 0u);
}

TEST(TraceAuditor, changed_mesh_under_one_id_is_a_jump) {
  std::vector<Record> records = clean_trace(2);
  records[1].surfaces[0].triangles.pop_back();
  EXPECT_EQ(audit_records(records).summary.jumps, 1u);
}

TEST(TraceAuditor, finds_invalid_data) {
  const auto invalid = [](auto change) {
    std::vector<Record> records = clean_trace(1);
    change(&records[0]);
    return audit_records(records).summary.invalid;
  };
  EXPECT_EQ(invalid([](Record* r) { r->ids[1] = r->ids[0]; }), 1u);
  EXPECT_EQ(invalid([](Record* r) { r->end[4][1] = std::nan(""); }), 1u);
  EXPECT_EQ(invalid([](Record* r) { r->surfaces[0].end[4][1] = HUGE_VAL; }), 1u);
  EXPECT_EQ(invalid([](Record* r) { r->surfaces[0].triangles[9][2] = 144; }), 1u);
  EXPECT_EQ(invalid([](Record* r) { r->length = 0; }), 1u);
  EXPECT_EQ(invalid([](Record* r) { r->surfaces.push_back(r->surfaces[0]); }), 1u);
  std::vector<Record> records = clean_trace(2);
  records[1].number = 1;
  EXPECT_EQ(audit_records(records).summary.invalid, 1u);
}

TEST(TraceAuditor, every_truncation_is_malformed) {
  const std::string bytes = to_bytes(clean_trace(1, 3, 4)[0]);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const Outcome outcome = audit_bytes(bytes.substr(0, length));
    EXPECT_FALSE(outcome.whole) << length;
    EXPECT_FALSE(outcome.error.empty());
  }
  EXPECT_TRUE(audit_bytes(bytes).whole);
}

TEST(TraceAuditor, garbage_is_malformed) {
  const std::string bytes = to_bytes(clean_trace(1, 3, 4)[0]);
  EXPECT_FALSE(audit_bytes("OILSTEP2" + bytes.substr(8)).whole);
  const Outcome second = audit_bytes(bytes + "x");
  EXPECT_FALSE(second.whole);
  EXPECT_NE(second.error.find("record 2"), std::string::npos);
  // A count that is not true must not ask for memory that is not there.
  std::string huge = bytes;
  const std::uint64_t count = std::uint64_t{1} << 60;
  huge.replace(24, 8, reinterpret_cast<const char*>(&count), 8);
  EXPECT_FALSE(audit_bytes(huge).whole);
}

/// The search and the filter lose nothing: all pairs, each decided exactly, give the same counts.
TEST(TraceAuditor, agrees_with_all_pairs_decided_exactly) {
  std::mt19937_64 engine(3);
  const auto coordinate = [&] { return static_cast<double>(static_cast<int>(engine() % 17)) / 16 - 0.5; };
  const auto point = [&] { return Point{coordinate(), coordinate(), coordinate()}; };
  for (int round = 0; round < 6; ++round) {
    Record record;
    record.number = 1;
    record.length = 1;
    for (int i = 0; i < 40; ++i) {
      record.ids.push_back(i);
      record.start.push_back(point());
      record.end.push_back(i % 3 == 0 ? record.start.back() : point());
    }
    Surface surface;
    for (int i = 0; i < 12; ++i) {
      surface.start.push_back(point());
      surface.end.push_back(point());
    }
    for (int i = 0; i < 40; ++i) {
      const auto index = [&] { return static_cast<std::uint32_t>(engine() % 12); };
      surface.triangles.push_back({index(), index(), index()});
    }
    record.surfaces.push_back(surface);
    std::uint64_t crossings = 0, touchings = 0, near = 0;
    const double delta = 0.05;
    for (std::size_t p = 0; p < record.ids.size(); ++p) {
      for (const auto& t : surface.triangles) {
        const std::array<Point, 4> start{record.start[p], surface.start[t[0]], surface.start[t[1]],
                                         surface.start[t[2]]};
        const std::array<Point, 4> end{record.end[p], surface.end[t[0]], surface.end[t[1]],
                                       surface.end[t[2]]};
        const exact::Answer answer = exact::point_triangle({start, end});
        crossings += answer.hit && answer.crosses ? 1 : 0;
        touchings += answer.hit && !answer.crosses ? 1 : 0;
        near += exact::nearer_than(end[0], end[1], end[2], end[3], delta * (1 - 1e-12)) ? 1 : 0;
      }
    }
    const Summary summary = audit_records({record}, with_delta(delta)).summary;
    EXPECT_EQ(summary.crossings, crossings);
    EXPECT_EQ(summary.touchings, touchings);
    EXPECT_EQ(summary.too_near, near);
    EXPECT_GT(crossings, 0u);
  }
}

}  // namespace
}  // namespace oilskin::audit
