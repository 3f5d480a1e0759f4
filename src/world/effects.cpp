#include "world/effects.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/body_motion.h"
#include "world/absorption.h"
#include "world/numeric_range.h"

namespace oilskin::world {

namespace {

constexpr std::size_t chunk = 256;

/// A particle with less than this part of a new one's mass is the rounding of what it gave: it ends.
constexpr float least_ratio = 0x1p-24f;

/// What both stages share. Base is EffectForces or EffectExchange.
template <class Base>
class View : public Base {
 public:
  View(const Effects::Slot& slot, const EffectInput& input) : slot_(slot), input_(input) {
    const IntervalContext& interval = input.interval;
    this->dt = interval.dt;
    this->time = interval.begin;
    this->is_first = interval.is_first;
    this->is_last = interval.is_last;
    this->gravity = input.gravity;
    this->particle_mass = input.fluid.particle_mass();
    this->mass_ratio = input.particles.mass_ratio;
    this->spacing = input.settings.spacing;
    this->support_radius = input.fluid.support_radius();
    this->rest_density = input.settings.rest_density;
    this->id = input.particles.id;
    this->density = input.particles.density;
    this->surfaces = interval.step.surfaces.motion;
    for (const Attachment* a : interval.step.surfaces.attachment) ids_.push_back({a->handle});
    this->surface_id = ids_;
  }
  Span<double> of_particles(std::size_t channel) override {
    OILSKIN_ASSERT(channel < slot_.particle_start.size());
    return input_.particles.values[slot_.first_particle_value + channel];
  }
  Span<double> of_nodes(std::size_t surface, std::size_t channel) override {
    OILSKIN_ASSERT(surface < this->surfaces.size() && channel < slot_.node_start.size());
    return input_.interval.step.surfaces.attachment[surface]->values[slot_.first_node_value + channel];
  }
  void for_each(std::size_t count, const std::function<void(std::size_t)>& f) const override {
    input_.workers.for_each(count, chunk, f);
  }

 protected:
  bool has_node(std::size_t surface, std::uint32_t node) const {
    return surface < this->surfaces.size() && node < this->surfaces[surface]->x_t1.size();
  }
  bool has_nodes(std::size_t surface, const std::array<std::uint32_t, 3>& nodes) const {
    return has_node(surface, nodes[0]) && has_node(surface, nodes[1]) && has_node(surface, nodes[2]);
  }

  const Effects::Slot& slot_;
  const EffectInput& input_;

 private:
  std::vector<SurfaceId> ids_;
};

bool is_mass(double mass) {
  return std::isfinite(mass) && mass > 0;
}

class Forces : public View<EffectForces> {
 public:
  Forces(const Effects::Slot& slot, const EffectInput& input, Span<Vec3> sum) : View(slot, input) {
    position = input.particles.position;
    velocity = input.particles.velocity;
    acceleration = sum;
  }
  Span<const std::uint32_t> neighbours(std::size_t i) const override { return input_.fluid.neighbours(i); }
  Span<const VisibleWall> walls(std::size_t i) const override {
    if (input_.walls == nullptr || i + 1 >= input_.walls->begin.size()) return {};
    const std::uint32_t begin = input_.walls->begin[i];
    return {input_.walls->list.data() + begin, input_.walls->begin[i + 1] - begin};
  }
  void push(std::size_t surface, const std::array<std::uint32_t, 3>& nodes,
            const std::array<double, 3>& weights, const Vec3& force) override {
    if (!has_nodes(surface, nodes)) return;
    SurfaceMotion& s = *surfaces[surface];
    StepContext& step = input_.interval.step;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t node = nodes[k];
      const Vec3 impulse = weights[k] * dt * force;
      if (!impulse.allFinite()) continue;
      push_node(s, node, impulse);
      step.ledger.effect(impulse);
      if (!slot_.effect->is_friction()) step.energy.drive(impulse.dot(s.x_t1[node] - s.x_t0[node]) / dt);
    }
  }
};

class Exchange : public View<EffectExchange> {
 public:
  Exchange(const Effects::Slot& slot, const EffectInput& input, Span<const Contact> near)
      : View(slot, input) {
    position = input.interval.x_t1;
    velocity = input.interval.velocity;
    contacts = near;
    if (!input.interval.mass_left.empty()) mass_ratio = input.interval.mass_left;
  }
  double absorb(std::size_t i, std::size_t surface, const std::array<std::uint32_t, 3>& nodes,
                const std::array<double, 3>& mass) override;
  void transport(std::size_t surface, std::uint32_t from, std::uint32_t to, double mass) override {
    if (!changes_masses() || !is_mass(mass) || from == to) return;
    if (has_node(surface, from) && has_node(surface, to))
      world::transport(attachment(surface), from, to, mass);
  }
  void dry(std::size_t surface, std::uint32_t node, double mass) override {
    if (changes_masses() && is_mass(mass) && has_node(surface, node))
      input_.interval.step.report.mass_dried += take(attachment(surface), node, mass);
  }
  void release(const Release& release) override {
    if (changes_masses()) input_.interval.step.releases.push_back(release);
  }

