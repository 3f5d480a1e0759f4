#include "audit/motion_trace.h"

#include <algorithm>
#include <cstring>
#include <istream>

namespace oilskin::audit {
namespace {

constexpr char kMagic[] = {'O', 'I', 'L', 'S', 'T', 'E', 'P', '1'};

static_assert(sizeof(double) == 8 && sizeof(Point) == 24, "points are read as blocks");

bool little_endian_host() {
  const std::uint16_t one = 1;
  unsigned char first = 0;
  std::memcpy(&first, &one, 1);
  return first == 1;
}

/// The machines that this runs on are little endian, like the format; on another one the words are turned.
template <class Word>
void from_little_endian(Word* words, std::size_t count) {
  if (little_endian_host()) return;
  for (std::size_t i = 0; i < count; ++i) {
    auto* bytes = reinterpret_cast<unsigned char*>(words + i);
    std::reverse(bytes, bytes + sizeof(Word));
  }
}

template <class Word>
bool read_words(std::istream& in, Word* words, std::size_t count) {
  in.read(reinterpret_cast<char*>(words), static_cast<std::streamsize>(count * sizeof(Word)));
  from_little_endian(words, count);
  return static_cast<std::size_t>(in.gcount()) == count * sizeof(Word);
}

/// Reads `count` items of `Words` words each, growing as the data comes.
template <class Word, std::size_t Words, class Item>
bool read_items(std::istream& in, std::uint64_t count, std::vector<Item>* items) {
  static_assert(sizeof(Item) == Words * sizeof(Word), "items are blocks of words");
  constexpr std::uint64_t kBlock = 65536;
  items->clear();
  while (items->size() < count) {
    const std::size_t old = items->size();
    const auto more = static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, count - old));
    items->resize(old + more);
    if (!read_words(in, reinterpret_cast<Word*>(items->data() + old), more * Words)) return false;
  }
  return true;
}

bool read_surface(std::istream& in, Surface* surface) {
  std::array<std::uint64_t, 3> head{};
  if (!read_words(in, head.data(), head.size())) return false;
  surface->id = head[0];
  return read_items<double, 3>(in, head[1], &surface->start) &&
         read_items<double, 3>(in, head[1], &surface->end) &&
         read_items<std::uint32_t, 3>(in, head[2], &surface->triangles);
}

bool read_body(std::istream& in, Record* record) {
  std::uint64_t particles = 0, surfaces = 0;
  if (!read_words(in, &record->number, 1) || !read_words(in, &record->length, 1) ||
      !read_words(in, &particles, 1) || !read_items<std::uint64_t, 1>(in, particles, &record->ids) ||
      !read_items<double, 3>(in, particles, &record->start) ||
      !read_items<double, 3>(in, particles, &record->end) || !read_words(in, &surfaces, 1)) {
    return false;
  }
  record->surfaces.clear();
  for (std::uint64_t i = 0; i < surfaces; ++i) {
    record->surfaces.emplace_back();
    if (!read_surface(in, &record->surfaces.back())) return false;
  }
  return true;
}

}  // namespace

ReadResult read_record(std::istream& in, Record* record, std::string* error) {
  char magic[sizeof(kMagic)];
  in.read(magic, sizeof(magic));
  if (in.gcount() == 0 && in.eof()) return ReadResult::kEnd;
  if (in.gcount() != sizeof(magic) || std::memcmp(magic, kMagic, sizeof(magic)) != 0) {
    *error = "no record begins where one should (the letters OILSTEP1 are missing)";
    return ReadResult::kMalformed;
  }
  if (!read_body(in, record)) {
    *error = "the file ends within a record";
    return ReadResult::kMalformed;
  }
  return ReadResult::kRecord;
}

}  // namespace oilskin::audit
