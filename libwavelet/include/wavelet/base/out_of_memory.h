#pragma once
// Memory that ran out, with the purpose it was needed for.

#include <cstdint>
#include <new>
#include <stdexcept>
#include <string>

namespace haarlight {

/// what() reads `out of memory: 512 MiB for the map of 8192 x 8192 pixels`.
class OutOfMemory : public std::bad_alloc {
public:
  /// @param purpose as in "the map of 8192 x 8192 pixels"
  /// @param bytes   that were asked for; 0 = unknown
  explicit OutOfMemory(const std::string& purpose, std::uint64_t bytes = 0) noexcept;
  const char* what() const noexcept override { return m_text; }

private:
  char m_text[256]; ///< no string: making one could fail again
};

/// Calls `allocate`; memory that runs out in it becomes an OutOfMemory of this purpose, unless it
/// has one already. For large allocations, and for stages of work that make many.
template <class F>
auto with_memory_for(const std::string& purpose, std::uint64_t bytes, F&& allocate) {
  try {
    return allocate();
  } catch (const OutOfMemory&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw OutOfMemory(purpose, bytes);
  } catch (const std::length_error&) { // of a container that no address space could hold
    throw OutOfMemory(purpose, bytes);
  }
}

} // namespace haarlight
