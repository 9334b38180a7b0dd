#pragma once
// Bytes within a page.

#include <cstddef>
#include <span>
#include <string>

namespace haarlight::html {

/// In Base64 (RFC 4648), padded.
std::string base64(std::span<const std::byte> bytes);

} // namespace haarlight::html
