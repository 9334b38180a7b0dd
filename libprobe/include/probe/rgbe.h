#pragma once
// Radiance RGBE pictures (.hdr, .pic), read and written.
//
// A pixel of bytes (r, g, b, e) stands for (r, g, b) · 2^(e − 136), or black if e = 0: the reading
// of HDRShop and of most programs (Radiance itself adds half a step to each mantissa). EXPOSURE and
// COLORCORR header lines multiply up and pixels are divided by them. FORMAT=32-bit_rle_xyze is
// converted to Rec. 709 RGB (white D65); PRIMARIES and GAMMA lines are ignored, as HDR pictures of
// Photoshop hold zeros there. Reference: Ward, "Real Pixels", Graphics Gems II, 1991.

#include <probe/image.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace haarlight::probe {

/// Whether bytes begin like a Radiance picture (`#?RADIANCE` or `#?RGBE`).
bool is_rgbe(std::span<const std::byte> bytes);

/// Reads a whole picture: any of the eight orientations, new or old run lengths or none, with
/// anything after the last scanline ignored. Values may be negative where the file is XYZE.
/// @param path names the file in errors
/// @throws Error(Input) with the byte offset, if malformed, truncated, or larger than its bytes
/// allow
Image read_rgbe(std::span<const std::byte> bytes, const std::string& path);

/// Writes a picture, top row first, run-length coded; whole or not at all.
/// @param image    finite values; negative ones are written as 0
/// @param comments header lines, written after `# `; no line breaks
/// @throws Error(Output)
void write_rgbe(const std::string& path, const Image& image,
                const std::vector<std::string>& comments = {});

/// The nearest RGBE value of a colour: mantissas are rounded, values of 2^127 and more held there.
std::array<std::uint8_t, 4> encode_rgbe(const Rgb& colour);

/// The colour of four bytes r, g, b, e.
Rgb decode_rgbe(const std::array<std::uint8_t, 4>& pixel);

} // namespace haarlight::probe
