#pragma once
// Mutations of .haar files that keep their checksums right, so that the rules behind them are
// reached.

#include <cstddef>
#include <cstdint>

namespace haarlight::fuzzing {

// Each has the signature of LLVMFuzzerCustomMutator: changes `data` in place and returns its size.
std::size_t mutate_mapped(std::uint8_t* data, std::size_t size, std::size_t max_size,
                          unsigned seed);
std::size_t mutate_packed(std::uint8_t* data, std::size_t size, std::size_t max_size,
                          unsigned seed);
/// By the form that the file has.
std::size_t mutate_either(std::uint8_t* data, std::size_t size, std::size_t max_size,
                          unsigned seed);

} // namespace haarlight::fuzzing
