#pragma once
// Files that a window offers to show.

#include <string>
#include <vector>

namespace haarlight::view {

/// @param named     what was asked for comes first, as it is
/// @param neighbour a file; all θ_r-only BRDF sets of its folder that can be used in place follow
///                  by name, itself among them
std::vector<std::string> material_choices(const std::vector<std::string>& named,
                                          const std::string& neighbour);

/// @param named what was asked for comes first, as it is
/// @param neighbour a file; all lights' trees and .hdr images of its folder follow by name, itself
///                  among them
std::vector<std::string> light_choices(const std::vector<std::string>& named,
                                       const std::string& neighbour);

} // namespace haarlight::view
