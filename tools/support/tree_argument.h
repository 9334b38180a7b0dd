#pragma once
// Trees named on a command line as PATH[column,row].

#include <wavelet/file/tree_set.h>

#include <memory>
#include <string>
#include <vector>

namespace haarlight::tool {

/// A tree, and the set that keeps it.
struct NamedTree {
  std::shared_ptr<const wavelet::TreeSet> set;
  wavelet::MapPlace place;

  const wavelet::TreeView& view() const { return set->tree(place.column, place.row); }

  /// As in grace.haar[0,0], without directories.
  std::string label() const;
};

/// Opens what words like "brdf.haar[12,0]" or "grace.haar" (the first tree) name; each file once.
/// @throws UsageError for words of another form and for trees that a set has not, Error(Input)
std::vector<NamedTree> open_trees(const std::vector<std::string>& words);

/// The first tree that is in the world's frame while one before it is not, or the other way round;
/// nullptr if none is. Generic trees, products among them, tell nothing of their frame.
const NamedTree* out_of_frame(const std::vector<NamedTree>& trees);

} // namespace haarlight::tool
