#pragma once
// One Zstandard frame (RFC 8878) that states its content size.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace haarlight::wavelet {

/// Appends a frame with its content size, without checksum or dictionary. The bytes depend on the
/// content and on the version of libzstd alone.
/// @return bytes appended
std::size_t append_frame(std::span<const std::byte> content, std::vector<std::byte>& bytes);

/// The content size that a frame states, if `frame` is exactly one frame whose blocks can hold that
/// much. Reads the frame header and the block headers; decodes nothing. Nothing is returned for
/// frames with a dictionary or with a reserved or unused bit set.
std::optional<std::uint64_t> frame_content_size(std::span<const std::byte> frame);

/// Fills `content`; false if the frame is broken or holds another number of bytes.
bool read_frame(std::span<const std::byte> frame, std::span<std::byte> content);

} // namespace haarlight::wavelet
