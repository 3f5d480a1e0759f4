#include "fluid/emission/emission.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/refuse.h"
#include "fluid/emission/nozzle.h"
#include "fluid/emission/random.h"
#include "fluid/emission/source.h"
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

/// Largest number of particles of a volume: a run of as many needs about 60 GB.
constexpr double max_points = 5e7;

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

}  // namespace

struct Emission::Impl {
  struct Origin {
    std::uint32_t source, site;
  };

  double spacing, rest_density, particle_mass;
  /// The state of a source.
  struct Progress {
    bool begun = false;
    std::uint64_t next = 0;
    std::vector<std::uint8_t> waiting;
  };

  std::vector<Source> sources;
  std::vector<Progress> saved;  // by checkpoint(), one per source
  std::vector<Start> starts;
  std::vector<Origin> origins;

  void emit(std::size_t source, std::size_t site, const Vec3& position, double remaining) {
    starts.push_back({position, sources[source].velocity_of(site), remaining});
    origins.push_back({static_cast<std::uint32_t>(source), static_cast<std::uint32_t>(site)});
  }
  void emit_waiting(std::size_t source, double dt);
  void emit_series(std::size_t source, double time, double dt);
  void emit_volume(std::size_t source, double time, double dt);
};

Emission::Emission(double spacing, double rest_density, double particle_mass)
    : impl_(std::make_unique<Impl>()) {
  OILSKIN_ASSERT(spacing > 0 && rest_density > 0 && particle_mass > 0);
  impl_->spacing = spacing;
  impl_->rest_density = rest_density;
  impl_->particle_mass = particle_mass;
}

Emission::~Emission() = default;

Status Emission::add(const DiscEmitter& e) {
  const double dx = impl_->spacing;
  Status s = first_of({check_vector("disc emitter: center", e.center),
                       check_vector("disc emitter: direction", e.direction),
                       check_positive("disc emitter: radius", e.radius, "a finite length > 0 m"),
                       check_positive("disc emitter: speed", e.speed, "finite and > 0 m/s"),
                       check_times("disc emitter: start", e.start, "disc emitter: stop", e.stop),
                       check_shake("disc emitter: shake", e.shake)});
  if (!s.ok()) return s;
  if (!(e.direction.stableNorm() > 0))
    return refuse_value("disc emitter: direction", e.direction.transpose(), "longer than 0");
  if (!(e.radius >= 0.5 * dx && e.radius <= 1e4 * dx))
    return refuse_value("disc emitter: radius", e.radius, "half a spacing to 10000 spacings of the fluid");
  Source source;
  source.kind = Source::Kind::nozzle;
  source.set_velocity(e.speed * e.direction.stableNormalized());
  source.shake = e.shake * dx;
  source.seed = e.seed;
  source.start = e.start;
  source.stop = e.stop;
  // A layer of `needed` sites per spacing has the mass flow ρ0 π r² v. With more of them layers are farther
  // apart; with fewer they would be nearer than a spacing, and the jet would burst (F.37), (F.64).
  const double area = impl_->rest_density * pi * e.radius * e.radius, mass = impl_->particle_mass;
  source.sites = nozzle_sites(e, area * dx / mass * (1 - 1e-9), dx);
  const double layer = static_cast<double>(source.sites.size()) * mass / area;
  source.period = layer / e.speed;
  if (!(source.period >= min_period))
    return refuse_value("disc emitter: speed", e.speed, "at most 1e9 layers per second");
  source.waiting.assign(source.sites.size(), 0);
  impl_->sources.push_back(std::move(source));
  return {};
}

Status Emission::add(const BoxEmitter& e) {
  Status s = first_of({check_vector("box emitter: box.min", e.box.min),
                       check_vector("box emitter: box.max", e.box.max),
                       check_vector("box emitter: velocity", e.velocity)});
  if (!s.ok()) return s;
  if (!std::isfinite(e.start)) return refuse_value("box emitter: start", e.start, "a finite time");
  const Eigen::Array3d cells = ((e.box.max - e.box.min).array() / impl_->spacing + 1e-6).floor();
  if (!(cells >= 1).all()) {
    return refuse_value("box emitter: size", (e.box.max - e.box.min).transpose(),
                        "at least one spacing of the fluid on every axis; it has no emission site");
  }
  if (cells.prod() > max_points)
    return refuse_value("box emitter: number of particles", cells.prod(), "at most 5e7");
  Source source;
  source.sites = box_sites(e.box, cells, impl_->spacing);
  source.start = e.start;
  s = place("box emitter", e.velocity, e.initial, impl_->spacing, source);
  if (s.ok()) impl_->sources.push_back(std::move(source));
  return s;
}

Status Emission::add(const MeshEmitter& e) {
  Status s = check_vector("mesh emitter: velocity", e.velocity);
  if (!s.ok()) return s;
  if (!std::isfinite(e.start)) return refuse_value("mesh emitter: start", e.start, "a finite time");
  Source source;
  s = lattice_inside(e, impl_->spacing, &source.sites);
  if (!s.ok()) return s;
  if (source.sites.empty()) {
    return Status::refused(
        "mesh emitter: it has no emission site: no point of the lattice lies inside; use a larger mesh or a "
        "smaller "
        "spacing");
  }
  source.start = e.start;
  s = place("mesh emitter", e.velocity, e.initial, impl_->spacing, source);
  if (s.ok()) impl_->sources.push_back(std::move(source));
  return s;
}

