#pragma once
// Uses the trees of a set the way programs do, so that a bad link that was accepted is followed.

#include <wavelet/file/tree_set.h>

#include <algorithm>

namespace haarlight::fuzzing {

inline void walk(const wavelet::TreeView& tree) {
  tree.average(tree.levels, 0, 0);
  tree.value(0.999F, 0.999F);
  tree.reconstruct(std::min(tree.levels, 6));
}

/// The first trees of every set, some of those of a large one.
inline void walk(const wavelet::TreeSet& set) {
  const int columns = std::min(set.info().columns, 8);
  const int rows = std::min(set.info().rows, 8);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      walk(set.tree(column, row));
      for (int level = 0; level < set.levels(); ++level)
        set.level_nodes(column, row, level);
    }
}

} // namespace haarlight::fuzzing
