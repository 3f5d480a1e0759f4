#include "oilskin/version.h"

namespace oilskin {

Version version() {
  return header_version;
}

}  // namespace oilskin
