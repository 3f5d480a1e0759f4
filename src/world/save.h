/// The header of a saved world, with check sum (docs/manual/saving.md).
#pragma once

#include <vector>

#include "oilskin/types.h"

namespace oilskin::world {

/// Prepends magic, byte order, version, length and check sum.
std::vector<std::uint8_t> framed(Span<const std::uint8_t> content);

/// Checks the header and finds the content; refuses with the reason.
Status unframe(Span<const std::uint8_t> saved, Span<const std::uint8_t>* content);

}  // namespace oilskin::world
