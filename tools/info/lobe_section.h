#pragma once
// The part of the page that looks at the lobes of a BRDF set.

#include <wavelet/file/tree_set.h>

#include <string>
#include <vector>

namespace haarlight::info {

/// Slices and a polar plot; nothing for sets of another kind.
std::string lobes_html(const wavelet::TreeSet& set, const std::vector<wavelet::MapPlace>& trees);

} // namespace haarlight::info
