#pragma once
// Memory of the process: how much is available, and the error thrown when it runs out.

#include <cstdint>
#include <new>
#include <stdexcept>
#include <string>

namespace haarlight {

/// Bytes that can be allocated now: the minimum of the system's available memory, the control
/// group's limit and the process's address-space limit (ulimit -v), each less the memory in use.
std::uint64_t available_memory();

/// Out of memory, with the purpose of the allocation. what() reads
/// `out of memory: 512 MiB for the map of 8192 x 8192 pixels`.
class OutOfMemory : public std::bad_alloc {
public:
  /// @param purpose as in "the map of 8192 x 8192 pixels"
  /// @param bytes   requested; 0 = unknown
  explicit OutOfMemory(const std::string& purpose, std::uint64_t bytes = 0) noexcept;
  const char* what() const noexcept override { return m_text; }

private:
  char m_text[256]; ///< not a string, whose allocation could fail again
};

/// Calls `allocate` and turns std::bad_alloc and std::length_error into an OutOfMemory with this
/// purpose, unless it has one already. For large allocations and for stages that make many.
template <class F>
auto with_memory_for(const std::string& purpose, std::uint64_t bytes, F&& allocate) {
  try {
    return allocate();
  } catch (const OutOfMemory&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw OutOfMemory(purpose, bytes);
  } catch (const std::length_error&) { // a container larger than the address space
    throw OutOfMemory(purpose, bytes);
  }
}

} // namespace haarlight
