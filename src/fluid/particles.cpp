#include "fluid/particles.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <type_traits>

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t chunk_size = 4096;

/// The first that does not stay is `first`.
template <class T>
void compress_array(std::vector<T>& values, Span<const std::uint8_t> keep, std::size_t first) {
  std::size_t kept = first;
  for (std::size_t i = first; i < values.size(); ++i)
    if (keep[i]) values[kept++] = values[i];
  values.resize(kept);
}

void permute_array(std::vector<Vec3>& values, Span<const std::uint32_t> order, const Workers& workers,
                   std::vector<Vec3>& scratch) {
  workers.for_each(order.size(), chunk_size, [&](std::size_t i) { scratch[i] = values[order[i]]; });
  values.swap(scratch);
}

/// Numbers, in the memory of `scratch`.
template <class T>
void permute_array(std::vector<T>& values, Span<const std::uint32_t> order, const Workers& workers,
                   std::vector<Vec3>& scratch) {
  static_assert(std::is_arithmetic_v<T> && sizeof(T) <= sizeof(Vec3));
  const auto at = [&](std::size_t i) {
    return reinterpret_cast<unsigned char*>(scratch.data()) + i * sizeof(T);
  };
  workers.for_each(order.size(), chunk_size,
                   [&](std::size_t i) { std::memcpy(at(i), &values[order[i]], sizeof(T)); });
  workers.for_chunks(order.size(), chunk_size, [&](std::size_t begin, std::size_t end, std::size_t) {
    std::memcpy(&values[begin], at(begin), (end - begin) * sizeof(T));
  });
}

template <class T>
void copy_array(const std::vector<T>& from, const Workers& workers, std::vector<T>& to) {
  to.resize(from.size());
  workers.for_chunks(from.size(), chunk_size, [&](std::size_t begin, std::size_t end, std::size_t) {
    std::copy(&from[begin], &from[begin] + (end - begin), &to[begin]);
  });
}

// At least doubles the capacity, so that particles that come one by one are not copied each time.
template <class T>
void reserve_array(std::vector<T>& values, std::size_t count) {
  if (values.capacity() - values.size() < count)
    values.reserve(std::max(values.size() + count, 2 * values.capacity()));
}

}  // namespace

void Particles::reserve_more(std::size_t count) {
  reserve_array(id, count);
  reserve_array(position, count);
  reserve_array(velocity, count);
  reserve_array(motion, count);
  reserve_array(density, count);
  reserve_array(pressure, count);
  if (spares_load) reserve_array(spare_load, count);
  if (mass_varies) reserve_array(mass_ratio, count);
  if (ends) reserve_array(end_time, count);
  for (std::vector<double>& v : values) reserve_array(v, count);
}

double Particles::sum_of_relative_masses() const {
  if (!mass_varies) return static_cast<double>(size());
  return std::accumulate(mass_ratio.begin(), mass_ratio.end(), 0.0);
}

Vec3 Particles::sum_of_velocities(const Workers& workers) const {
  return workers.ordered_sum(size(), chunk_size, Vec3(Vec3::Zero()), [&](std::size_t begin, std::size_t end) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = begin; i < end; ++i) sum += relative_mass(i) * velocity[i];
    return sum;
  });
}

void Particles::let_load_be_spared() {
  if (spares_load) return;
  spare_load.assign(size(), Vec3::Zero());
  spares_load = true;
}

void Particles::let_mass_vary() {
  if (mass_varies) return;
  mass_ratio.assign(size(), 1);
  mass_varies = true;
}

void Particles::let_end() {
  if (ends) return;
  end_time.assign(size(), std::numeric_limits<double>::infinity());
  ends = true;
}

void Particles::push_back(std::uint64_t new_id, const Vec3& x, const Vec3& v, double rest_density) {
  OILSKIN_ASSERT(new_id != 0 && rest_density > 0);
  id.push_back(new_id);
  position.push_back(x);
  velocity.push_back(v);
  motion.push_back(v);  // it has not moved yet
  density.push_back(rest_density);
  pressure.push_back(0);
  if (spares_load) spare_load.push_back(Vec3::Zero());
  if (mass_varies) mass_ratio.push_back(1);
  if (ends) end_time.push_back(new_end);
  for (std::size_t k = 0; k < values.size(); ++k) values[k].push_back(value_start[k]);
}

