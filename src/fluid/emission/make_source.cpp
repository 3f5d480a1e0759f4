#include "fluid/emission/make_source.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/refuse.h"
#include "fluid/emission/emission.h"
#include "fluid/emission/nozzle.h"
#include "fluid/kernels.h"

namespace oilskin::fluid {

namespace {

Status check_vector(const char* field, const Vec3& v) {
  return v.allFinite() ? Status{} : refuse_value(field, v.transpose(), "finite");
}

Status check_positive(const char* field, double x, const char* range) {
  return std::isfinite(x) && x > 0 ? Status{} : refuse_value(field, x, range);
}

Status check_times(const char* start_field, double start, const char* stop_field, double stop) {
  if (!std::isfinite(start) || start < 0) return refuse_value(start_field, start, "a finite time >= 0");
  if (!(stop > start)) return refuse_value(stop_field, stop, "a time after start");
  return {};
}

/// The first status that is not ok, or ok.
Status first_of(std::initializer_list<Status> all) {
  for (const Status& s : all)
    if (!s.ok()) return s;
  return {};
}

/// Largest radius of a drop of rain [spacings]: 33 million particles.
constexpr double max_drop = 200;

/// Largest radius of a nozzle [spacings]: 3 million particles in a layer.
constexpr double max_nozzle = 1e3;

std::vector<Vec3> ball_sites(double radius, double spacing) {
  const double limit = radius / spacing * (1 + 1e-9);
  const int n = static_cast<int>(limit);
  std::vector<Vec3> sites;
  for (int a = -n; a <= n; ++a)
    for (int b = -n; b <= n; ++b)
      for (int c = -n; c <= n; ++c)
        if (a * a + b * b + c * c <= limit * limit) sites.push_back(spacing * Vec3(a, b, c));
  return sites;
}

/// One point per cell of one spacing, centred in the box.
std::vector<Vec3> box_sites(const Box& box, const Eigen::Array3d& cells, double spacing) {
  const Vec3 center = 0.5 * (box.min + box.max);
  const Vec3 first = center - 0.5 * spacing * (cells.matrix() - Vec3::Ones());
  std::vector<Vec3> sites;
  sites.reserve(static_cast<std::size_t>(cells.prod()));
  for (int c = 0; c < cells[2]; ++c)
    for (int b = 0; b < cells[1]; ++b)
      for (int a = 0; a < cells[0]; ++a) sites.push_back(first + spacing * Vec3(a, b, c));
  return sites;
}

constexpr double infinity = std::numeric_limits<double>::infinity();

Vec3 center_of(const MeshEmitter& e) {
  Box box;
  for (const Vec3& x : e.vertices) box.add(x);
  return 0.5 * (box.min + box.max);
}

}  // namespace

Status check_speed(const char* field, double speed) {
  return within(speed, 0, std::numeric_limits<double>::max())
             ? Status()
             : refuse_value(field, speed, "finite and ≥ 0 m/s");
}

Status check_nozzle_speed(const char* field, double speed, double layer) {
  const bool fits = speed == 0 || within(layer / speed, min_period, std::numeric_limits<double>::max());
  return fits ? Status() : refuse_value(field, speed, "0, or at most 1e9 layers per second");
}

Status check_drop_rate(const char* field, double rate) {
  if (Status s = check_positive(field, rate, "finite and > 0 1/s"); !s.ok()) return s;
  return 1 / rate >= min_period ? Status() : refuse_value(field, rate, "at most 1e9 1/s");
}

Status make_source(const DiscEmitter& e, const SourceMaterial& material, Source& source) {
  const double dx = material.spacing;
  Status s = first_of({check_vector("disc emitter: center", e.center),
                       check_vector("disc emitter: direction", e.direction),
                       check_positive("disc emitter: radius", e.radius, "a finite length > 0 m"),
                       check_speed("disc emitter: speed", e.speed),
                       check_times("disc emitter: start", e.start, "disc emitter: stop", e.stop),
                       check_shake("disc emitter: shake", e.shake)});
  if (!s.ok()) return s;
  if (!(e.direction.stableNorm() > 0))
    return refuse_value("disc emitter: direction", e.direction.transpose(), "longer than 0");
  if (!(e.radius >= 0.5 * dx && e.radius <= max_nozzle * dx))
    return refuse_value("disc emitter: radius", e.radius, "half a spacing to 1000 spacings of the fluid");
  source.kind = Source::Kind::nozzle;
  source.center = e.center;
  source.direction = e.direction.stableNormalized();
  source.velocity = e.speed * source.direction;
  source.fastest = source.velocity.norm();
  source.shake = e.shake * dx;
  source.seed = e.seed;
  source.schedule.begin_at(e.start, e.stop);
  // A layer of `needed` sites per spacing has the mass flow ρ0 π r² v. With more of them layers are farther
  // apart; with fewer they would be nearer than a spacing, and the jet would burst (F.37), (F.64).
  const double area = material.rest_density * pi * e.radius * e.radius, mass = material.particle_mass;
  source.sites = nozzle_sites(e, area * dx / mass * (1 - 1e-9), dx);
  source.layer = static_cast<double>(source.sites.size()) * mass / area;
  s = check_nozzle_speed("disc emitter: speed", e.speed, source.layer);
  if (!s.ok()) return s;
  source.schedule.period = e.speed > 0 ? source.layer / e.speed : 1;
  source.update_running();
  source.waiting.assign(source.sites.size(), 0);
  return {};
}

/// By how much single precision may round a side of the box, in spacings: four units in the last place of a
/// coordinate. A side of n spacings has n layers wherever the box is.
static double rounding_of(const Box& box, double spacing) {
  const double farthest = box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs()).maxCoeff();
  const double unit = static_cast<double>(std::numeric_limits<float>::epsilon());
  return std::min(1e-6 + 4 * unit * farthest / spacing, 0.02);
}

