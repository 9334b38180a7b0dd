#pragma once
// Two maps and their difference as a picture.

#include <image/contact_sheet.h>

#include <wavelet/tree/map_set.h>

#include <string>
#include <vector>

namespace haarlight::tool {

/// One map of each set, under its name.
struct ComparedMaps {
  wavelet::Map a;
  wavelet::Map b;
  std::string name_a;
  std::string name_b;
};

/// A, B and the luminance of B − A as they are shown, from 0 to 1, under their names. Maps larger
/// than `largest_side` are shown smaller; the difference carries a legend below.
std::vector<image::SheetEntry> comparison_pictures(const ComparedMaps& maps, int largest_side);

/// As .exr: channels R, G, B hold B − A, channels A.R … and B.R … the maps. As .png: A, B and the
/// luminance of B − A side by side. A and B share one exposure, which brings A to a mean of 0.18;
/// the difference is black where it is zero, red to yellow where B is larger, blue to cyan where it
/// is smaller, and grows with the cube root of its size, as the legend below tells; maps above
/// 1024 px are shown smaller, the difference by the largest value under each pixel.
/// @throws Error(Output)
void write_comparison(const std::string& path, const ComparedMaps& maps);

} // namespace haarlight::tool
