#pragma once
// Two sets of maps from files of either kind, brought into one form.

#include <wavelet/tree/compare.h>

#include <string>
#include <vector>

namespace haarlight::tool {

/// What the command line says of the inputs; the numbers are column and row, or nothing.
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
  std::string values;             ///< what pixels hold, in words
  std::vector<std::string> notes; ///< what had to be done to compare them
};

/// Opens both. One map of each is taken if the input says so; B's is then the one of tree_b, else
/// the only one it has, else that of the same indices. Otherwise sets folded in different ways are
/// unfolded, larger maps averaged to the smaller ones' size, and colours reduced to luminance where
/// one side holds nothing else.
/// @throws Error(Input) for unreadable files and for sets that cannot be compared, saying what
///         would be right
/// @throws UsageError for a tree that a set lacks
ComparedSets open_compared(const CompareInput& input);

} // namespace haarlight::tool