Status make_source(const BoxEmitter& e, const SourceMaterial& material, Source& source) {
  Status s = first_of({check_vector("box emitter: box.min", e.box.min),
                       check_vector("box emitter: box.max", e.box.max),
                       check_vector("box emitter: velocity", e.velocity)});
  if (!s.ok()) return s;
  if (!std::isfinite(e.start)) return refuse_value("box emitter: start", e.start, "a finite time");
  const Eigen::Array3d cells =
      ((e.box.max - e.box.min).array() / material.spacing + rounding_of(e.box, material.spacing)).floor();
  if (!(e.box.min.array() <= e.box.max.array()).all())
    return refuse_value("box emitter: box.max", e.box.max.transpose(), "at least box.min on every axis");
  if (!(cells >= 1).all()) {
    return refuse_value("box emitter: size", (e.box.max - e.box.min).transpose(),
                        "at least one spacing of the fluid on every axis; no particle fits in");
  }
  if (cells.prod() > most_points)
    return refuse_value("box emitter: number of particles", cells.prod(), "at most 5e7");
  source.center = 0.5 * (e.box.min + e.box.max);
  source.sites = box_sites(e.box, cells, material.spacing);
  source.schedule.begin_at(e.start, infinity);
  return place("box emitter", e.velocity, e.initial, material.spacing, source);
}

Status make_source(const MeshEmitter& e, const SourceMaterial& material, Source& source) {
  Status s = check_vector("mesh emitter: velocity", e.velocity);
  if (!s.ok()) return s;
  if (!std::isfinite(e.start)) return refuse_value("mesh emitter: start", e.start, "a finite time");
  s = lattice_inside(e, material.spacing, &source.sites);
  if (!s.ok()) return s;
  if (source.sites.empty()) {
    return Status::refused(
        "mesh emitter: no point of the lattice of particles lies inside; use a larger mesh or a smaller "
        "spacing");
  }
  source.schedule.begin_at(e.start, infinity);
  source.center = center_of(e);
  return place("mesh emitter", e.velocity, e.initial, material.spacing, source);
}

Status make_source(const RainEmitter& e, const SourceMaterial& material, Source& source) {
  Status s = first_of(
      {check_vector("rain emitter: corner", e.corner), check_vector("rain emitter: edge_u", e.edge_u),
       check_vector("rain emitter: edge_v", e.edge_v), check_vector("rain emitter: velocity", e.velocity),
       check_drop_rate("rain emitter: drops_per_second", e.drops_per_second),
       check_times("rain emitter: start", e.start, "rain emitter: stop", e.stop)});
  if (!s.ok()) return s;
  if (!(std::isfinite(e.drop_radius) && e.drop_radius >= 0 && e.drop_radius <= max_drop * material.spacing))
    return refuse_value("rain emitter: drop_radius", e.drop_radius, "0 … 200 spacings of the fluid");
  source.kind = Source::Kind::rain;
  source.sites = ball_sites(e.drop_radius, material.spacing);
  source.set_velocity(e.velocity);
  source.schedule.begin_at(e.start, e.stop);
  source.schedule.period = 1 / e.drops_per_second;
  source.center = e.corner + 0.5 * (e.edge_u + e.edge_v);
  source.rain = e;
  return {};
}

}  // namespace oilskin::fluid
