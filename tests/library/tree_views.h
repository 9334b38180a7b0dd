#pragma once
// Trees of tests as views.

#include <wavelet/tree/tree.h>

#include <vector>

/// @param trees must outlive the views
inline std::vector<haarlight::wavelet::TreeView>
views_of(const std::vector<haarlight::wavelet::Tree>& trees) {
  std::vector<haarlight::wavelet::TreeView> views;
  for (const haarlight::wavelet::Tree& tree : trees)
    views.push_back(tree.view());
  return views;
}
