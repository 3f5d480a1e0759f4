/// The header of saved bytes: magic, byte order, version, length and check sum (docs/manual/saving.md).
#pragma once

#include <vector>

#include "oilskin/types.h"

namespace oilskin {

/// A kind of saved bytes.
struct FrameKind {
  char magic[8];
  std::uint32_t version;
  const char* name;  ///< for messages: "saved world"
};

/// Prepends the header.
std::vector<std::uint8_t> framed(const FrameKind& kind, Span<const std::uint8_t> content);

/// Checks the header and finds the content; refuses with the reason.
Status unframe(const FrameKind& kind, Span<const std::uint8_t> saved, Span<const std::uint8_t>* content);

}  // namespace oilskin