Status Emission::add(const RainEmitter& e) {
  Status s = first_of(
      {check_vector("rain emitter: corner", e.corner), check_vector("rain emitter: edge_u", e.edge_u),
       check_vector("rain emitter: edge_v", e.edge_v), check_vector("rain emitter: velocity", e.velocity),
       check_positive("rain emitter: drops_per_second", e.drops_per_second, "finite and > 0 1/s"),
       check_times("rain emitter: start", e.start, "rain emitter: stop", e.stop)});
  if (!s.ok()) return s;
  if (!(std::isfinite(e.drop_radius) && e.drop_radius >= 0 && e.drop_radius <= 500 * impl_->spacing))
    return refuse_value("rain emitter: drop_radius", e.drop_radius, "0 … 500 spacings of the fluid");
  Source source;
  source.kind = Source::Kind::rain;
  source.sites = ball_sites(e.drop_radius, impl_->spacing);
  source.set_velocity(e.velocity);
  source.start = e.start;
  source.stop = e.stop;
  source.period = 1 / e.drops_per_second;
  if (!(source.period >= min_period))
    return refuse_value("rain emitter: drops_per_second", e.drops_per_second, "at most 1e9 1/s");
  source.rain = e;
  impl_->sources.push_back(std::move(source));
  return {};
}

const std::vector<Start>& Emission::due(double time, double dt) {
  OILSKIN_ASSERT(dt > 0);
  impl_->starts.clear();
  impl_->origins.clear();
  for (std::size_t s = 0; s < impl_->sources.size(); ++s) impl_->emit_waiting(s, dt);
  for (std::size_t s = 0; s < impl_->sources.size(); ++s) {
    if (impl_->sources[s].kind == Source::Kind::volume)
      impl_->emit_volume(s, time, dt);
    else
      impl_->emit_series(s, time, dt);
  }
  return impl_->starts;
}

double Emission::fastest_due(double time, double dt) const {
  double fastest = 0;
  for (const Source& s : impl_->sources) {
    const bool over = s.kind == Source::Kind::volume ? s.begun : time >= s.stop;
    const bool waits = std::find(s.waiting.begin(), s.waiting.end(), 1) != s.waiting.end();
    if (waits || (!over && s.start < time + dt)) fastest = std::max(fastest, s.fastest);
  }
  return fastest;
}

void Emission::Impl::emit_waiting(std::size_t source, double dt) {
  const std::vector<std::uint8_t>& waiting = sources[source].waiting;
  OILSKIN_ASSERT(waiting.empty() || waiting.size() == sources[source].sites.size());
  for (std::size_t k = 0; k < waiting.size(); ++k)
    if (waiting[k]) emit(source, k, sources[source].place_of(k), dt);
}

void Emission::Impl::emit_series(std::size_t index, double time, double dt) {
  Source& s = sources[index];
  OILSKIN_ASSERT(s.period >= min_period);
  if (!s.begun) {  // starts before the first call are not emitted later
    s.begun = true;
    if (time > s.start) s.next = static_cast<std::uint64_t>((time - s.start) / s.period);
    while (s.time_of(s.next) < time) ++s.next;
  }
  for (double t = s.time_of(s.next); t < time + dt && t < s.stop; t = s.time_of(++s.next)) {
    const double remaining = std::min(dt, time + dt - t);
    // A start that waited leaves at `time`. One of the same site within half a period after it would overlap
    // it.
    const bool behind = t - time < 0.5 * s.period;
    for (std::size_t k = 0; k < s.sites.size(); ++k)
      if (!(behind && !s.waiting.empty() && s.waiting[k])) emit(index, k, s.place_of(k), remaining);
  }
  std::fill(s.waiting.begin(), s.waiting.end(), std::uint8_t{0});
}

void Emission::Impl::emit_volume(std::size_t index, double time, double dt) {
  Source& s = sources[index];
  if (s.begun || s.start >= time + dt) return;
  s.begun = true;
  const double remaining = std::min(dt, time + dt - s.start);
  for (std::size_t k = 0; k < s.sites.size(); ++k) emit(index, k, s.sites[k], remaining);
}

std::uint64_t Emission::settle(Span<const std::uint8_t> blocked) {
  OILSKIN_ASSERT(blocked.size() == impl_->starts.size());
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < blocked.size(); ++i) {
    if (!blocked[i]) continue;
    ++count;
    Source& s = impl_->sources[impl_->origins[i].source];
    if (s.kind == Source::Kind::nozzle) s.waiting[impl_->origins[i].site] = 1;
  }
  return count;
}

void Emission::checkpoint() {
  impl_->saved.resize(impl_->sources.size());
  for (std::size_t k = 0; k < impl_->saved.size(); ++k) {
    const Source& s = impl_->sources[k];
    impl_->saved[k].begun = s.begun;
    impl_->saved[k].next = s.next;
    impl_->saved[k].waiting = s.waiting;
  }
}

void Emission::roll_back() noexcept {
  for (std::size_t k = 0; k < impl_->saved.size(); ++k) {
    Source& s = impl_->sources[k];
    s.begun = impl_->saved[k].begun;
    s.next = impl_->saved[k].next;
    s.waiting.swap(impl_->saved[k].waiting);
  }
}

void Emission::commit() noexcept {
  for (Source& s : impl_->sources)
    if (s.kind == Source::Kind::volume && s.begun) {
      std::vector<Vec3>().swap(s.sites);
      std::vector<Vec3>().swap(s.velocities);
    }
}

void Emission::visit(Archive& archive, double time) {
  constexpr std::size_t min_bytes = 200;  // of a source without sites
  archive.list(impl_->sources, min_bytes, [&](Source& s) {
    fluid::visit(archive, s);
    archive.require(is_in_range(s, time), "an emitter");
  });
}

}  // namespace oilskin::fluid
