#pragma once
// One zstd frame: some bytes that say how many they become.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace haarlight::wavelet {

/// Appends a frame with its content size, without checksum or dictionary. The bytes depend on the
/// content and on the version of libzstd alone.
/// @return bytes appended
std::size_t append_frame(std::span<const std::byte> content, std::vector<std::byte>& bytes);

/// True if `frame` is one whole frame that claims to hold `size` bytes.
bool frame_claims(std::span<const std::byte> frame, std::uint64_t size);

/// Fills `content`; false if the frame is broken or holds another number of bytes.
bool read_frame(std::span<const std::byte> frame, std::span<std::byte> content);

} // namespace haarlight::wavelet