void Particles::compress(Span<const std::uint8_t> keep) {
  OILSKIN_ASSERT(keep.size() == size());
  const auto first = static_cast<std::size_t>(std::find(keep.begin(), keep.end(), 0) - keep.begin());
  if (first == size()) return;
  compress_array(position, keep, first);
  compress_array(velocity, keep, first);
  compress_array(motion, keep, first);
  compress_array(density, keep, first);
  compress_array(pressure, keep, first);
  if (spares_load) compress_array(spare_load, keep, first);
  if (mass_varies) compress_array(mass_ratio, keep, first);
  if (ends) compress_array(end_time, keep, first);
  for (std::vector<double>& v : values) compress_array(v, keep, first);
  compress_array(id, keep, first);
  OILSKIN_ASSERT(position.size() == size() && velocity.size() == size() && motion.size() == size());
  OILSKIN_ASSERT(density.size() == size() && pressure.size() == size());
}

void Particles::permute(Span<const std::uint32_t> order, const Workers& workers, Scratch& scratch) {
  OILSKIN_ASSERT(order.size() == size());
  scratch.resize(size());
  permute_array(position, order, workers, scratch);
  permute_array(velocity, order, workers, scratch);
  permute_array(motion, order, workers, scratch);
  permute_array(density, order, workers, scratch);
  permute_array(pressure, order, workers, scratch);
  if (spares_load) permute_array(spare_load, order, workers, scratch);
  if (mass_varies) permute_array(mass_ratio, order, workers, scratch);
  if (ends) permute_array(end_time, order, workers, scratch);
  for (std::vector<double>& v : values) permute_array(v, order, workers, scratch);
  permute_array(id, order, workers, scratch);
}

void Particles::copy_to(Particles& to, const Workers& workers) const {
  // Names every field, so that a new one does not compile until it is copied.
  auto& [id_, position_, velocity_, motion_, density_, pressure_, spares_load_, spare_load_, mass_varies_,
         mass_ratio_, ends_, end_time_, new_end_, values_, value_start_] = to;
  copy_array(id, workers, id_);
  copy_array(position, workers, position_);
  copy_array(velocity, workers, velocity_);
  copy_array(motion, workers, motion_);
  copy_array(density, workers, density_);
  copy_array(pressure, workers, pressure_);
  spares_load_ = spares_load;
  copy_array(spare_load, workers, spare_load_);
  mass_varies_ = mass_varies;
  copy_array(mass_ratio, workers, mass_ratio_);
  ends_ = ends;
  copy_array(end_time, workers, end_time_);
  new_end_ = new_end;
  values_.resize(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) copy_array(values[k], workers, values_[k]);
  value_start_ = value_start;
}

void Particles::visit(Archive& archive) {
  archive.values(id, position, velocity, motion, density, pressure);
  visit_spare_load(archive);
  const std::size_t n = id.size();
  archive.require(position.size() == n && velocity.size() == n && motion.size() == n && density.size() == n &&
                      pressure.size() == n && spare_load.size() == (spares_load ? n : 0),
                  "the number of particles");
  archive.values(mass_varies, mass_ratio);
  archive.require(mass_ratio.size() == (mass_varies ? n : 0), "the number of masses");
  for (float ratio : mass_ratio) archive.require(ratio > 0 && ratio <= 1, "the mass of a particle");
  archive.values(ends, end_time);
  archive.require(end_time.size() == (ends ? n : 0), "the number of ends");
  for (double end : end_time) archive.require(!std::isnan(end), "the end of a particle");
  // The kinds are those of the world's effects, which are compared before.
  for (std::vector<double>& v : values) {
    archive.value(v);
    archive.require(v.size() == n, "the number of values of an effect");
  }
  if (!archive.reading() || !archive.ok()) return;
  // The next step removes particles with velocities that are no numbers (add_velocities()).
  for (std::size_t i = 0; i < motion.size(); ++i)
    archive.require(motion[i].allFinite() || !velocity[i].allFinite(), "the motion of a particle");
}

/// Worlds that keep none save zeros.
void Particles::visit_spare_load(Archive& archive) {
  if (!archive.reading()) {
    std::vector<Vec3> zeros(spares_load ? 0 : size(), Vec3::Zero());
    archive.value(spares_load ? spare_load : zeros);
    return;
  }
  archive.value(spare_load);
  const auto is_zero = [](const Vec3& load) { return load.isZero(0); };
  spares_load = spare_load.size() != size() || !std::all_of(spare_load.begin(), spare_load.end(), is_zero);
  if (!spares_load) spare_load.clear();
}

}  // namespace oilskin::fluid
