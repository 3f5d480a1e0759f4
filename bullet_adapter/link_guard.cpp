#include "oilskin/bullet.h"

// What a program compiled for this precision looks for; see oilskin/bullet.h.
extern "C" {
extern const char OILSKIN_BULLET_GUARD;
const char OILSKIN_BULLET_GUARD = 1;
}
