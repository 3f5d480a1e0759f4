/// Arrays whose first element lies at the start of a cache line.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace oilskin {

template <class T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t alignment{64};

  CacheLineAllocator() = default;
  template <class U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}  // NOLINT: allocators convert
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), alignment)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, alignment); }
  friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }
  friend bool operator!=(const CacheLineAllocator&, const CacheLineAllocator&) { return false; }
};

/// Vector instructions of 64 bytes that load from it touch one line each.
template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace oilskin
