#pragma once
// Radiance RGBE pictures (.hdr, .pic), read and written.
//
// A pixel of bytes (r, g, b, e) stands for (r, g, b) · 2^(e − 136), or black if e = 0: the reading
// of HDRShop and of most programs (Radiance itself adds half a step to each mantissa).
//
// Header variables begin in the first column; indented lines are headers of pictures that this one
// was composed of, and do not count. Lines end with LF or CR LF. Variables obeyed:
// - EXPOSURE (one number) and COLORCORR (three): they multiply up, and pixels are divided by them.
// - FORMAT: 32-bit_rle_rgbe, also if missing, or 32-bit_rle_xyze, converted to Rec. 709 (white
//   D65); others are refused. The last one counts.
// - PRIMARIES: pixels are converted to Rec. 709, the white adapted to D65. Radiance's default
//   primaries and eight zeros (Photoshop) are read as Rec. 709.
// - GAMMA: 0 and 1 mean linear, others are refused.
// PIXASPECT and VIEW are ignored, since a probe's mapping fixes the directions of its pixels, and
// so are all others. Sources: Ward, "Real Pixels", Graphics Gems II, 1991; "The RADIANCE Picture
// File Format" in Radiance's file format manual (doc/filefmts), and its reader (src/common/color.c,
// header.c, resolu.c); GAMMA as in Walter's rgbe.c.

#include <wavelet/base/image.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace haarlight::probe {

/// Whether bytes begin like a Radiance picture: with `#?` (the program's name may be any), or with
/// lines of text of which one is FORMAT=32-bit_rle_…, or which end with a blank line and a size
/// line like -Y 256 +X 256.
bool is_rgbe(std::span<const std::byte> bytes);

/// Reads a whole picture: any of the eight orientations, new or old run lengths or none, with
/// anything after the last scanline ignored. Values may be negative where the file is XYZE or has
/// wider primaries than Rec. 709. All scanlines are checked before the pixels are allocated.
/// @param path names the file in errors
/// @throws Error(Input) with the byte offset, if malformed, truncated, or of more than max_pixels
Image read_rgbe(std::span<const std::byte> bytes, const std::string& path);

/// Writes a picture, top row first, run-length coded; whole or not at all.
/// @param image    finite values; negative ones are written as 0
/// @param comments header lines, written after `# `; no line breaks
/// @throws Error(Output)
void write_rgbe(const std::string& path, const Image& image,
                const std::vector<std::string>& comments = {});

} // namespace haarlight::probe