 private:
  bool changes_masses() const { return slot_.effect->changes_masses() && input_.particles.mass_varies; }
  Attachment& attachment(std::size_t surface) {
    OILSKIN_ASSERT(surface < surfaces.size());
    return *input_.interval.step.surfaces.attachment[surface];
  }
};

double Exchange::absorb(std::size_t i, std::size_t surface, const std::array<std::uint32_t, 3>& nodes,
                        const std::array<double, 3>& mass) {
  IntervalContext& interval = input_.interval;
  double wanted = 0;
  for (double m : mass) wanted += is_mass(m) ? m : 0;
  if (!changes_masses() || i >= id.size() || interval.removed[i] || !(wanted > 0)) return 0;
  if (!has_nodes(surface, nodes)) return 0;
  if (interval.mass_left.empty()) interval.mass_left = input_.particles.mass_ratio;
  mass_ratio = interval.mass_left;
  float& left = interval.mass_left[i];
  const double before = static_cast<double>(left);
  left = static_cast<float>(std::max(0.0, before - wanted / particle_mass));
  if (left < least_ratio) left = 0;
  const double given = before - static_cast<double>(left);  // exact: both have single precision
  double rest = given * particle_mass;
  std::size_t last = 0;
  for (std::size_t k = 0; k < 3; ++k)
    if (is_mass(mass[k])) last = k;
  for (std::size_t k = 0; k <= last; ++k) {
    if (!is_mass(mass[k])) continue;
    const double part = k == last ? rest : given * particle_mass * (mass[k] / wanted);
    world::absorb(attachment(surface), nodes[k], part, velocity[i]);
    rest -= part;
  }
  interval.step.ledger.absorbed(given, velocity[i]);
  return given * particle_mass;
}

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

VisibleWalls::VisibleWalls(const fluid::WallGeometry& geometry, Span<SurfaceMotion* const> surfaces,
                           double support_radius) {
  const std::vector<std::uint32_t>& point_of = geometry.point_of();
  begin.assign(1, 0);
  for (std::uint32_t point : point_of) {
    const bool is_near = point != fluid::WallGeometry::none;
    const std::uint32_t first = is_near ? geometry.points()[point].begin : 0;
    const std::uint32_t last = is_near ? geometry.points()[point].end : 0;
    for (std::uint32_t w = first; w < last; ++w) {
      const fluid::Wall& from = geometry.walls()[w];
      const SurfaceMotion& s = *surfaces[from.surface];
      VisibleWall wall;
      wall.surface = from.surface;
      wall.nodes = s.triangles[from.triangle];
      wall.weights = {from.share(0), from.share(1), from.share(2)};
      wall.normal = from.normal.cast<double>().normalized();
      wall.distance = support_radius * static_cast<double>(from.distance);
      wall.share = static_cast<double>(from.covered);
      const Vec3& a = s.x_t0[wall.nodes[0]];
      wall.back = wall.normal.dot((s.x_t0[wall.nodes[1]] - a).cross(s.x_t0[wall.nodes[2]] - a)) < 0;
      list.push_back(wall);
    }
    begin.push_back(static_cast<std::uint32_t>(list.size()));
  }
}

double Effects::wall_reach() const {
  double reach = 0;
  for (const Slot& s : slots_) reach = std::max(reach, s.effect->wall_reach());
  return reach;
}

Effects::Limit Effects::longest_interval(const FluidSettings& fluid) const {
  Limit limit;
  for (const Slot& s : slots_) {
    const double interval = s.effect->longest_interval(fluid);
    if (interval > 0 && interval < limit.interval) limit = {interval, s.name};
  }
  return limit;
}

const Effects::Slot* Effects::find(const Effect& effect) const {
  for (const Slot& s : slots_)
    if (s.effect == &effect) return &s;
  return nullptr;
}

Status Effects::add(Effect& effect, fluid::Particles& particles, Attachments& attachments) {
  if (Status s = effect.status(); !s.ok()) return s;
  Slot slot{&effect, effect.name(), effect.particle_values(), effect.node_values(), 0, 0};
  for (const Slot& s : slots_)
    if (s.effect == &effect || s.name == slot.name)
      return Status::refused("the world has an effect " + slot.name);
  if (!all_finite(slot.particle_start) || !all_finite(slot.node_start))
    return Status::refused("a start value of the effect " + slot.name + " is not finite");
  slot.first_particle_value = particles.values.size();
  slot.first_node_value = node_value_count();
  std::vector<std::vector<double>> values;
  for (double start : slot.particle_start) values.emplace_back(particles.size(), start);
  slots_.reserve(slots_.size() + 1);
  particles.values.reserve(particles.values.size() + values.size());
  particles.value_start.reserve(particles.value_start.size() + values.size());
  slots_.push_back(std::move(slot));
  for (std::vector<double>& v : values) particles.values.push_back(std::move(v));
  for (double start : slots_.back().particle_start) particles.value_start.push_back(start);
  if (effect.changes_masses()) particles.let_mass_vary();
  for (const auto& a : attachments.all()) fill(*a);
  return {};
}

void Effects::remove(const Effect& effect, fluid::Particles& particles, Attachments& attachments) {
  const Slot* found = find(effect);
  if (found == nullptr) return;
  const auto erase = [](auto& all, std::size_t first, std::size_t count) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
    all.erase(begin, begin + static_cast<std::ptrdiff_t>(count));
  };
  const std::size_t of_particles = found->particle_start.size(), of_nodes = found->node_start.size();
  erase(particles.values, found->first_particle_value, of_particles);
  erase(particles.value_start, found->first_particle_value, of_particles);
  for (const auto& a : attachments.all())
    if (!a->values.empty()) erase(a->values, found->first_node_value, of_nodes);
  for (Slot& s : slots_) {
    if (s.first_particle_value > found->first_particle_value) s.first_particle_value -= of_particles;
    if (s.first_node_value > found->first_node_value) s.first_node_value -= of_nodes;
  }
  erase(slots_, static_cast<std::size_t>(found - slots_.data()), 1);
}

