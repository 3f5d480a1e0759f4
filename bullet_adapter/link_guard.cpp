#include "oilskin/bullet.h"

// The symbol that programs compiled for this precision need; see oilskin/bullet.h.
extern "C" {
extern const char OILSKIN_BULLET_GUARD;
const char OILSKIN_BULLET_GUARD = 1;
}
