#include "oilskin/bullet.h"

static_assert(BT_BULLET_VERSION >= 324, "Oilskin needs Bullet 3.24 or newer");

// The symbol that programs compiled for this precision need; see oilskin/bullet.h.
extern "C" {
extern const char OILSKIN_BULLET_GUARD;
const char OILSKIN_BULLET_GUARD = 1;
}
