#include "oilskin/wetting.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "core/archive.h"
#include "core/assert.h"
#include "core/refuse.h"
#include "effects/wetting/wetted_cloth.h"

namespace oilskin {

namespace {

/// Particles within this distance of a surface touch it [dx]: the first layer, at half a spacing.
constexpr double touching = 0.9;

/// A particle with less than this part of a new one's mass is taken up as a whole.
constexpr double least_ratio = 0.05;

/// The numbers of each node.
enum Channel : std::size_t { gathered_channel, known_channel, rest_channel };

/// A particle at a wall.
struct Touching {
  std::uint32_t particle = 0;
  VisibleWall wall;
};

void visit(Archive& archive, Fabric& fabric) {
  auto& [capacity, diffusivity, mobility_exponent, capillary_rise, anisotropy, warp, saturation_limit] =
      fabric;
  archive.values(capacity, diffusivity, mobility_exponent, capillary_rise, anisotropy, warp,
                 saturation_limit);
}

void visit(Archive& archive, WettingSettings& settings) {
  auto& [fabric, absorption, dripping, drying, transport_interval] = settings;
  visit(archive, fabric);
  archive.values(absorption, dripping, drying, transport_interval);
}

bool has_free_node(const SurfaceMotion& motion) {
  return std::any_of(motion.inverse_mass.begin(), motion.inverse_mass.end(), [](double m) { return m > 0; });
}

/// That in which the mesh was seen first.
std::vector<Vec3> rest_shape(EffectExchange& e, std::size_t surface) {
  const SurfaceMotion& motion = *e.surfaces[surface];
  const std::size_t n = motion.x_t0.size();
  const Span<double> known = e.of_nodes(surface, known_channel);
  std::array<Span<double>, 3> rest;
  for (std::size_t c = 0; c < 3; ++c) rest[c] = e.of_nodes(surface, rest_channel + c);
  std::vector<Vec3> x(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (known[i] == 0)
      for (std::size_t c = 0; c < 3; ++c) rest[c][i] = motion.x_t0[i][static_cast<Eigen::Index>(c)];
    known[i] = 1;
    x[i] = Vec3(rest[0][i], rest[1][i], rest[2][i]);
  }
  return x;
}

}  // namespace

Status WettingSettings::validate() const {
  if (Status s = fabric.validate(); !s.ok()) return s;
  if (!within(absorption, 0, 1e6)) return refuse_value("absorption", absorption, "0 … 1e6 kg/(m² s)");
  if (!within(dripping, 0, 1e6)) return refuse_value("dripping", dripping, "0 … 1e6 1/s");
  if (!within(drying, 0, 1e6)) return refuse_value("drying", drying, "0 … 1e6 1/s");
  if (!within(transport_interval, 0, 1))
    return refuse_value("transport_interval", transport_interval, "0 … 1 s");
  return {};
}

struct Wetting::Impl {
  Status status;
  WettingSettings settings;
  std::map<std::uint64_t, std::optional<Fabric>> fabrics;  // of surfaces with their own; none: waterproof
  double pending = 0;                                      // time for which liquid has not spread yet [s]
  double gathering = 0;        // time for which drops have not gathered yet, 0 between steps [s]
  double pending_at_step = 0;  // by checkpoint()

  // Derived from the surfaces of the last interval
  std::map<std::uint64_t, std::shared_ptr<WettedCloth>> cloths;
  std::set<std::uint64_t> with_new_fabric;  // since then
  std::vector<Touching> touching_particles;

