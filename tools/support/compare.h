#pragma once
// Two sets of maps from files of either form, made comparable, and pictures of their difference.

#include <image/contact_sheet.h>

#include <wavelet/tree/compare.h>
#include <wavelet/tree/map_set.h>

#include <string>
#include <vector>

namespace haarlight::tool {

/// Options of the inputs; the numbers are column and row, or none.
struct CompareInput {
  std::string reference; ///< path of A, a .haar file or a map set as EXR
  std::string compared;  ///< path of B
  std::vector<double> tree;
  std::vector<double> tree_b;
};

/// Two sets of equal size, columns and rows.
struct ComparedSets {
  wavelet::SharedMaps a;
  wavelet::SharedMaps b;
  wavelet::MapPlace first_a; ///< indices in A and B of the first of these maps
  wavelet::MapPlace first_b;
  std::string values;             ///< quantity of the pixels
  std::vector<std::string> notes; ///< conversions that were needed
};

/// Opens both. If `tree` is set, one map of each is taken: that of `tree_b` in B, else its only
/// one, else that of the same indices. Otherwise sets with different folds are unfolded, larger
/// maps are averaged to the size of the smaller ones, and colours are reduced to luminance if one
/// side has no colours.
/// @throws Error(Input) for unreadable files and for sets that cannot be compared, with the
///         expected input
/// @throws UsageError for a tree that a set lacks
ComparedSets open_compared(const CompareInput& input);

/// One map of each set, under its name.
struct ComparedMaps {
  wavelet::Map a;
  wavelet::Map b;
  std::string name_a;
  std::string name_b;
};

/// A, B and the luminance of B − A as display values from 0 to 1, with their names. Maps larger
/// than `largest_side` are reduced; the difference has a legend below.
std::vector<image::SheetEntry> comparison_pictures(const ComparedMaps& maps, int largest_side);

/// As .exr: channels R, G, B hold B − A, channels A.R … and B.R … the maps. As .png: A, B and the
/// luminance of B − A side by side. A and B share one exposure, which brings A to a mean of 0.18;
/// the difference is black where it is zero, red to yellow where B is larger, blue to cyan where it
/// is smaller, and grows with the cube root of its size, as the legend below shows; maps above
/// 1024 px are reduced, the difference to the largest value under each pixel.
/// @throws Error(Output)
void write_comparison(const std::string& path, const ComparedMaps& maps);

} // namespace haarlight::tool
