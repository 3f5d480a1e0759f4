#include "oilskin/types.h"

static_assert(EIGEN_MAX_ALIGN_BYTES == 16, "a user who says nothing has the alignment of the library");
