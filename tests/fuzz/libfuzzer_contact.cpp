// Bytes → a few sheets and particles with any numbers → one interval of contact. It must end, refuse or
// accept; where it accepts a start without pairs closer than δ, no paths intersect and no pair is closer than
// δ at the end, by brute force.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

#include "audit/trace_auditor.h"
#include "contact/predicates.h"
#include "fuzz/fuzz_target.h"
#include "oilskin/trace.h"
#include "support/particle_arrays.h"
#include "support/random.h"

namespace oilskin::fuzz {

namespace {

/// Takes numbers from the front; zeros where the bytes are at their end.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  std::uint8_t byte() { return at_ < size_ ? data_[at_++] : 0; }
  std::uint32_t below(std::uint32_t n) { return byte() % n; }

  /// A double of the kind that the first byte names. Most are from a coarse grid: exact coincidences and near
  /// misses are what contact has to get right.
  double number(double scale) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const std::uint8_t kind = byte();
    switch (kind) {
      case 255:
        return std::numeric_limits<double>::quiet_NaN();
      case 254:
        return infinity;
      case 253:
        return -infinity;
      case 252:
        return std::numeric_limits<double>::denorm_min() * byte();
      case 251:
        return 0.99e15 * signed_byte() / 128;
      case 250:
        return 1e300;
      case 249:
        return -0.0;
      case 248: {
        double any = 0;
        std::uint64_t bits = 0;
        for (int k = 0; k < 8; ++k) bits |= std::uint64_t{byte()} << (8 * k);
        std::memcpy(&any, &bits, sizeof any);
        return any;
      }
      default:
        break;
    }
    if (kind >= 200) return scale * std::ldexp(signed_byte() / 128, -static_cast<int>(below(60)));
    if (kind >= 100) return scale * (signed_byte() / 128 + std::ldexp(signed_byte(), -30));
    return scale * (kind % 17 - 8) / 8;
  }
  Vec3 vector(double scale) {
    const double x = number(scale), y = number(scale), z = number(scale);
    return {x, y, z};
  }
  /// A factor 10^-4 … 10^4, or anything.
  double positive() {
    const std::uint8_t exponent = byte();
    return exponent < 240 ? std::pow(10.0, exponent / 30.0 - 4) : number(1);
  }

 private:
  double signed_byte() { return static_cast<double>(static_cast<std::int8_t>(byte())); }

  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

/// Sheets of one scale, so that they reach the particles.
SurfaceMotion sheet(Input& in, std::uint64_t id, double scale, double still) {
  SurfaceMotion s;
  s.id = id;
  s.storage = in.below(2) ? Storage::float32 : Storage::float64;
  s.nodes_movable = in.below(2) == 0;
  const std::uint32_t nodes = 3 + in.below(6), triangles = 1 + in.below(8);
  const std::uint32_t masses = in.below(4);  // all free, all prescribed, mixed, any
  double largest = 0;
  for (std::uint32_t i = 0; i < nodes; ++i) {
    s.x_t0.push_back(stored(in.vector(scale), s.storage));
    s.x_t1.push_back(stored(s.x_t0.back() + (still < 1 ? in.vector(scale) : Vec3(Vec3::Zero())), s.storage));
    s.velocity.push_back(in.vector(scale));
    s.inverse_mass.push_back(masses == 0                             ? 1000
                             : masses == 1 || (masses == 2 && i % 2) ? 0
                             : masses == 2                           ? 1e-3
                                                                     : in.positive());
    s.holdable.push_back(static_cast<std::uint8_t>(in.below(2)));
    for (const Vec3& x : {s.x_t0.back(), s.x_t1.back()}) largest = std::max(largest, x.cwiseAbs().maxCoeff());
  }
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const std::uint32_t a = in.below(nodes), b = in.below(nodes);
    s.triangles.push_back({a, b, in.below(nodes)});
  }
  s.thickness = scale * in.positive() * 0.1;
  s.delta =
      in.below(4) ? minimum_separation(s.thickness, largest, s.storage) : s.thickness * in.positive() * 0.01;
  s.slip.model = static_cast<SlipModel>(in.below(4));
  return s;
}

struct Problem {
  ContactSettings settings;
  double dt = 1e-3;
  std::vector<SurfaceMotion> sheets;
  std::vector<SurfaceMotion*> surfaces;
  test::ParticleArrays particles;
  ParticleMotion motion;

