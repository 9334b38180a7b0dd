#pragma once
// The part of the page that compares the trees with the maps they were made of.

#include <support/compare.h>

#include <string>

namespace haarlight::info {

/// How far the set lies from the reference, and the maps that differ most: original,
/// reconstruction and difference.
/// @param input the reference, the .haar file and, if only one map is asked for, its column and row
/// @throws as tool::open_compared()
std::string worst_maps_html(const tool::CompareInput& input);

} // namespace haarlight::info
