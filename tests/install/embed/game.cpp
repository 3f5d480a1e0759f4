// What a user's file sees: the alignment that it asked for, and the definitions of its own Bullet.
#include "oilskin/bullet.h"

static_assert(EIGEN_MAX_ALIGN_BYTES == 32, "the alignment is not the user's");
static_assert(BT_OWN_CHOICE == 7, "a definition of the user's Bullet is lost");

int main() {
  return 0;
}