  Problem(const std::uint8_t* data, std::size_t size) {
    Input in(data, size);
    settings.infeasible = in.below(2) ? Infeasible::remove : Infeasible::stall;
    settings.repulsion = static_cast<Repulsion>(in.below(3));
    settings.ccd_iterations = static_cast<int>(in.below(6));
    dt = in.positive() * 1e-3;
    const double scale = in.positive();
    const std::uint32_t count = 1 + in.below(3), drops = 1 + in.below(8);
    for (std::uint32_t k = 0; k < count; ++k) sheets.push_back(sheet(in, k + 1, scale, in.below(3)));
    for (std::uint32_t k = 0; k < drops; ++k) {
      particles.add(in.vector(scale), in.vector(scale), 1);
      particles.x_t1.back() = particles.x_t0.back() + in.vector(scale);
      particles.inverse_mass.back() = in.below(8) ? 1000 : in.positive();
    }
    for (SurfaceMotion& s : sheets) surfaces.push_back(&s);
    motion = particles.motion(scale * 0.1);
  }

  template <class F>
  void for_each_pair(const F& f) const {
    for (std::size_t p = 0; p < particles.id.size(); ++p)
      for (const SurfaceMotion& s : sheets)
        for (const Triangle& t : s.triangles)
          f(p, s, contact::PointTriangle{particles.x_t0[p], s.x_t0[t[0]], s.x_t0[t[1]], s.x_t0[t[2]]},
            contact::PointTriangle{particles.x_t1[p], s.x_t1[t[0]], s.x_t1[t[1]], s.x_t1[t[2]]});
  }

  /// Numbers that contact refuses; no predicate is made for them.
  bool is_refusable() const {
    const auto bad = [](const std::vector<Vec3>& all) {
      return std::any_of(all.begin(), all.end(),
                         [](const Vec3& x) { return !(x.array().abs() < 1e15).all(); });
    };
    return bad(particles.x_t0) || std::any_of(sheets.begin(), sheets.end(), [&](const SurfaceMotion& s) {
             return bad(s.x_t0) || !(s.delta > 0);
           });
  }
  bool begins_near() const {
    bool too_close = false;
    for_each_pair([&](std::size_t, const SurfaceMotion& s, const contact::PointTriangle& x0,
                      const contact::PointTriangle&) {
      too_close = too_close || contact::end_distance(x0, s.delta).too_close;
    });
    return too_close;
  }
};

void check(const Problem& problem) {
  problem.for_each_pair([&](std::size_t p, const SurfaceMotion& s, const contact::PointTriangle& x0,
                            const contact::PointTriangle& x1) {
    if (problem.particles.removed[p]) return;
    expect(x1.p.allFinite() && x1.a.allFinite() && x1.b.allFinite() && x1.c.allFinite(),
           "positions are finite after contact");
    expect(!contact::end_distance(x1, s.delta).too_close, "no live pair is near at the end");
    expect(!contact::paths_intersect(x0, x1).hit, "no pair meets");
  });
  for (const SurfaceMotion& s : problem.sheets)
    for (const Vec3& x : s.x_t1) expect(x == stored(x, s.storage), "ends are stored numbers");
}

/// By the outside auditor, in exact arithmetic.
void audit(Problem& problem) {
  std::vector<std::uint64_t> id;
  std::vector<Vec3> x_t0, x_t1;
  for (std::size_t p = 0; p < problem.particles.id.size(); ++p) {
    if (problem.particles.removed[p]) continue;
    id.push_back(problem.particles.id[p]);
    x_t0.push_back(problem.particles.x_t0[p]);
    x_t1.push_back(problem.particles.x_t1[p]);
  }
  Interval interval;
  interval.length = problem.dt;
  interval.id = id;
  interval.x_t0 = x_t0;
  interval.x_t1 = x_t1;
  interval.surfaces = problem.surfaces;
  std::stringstream trace;
  TraceWriter(trace).on_interval(interval);
  audit::Limits limits;
  for (const SurfaceMotion& s : problem.sheets) limits.delta_of[s.id] = s.delta;
  audit::Summary summary;
  std::string error;
  expect(audit::audit_stream(trace, limits, &summary, &error), "the auditor reads the trace");
  expect(summary.findings() == 0, "the auditor finds no crossing, no touching and nothing too near");
}

}  // namespace

std::vector<std::vector<std::uint8_t>> seeds() {
  std::vector<std::vector<std::uint8_t>> all;
  test::Random random(3);
  for (int k = 0; k < 40; ++k) {
    std::vector<std::uint8_t> bytes(300 + random.below(300));
    // Bytes below 248 are ordinary numbers.
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random.below(248));
    all.push_back(bytes);
  }
  return all;
}

}  // namespace oilskin::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oilskin;
  if (size > 4096) return 0;
  fuzz::Problem problem(data, size);
  const bool promised = !problem.is_refusable() && !problem.begins_near();
  ContactSolver solver(problem.settings, 1);
  ContactReport report;
  StageSeconds seconds;
  const Status status = solver.resolve(problem.dt, problem.motion, problem.surfaces, report, seconds);
  if (!status.ok() || !promised) return 0;
  fuzz::check(problem);
  fuzz::audit(problem);
  return 0;
}
