/// The contacts at the start positions, by the stage of contact that finds them.
#pragma once

#include "contact/contact_pass.h"

namespace oilskin::test {

/// Ordered by particle, surface and triangle. `motion.x_t1` is the predicted end. Arguments stay as they are.
inline std::vector<Contact> find_contacts(const ParticleMotion& motion, Span<SurfaceMotion* const> surfaces,
                                          const ContactSettings& settings = {}) {
  ParticleMotion particles = motion;
  std::vector<SurfaceMotion> copies;
  for (const SurfaceMotion* s : surfaces) copies.push_back(*s);
  std::vector<contact::SurfaceGeometry> geometry(copies.size());
  std::vector<SurfaceMotion*> surface_list;
  std::vector<contact::SurfaceGeometry*> geometry_list;
  for (std::size_t k = 0; k < copies.size(); ++k) {
    geometry[k].analyse(copies[k]);
    surface_list.push_back(&copies[k]);
    geometry_list.push_back(&geometry[k]);
  }
  const Workers workers(1);
  contact::ContactBuffers buffers;
  ContactReport report;
  StageSeconds seconds;
  contact::ContactPass pass(1, settings, workers, particles, surface_list, geometry_list, buffers, report,
                            seconds);
  pass.find();
  return pass.select_contacts();
}

}  // namespace oilskin::test
