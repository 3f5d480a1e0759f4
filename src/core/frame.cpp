#include "core/frame.h"

#include <algorithm>
#include <cstring>

#include "core/archive.h"
#include "core/hash.h"

namespace oilskin {

namespace {

constexpr std::uint32_t byte_order = 0x01020304, swapped_byte_order = 0x04030201;
constexpr std::size_t frame_bytes = 32;

std::uint64_t check_sum(Span<const std::uint8_t> bytes) {
  Hash64 hash;
  hash.add(static_cast<std::uint64_t>(bytes.size()));
  for (std::size_t at = 0; at < bytes.size(); at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, std::min<std::size_t>(8, bytes.size() - at));
    hash.add(word);
  }
  return hash.value();
}

}  // namespace

std::vector<std::uint8_t> framed(const FrameKind& kind, Span<const std::uint8_t> content) {
  std::vector<std::uint8_t> saved(kind.magic, kind.magic + sizeof kind.magic);
  saved.reserve(frame_bytes + content.size());
  std::uint32_t order = byte_order, version = kind.version;
  std::uint64_t length = content.size(), sum = check_sum(content);
  Archive(saved).values(order, version, length, sum);
  saved.insert(saved.end(), content.begin(), content.end());
  return saved;
}

Status unframe(const FrameKind& kind, Span<const std::uint8_t> saved, Span<const std::uint8_t>* content) {
  const std::string name = std::string("the ") + kind.name;
  if (saved.size() < frame_bytes || std::memcmp(saved.data(), kind.magic, sizeof kind.magic) != 0)
    return Status::refused(std::string("the bytes are not a ") + kind.name);
  std::uint32_t order = 0, version = 0;
  std::uint64_t length = 0, sum = 0;
  Archive in(Span<const std::uint8_t>(saved.data() + sizeof kind.magic, frame_bytes - sizeof kind.magic));
  in.values(order, version, length, sum);
  if (order == swapped_byte_order)
    return Status::refused(name + " comes from a machine with the other byte order");
  if (order != byte_order) return Status::refused(name + " is damaged: its byte order is unknown");
  if (version != kind.version)
    return Status::refused(name + " has version " + std::to_string(version) +
                           "; this library reads version " + std::to_string(kind.version));
  *content = {saved.data() + frame_bytes, saved.size() - frame_bytes};
  if (length != content->size())
    return Status::refused(name + " has " + std::to_string(content->size()) + " bytes of " +
                           std::to_string(length));
  if (sum != check_sum(*content)) return Status::refused(name + " is damaged: its check sum is wrong");
  return {};
}

}  // namespace oilskin