void Effects::fill(Attachment& a) const {
  const std::size_t nodes = a.motion.x_t1.size();
  std::size_t channel = 0;
  for (const Slot& slot : slots_)
    for (double start : slot.node_start) {
      if (a.values.size() <= channel) a.values.emplace_back();
      if (a.values[channel].size() != nodes) a.values[channel].assign(nodes, start);
      ++channel;
    }
}

void Effects::act(const EffectInput& input) const {
  std::vector<Vec3>& sum = input.interval.acceleration;
  std::vector<Vec3>& friction = input.interval.friction;
  sum.assign(input.particles.size(), Vec3::Zero());
  for (const Slot& slot : slots_) {
    const std::vector<Vec3> before = slot.effect->is_friction() ? sum : std::vector<Vec3>();
    Forces forces(slot, input, sum);
    slot.effect->act(forces);
    if (!forces.message.empty())
      input.interval.step.report.messages.push_back("the effect " + slot.name + ": " + forces.message);
    std::uint64_t wrong = 0;
    for (Vec3& a : sum) {
      if (is_in_range(a)) continue;
      a.setZero();
      ++wrong;
    }
    if (wrong > 0)
      input.interval.step.report.messages.push_back(
          "the effect " + slot.name + " gave " + std::to_string(wrong) +
          " particles an acceleration that is not finite, or above 1e15 m/s²; they got none by effects");
    if (before.empty()) continue;
    friction.resize(sum.size(), Vec3::Zero());
    for (std::size_t i = 0; i < sum.size(); ++i) friction[i] += sum[i] - before[i];
  }
}

void Effects::exchange(const EffectInput& input, Span<const Contact> contacts) const {
  std::vector<Contact> of_live;
  for (const Contact& c : contacts)
    if (!input.interval.removed[c.particle]) of_live.push_back(c);
  for (const Slot& slot : slots_) {
    Exchange exchange(slot, input, of_live);
    slot.effect->exchange(exchange);
  }
}

void Effects::visit(Archive& archive) {
  std::uint64_t count = slots_.size();
  archive.value(count);
  if (archive.reading() && count != slots_.size())
    return archive.refuse("it has " + std::to_string(count) + " effects, this one " +
                          std::to_string(slots_.size()) + "; add the same effects in the same order");
  read_.assign(slots_.size(), {});
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    const Slot& slot = slots_[k];
    std::vector<char> name(slot.name.begin(), slot.name.end());
    std::uint64_t of_particles = slot.particle_start.size(), of_nodes = slot.node_start.size();
    if (!archive.reading()) read_[k] = slot.effect->save();
    archive.values(name, of_particles, of_nodes, read_[k]);
    if (archive.reading() && archive.ok() &&
        (std::string(name.begin(), name.end()) != slot.name || of_particles != slot.particle_start.size() ||
         of_nodes != slot.node_start.size()))
      archive.refuse("its effect " + std::string(name.begin(), name.end()) + " is not this one's " +
                     slot.name + "; add the same effects in the same order");
  }
}

Status Effects::restore() const {
  std::vector<std::vector<std::uint8_t>> before;
  for (const Slot& slot : slots_) before.push_back(slot.effect->save());
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    const Status status = slots_[k].effect->restore(read_[k]);
    if (status.ok()) continue;
    for (std::size_t done = 0; done < k; ++done)
      static_cast<void>(slots_[done].effect->restore(before[done]).ok());
    return Status::refused("the effect " + slots_[k].name + ": " + status.message);
  }
  return {};
}

}  // namespace oilskin::world
