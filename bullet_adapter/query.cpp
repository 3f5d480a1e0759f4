#include <algorithm>

#include "convert.h"
#include "coupling_impl.h"
#include "oilskin/bullet_query.h"
#include "shape_region.h"

namespace oilskin::bullet {

btFluidQuery::btFluidQuery(const btFluid& fluid) : m_query(fluid.getWorld()) {
  if (!fluid.m_coupling) return;
  const btFluidCoupling::Impl& coupling = *fluid.m_coupling->m_impl;
  const std::size_t k = *coupling.index_of(&fluid);
  for (const Attachment& a : coupling.attachments) {
    if (!a.soft || !a.ids[k]) continue;
    const double thickness = fluid.getWorld().surface(a.ids[k])->thickness;
    m_cloths.push_back(
        {a.cloth, thickness + m_query.spacing(), a.soft->wet_nodes(fluid.getWorld().absorbed(a.ids[k]))});
  }
}

btScalar btFluidQuery::getVolume(const btVector3& aabbMin, const btVector3& aabbMax) const {
  double volume = 0;
  const Status status = m_query.volume(Box{to_vec3(aabbMin), to_vec3(aabbMax)}, &volume);
  return status.ok() ? static_cast<btScalar>(volume) : btScalar(-1);
}

btScalar btFluidQuery::getVolume(const btConvexShape* shape, const btTransform& transform) const {
  if (!shape) return -1;
  const std::optional<Eigen::Affine3d> to_local = inverse_of(transform);
  const std::optional<ConvexRegion> region = ConvexRegion::of(*shape);
  if (!to_local || !region) return -1;
  const Span<const Vec3> x = m_query.positions();
  double mass = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (region->contains(*to_local * x[i])) mass += m_query.masses()[i];
  return static_cast<btScalar>(mass / m_query.rest_density());
}

bool btFluidQuery::rayTest(const btVector3& from, const btVector3& to, btFluidRayResult& result) const {
  WaterHit hit;
  if (!m_query.ray(to_vec3(from), to_vec3(to), &hit).ok() || !hit.found) return false;
  const double length = (to_vec3(to) - to_vec3(from)).stableNorm();
  result.m_fraction = static_cast<btScalar>((hit.place - to_vec3(from)).stableNorm() / length);
  result.m_point = to_bt(hit.place);
  result.m_normal = to_bt(hit.normal);
  result.m_particle = static_cast<int>(hit.particle);
  return true;
}

bool btFluidQuery::getLevel(const btVector3& point, const btVector3& up, btScalar& level) const {
  double height = 0;
  bool found = false;
  if (!m_query.level(to_vec3(point), to_vec3(up), &height, &found).ok() || !found) return false;
  level = static_cast<btScalar>(height);
  return true;
}

btScalar btFluidQuery::getDensity(const btVector3& point) const {
  WaterSample sample;
  return m_query.sample(to_vec3(point), &sample).ok() ? static_cast<btScalar>(sample.density) : btScalar(0);
}

btVector3 btFluidQuery::getVelocityAt(const btVector3& point) const {
  WaterSample sample;
  return m_query.sample(to_vec3(point), &sample).ok() ? to_bt(sample.velocity) : btVector3(0, 0, 0);
}

bool btFluidQuery::isWet(const btVector3& point) const {
  bool is_near = false;
  return m_query.is_near(to_vec3(point), m_query.spacing(), &is_near).ok() && is_near;
}

bool btFluidQuery::isNodeWet(const btSoftBody* cloth, int node) const {
  const auto it =
      std::find_if(m_cloths.begin(), m_cloths.end(), [cloth](const Cloth& c) { return c.body == cloth; });
  if (it == m_cloths.end() || node < 0 || node >= cloth->m_nodes.size()) return false;
  const auto n = static_cast<std::size_t>(node);
  if (n < it->absorbed.size() && it->absorbed[n]) return true;
  bool is_near = false;
  return m_query.is_near(to_vec3(cloth->m_nodes[node].m_x), it->reach, &is_near).ok() && is_near;
}

int btFluidQuery::findNearest(const btVector3& point) const {
  WaterHit hit;
  return m_query.nearest(to_vec3(point), &hit).ok() && hit.found ? static_cast<int>(hit.particle) : -1;
}

}  // namespace oilskin::bullet
