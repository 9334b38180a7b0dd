#pragma once
// Memory for tables that are read all over: on large pages where the system offers them.

#include <cstddef>
#include <new>

#include <sys/mman.h>

namespace haarlight::brdf {

/// An allocator for containers of many MB. Large pages are a wish: without them it works as well.
template <class T>
struct LargePages {
  using value_type = T;
  static constexpr std::size_t page = std::size_t{1} << 21U;

  LargePages() = default;
  template <class U>
  explicit LargePages(const LargePages<U>& /*other*/) {}

  T* allocate(std::size_t count) {
    void* memory = ::operator new (count * sizeof(T), std::align_val_t{page});
    ::madvise(memory, count * sizeof(T), MADV_HUGEPAGE);
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t /*count*/) {
    ::operator delete (memory, std::align_val_t{page});
  }
  template <class U>
  bool operator==(const LargePages<U>& /*other*/) const {
    return true;
  }
};

} // namespace haarlight::brdf
