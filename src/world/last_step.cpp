/// What the last step left for the caller.
#include "world/world_impl.h"

namespace oilskin {

const StepReport& World::report() const {
  return impl_->report;
}

const std::vector<Contact>& World::contacts() const {
  return impl_->contacts;
}

const std::vector<SurfaceId>& World::contact_surfaces() const {
  return impl_->contact_surfaces;
}

}  // namespace oilskin