  const Fabric* fabric_of(SurfaceId id, const SurfaceMotion& motion) const;
  bool absorbs(const EffectInterval& interval, std::size_t surface) const {
    return fabric_of(interval.surface_id[surface], *interval.surfaces[surface]) != nullptr;
  }
  void find_cloths(EffectExchange& e);
  WettedCloth* cloth_of(const EffectExchange& e, std::size_t surface) const;
  void absorb(EffectExchange& e) const;
  std::vector<double> covered_area(const EffectExchange& e, std::size_t surface) const;
  void spread(EffectExchange& e);
  void drip(EffectExchange& e);
  void visit(Archive& archive);
};

const Fabric* Wetting::Impl::fabric_of(SurfaceId id, const SurfaceMotion& motion) const {
  const auto own = fabrics.find(id.value);
  if (own != fabrics.end()) return own->second ? &*own->second : nullptr;
  return has_free_node(motion) ? &settings.fabric : nullptr;
}

/// If this throws, the cloths are those of the interval before.
void Wetting::Impl::find_cloths(EffectExchange& e) {
  std::map<std::uint64_t, std::shared_ptr<WettedCloth>> found;
  for (std::size_t s = 0; s < e.surfaces.size(); ++s) {
    const std::uint64_t id = e.surface_id[s].value;
    const Fabric* fabric = fabric_of(e.surface_id[s], *e.surfaces[s]);
    if (fabric == nullptr) continue;
    std::vector<Vec3> rest = rest_shape(e, s);
    std::shared_ptr<WettedCloth>& cloth = found[id];
    const auto known = cloths.find(id);
    if (known != cloths.end() && with_new_fabric.count(id) == 0) cloth = known->second;
    if (!cloth || !cloth->is_for(*e.surfaces[s], rest))
      cloth = std::make_shared<WettedCloth>(*e.surfaces[s], std::move(rest), *fabric);
  }
  cloths.swap(found);
  with_new_fabric.clear();
}

WettedCloth* Wetting::Impl::cloth_of(const EffectExchange& e, std::size_t surface) const {
  const auto cloth = cloths.find(e.surface_id[surface].value);
  return cloth == cloths.end() ? nullptr : cloth->second.get();
}

/// In the order of the particles: who comes first fills the last place.
void Wetting::Impl::absorb(EffectExchange& e) const {
  const double area = e.spacing * e.spacing;
  for (const Touching& t : touching_particles) {
    const WettedCloth* cloth = cloth_of(e, t.wall.surface);
    if (cloth == nullptr) continue;
    const std::array<double, 3> given =
        cloth->uptake(*e.surfaces[t.wall.surface], t.wall, e.dt, settings.absorption, area,
                      e.mass(t.particle), least_ratio * e.particle_mass);
    e.absorb(t.particle, t.wall.surface, t.wall.nodes, given);
  }
}

/// Per node, by particles that touch [m²].
std::vector<double> Wetting::Impl::covered_area(const EffectExchange& e, std::size_t surface) const {
  std::vector<double> covered(e.surfaces[surface]->x_t1.size(), 0);
  for (const Touching& t : touching_particles) {
    if (t.wall.surface != surface) continue;
    for (std::size_t k = 0; k < 3; ++k) covered[t.wall.nodes[k]] += e.spacing * e.spacing * t.wall.weights[k];
  }
  return covered;
}

void Wetting::Impl::spread(EffectExchange& e) {
  pending += e.dt;
  if (pending < settings.transport_interval) return;
  gathering += pending;
  for (std::size_t s = 0; s < e.surfaces.size(); ++s) {
    WettedCloth* cloth = cloth_of(e, s);
    if (cloth == nullptr || e.surfaces[s]->absorbed_mass.empty()) continue;
    cloth->spread(pending, s, e);
    if (settings.drying > 0) cloth->dry(pending, settings.drying, covered_area(e, s), s, e);
  }
  pending = 0;
}

/// Once in a step: drops leave at its end, and what one has asked for must not be asked for again.
void Wetting::Impl::drip(EffectExchange& e) {
  if (!e.is_last || !(gathering > 0)) return;
  for (std::size_t s = 0; s < e.surfaces.size(); ++s) {
    const WettedCloth* cloth = cloth_of(e, s);
    if (cloth == nullptr || e.surfaces[s]->absorbed_mass.empty()) continue;
    cloth->drip(gathering, settings.dripping, s, e.of_nodes(s, gathered_channel), e);
  }
  gathering = 0;
}

void Wetting::Impl::visit(Archive& archive) {
  oilskin::visit(archive, settings);
  archive.value(pending);
  std::vector<std::pair<std::uint64_t, std::optional<Fabric>>> own(fabrics.begin(), fabrics.end());
  archive.list(own, sizeof(std::uint64_t) + 1, [&](auto& one) {
    archive.value(one.first);
    archive.optional(one.second, [&](Fabric& fabric) {
      oilskin::visit(archive, fabric);
      archive.require(fabric.validate().ok(), "a fabric");
    });
  });
  if (!archive.reading()) return;
  archive.require(settings.validate().ok() && pending >= 0 && pending <= 1e9, "the settings of wetting");
  fabrics = {own.begin(), own.end()};
}

Wetting::Wetting(const WettingSettings& settings) : impl_(std::make_unique<Impl>()) {
  impl_->status = settings.validate();
  if (impl_->status.ok()) impl_->settings = settings;
}

Wetting::~Wetting() = default;

Status Wetting::status() const {
  return impl_->status;
}

const WettingSettings& Wetting::settings() const {
  return impl_->settings;
}

Status Wetting::set_fabric(SurfaceId id, const Fabric& fabric) {
  if (Status s = fabric.validate(); !s.ok()) return s;
  impl_->with_new_fabric.insert(id.value);
  impl_->fabrics[id.value] = fabric;
  return {};
}

void Wetting::set_waterproof(SurfaceId id) {
  impl_->with_new_fabric.insert(id.value);
  impl_->fabrics[id.value].reset();
}

Span<const double> Wetting::capacity(SurfaceId id) const {
  const auto cloth = impl_->cloths.find(id.value);
  return cloth == impl_->cloths.end() ? Span<const double>() : Span<const double>(cloth->second->capacity());
}

std::vector<double> Wetting::node_values() const {
  return {0, 0, 0, 0, 0};
}

/// Where particles are before they move: the nearest surface that each sees.
void Wetting::act(EffectForces& f) {
  std::vector<Touching>& found = impl_->touching_particles;
  found.clear();
  if (!impl_->status.ok()) return;
  for (std::uint32_t i = 0; i < f.id.size(); ++i) {
    const Span<const VisibleWall> walls = f.walls(i);
    const VisibleWall* nearest =
        std::min_element(walls.begin(), walls.end(),
                         [](const VisibleWall& a, const VisibleWall& b) { return a.distance < b.distance; });
    if (nearest == walls.end() || nearest->distance > touching * f.spacing) continue;
    if (impl_->absorbs(f, nearest->surface)) found.push_back({i, *nearest});
  }
}

void Wetting::exchange(EffectExchange& e) {
  if (!impl_->status.ok()) return;
  impl_->find_cloths(e);
  impl_->absorb(e);
  impl_->spread(e);
  impl_->drip(e);
}

void Wetting::checkpoint() {
  impl_->pending_at_step = impl_->pending;
}

void Wetting::roll_back() noexcept {
  impl_->pending = impl_->pending_at_step;
  impl_->gathering = 0;
}

std::vector<std::uint8_t> Wetting::save() const {
  std::vector<std::uint8_t> saved;
  Archive archive(saved);
  impl_->visit(archive);
  return saved;
}

Status Wetting::restore(Span<const std::uint8_t> saved) {
  Impl read;
  Archive archive(saved);
  read.visit(archive);
  archive.require(archive.left() == 0, "the length");
  if (!archive.ok()) return archive.status();
  impl_->settings = read.settings;
  impl_->fabrics = read.fabrics;
  impl_->pending = read.pending;
  impl_->gathering = 0;
  impl_->cloths.clear();
  impl_->with_new_fabric.clear();
  return {};
}

}  // namespace oilskin
