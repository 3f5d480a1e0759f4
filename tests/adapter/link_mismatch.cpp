// Compiled for single precision and linked with the adapter for double precision: must not link.
#include "oilskin/bullet.h"

int main() {
  return 0;
}
