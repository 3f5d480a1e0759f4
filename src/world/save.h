/// The frame around the bytes of a saved world (docs/manual/saving.md).
#pragma once

#include <vector>

#include "oilskin/types.h"

namespace oilskin::world {

/// Puts magic, byte order, version, length and check sum before the bytes.
std::vector<std::uint8_t> framed(Span<const std::uint8_t> content);

/// Finds the content of a frame, or says what is wrong with it.
Status unframe(Span<const std::uint8_t> saved, Span<const std::uint8_t>* content);

}  // namespace oilskin::world
