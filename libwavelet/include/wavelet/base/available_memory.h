#pragma once
// How much memory this process may still take.

#include <cstdint>

namespace haarlight {

/// Bytes that can be allocated now: the least of the memory that the system has available, the
/// control group's limit and the process's limit of address space (ulimit -v), each less the
/// memory in use.
std::uint64_t available_memory();

} // namespace haarlight
