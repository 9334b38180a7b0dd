#pragma once
// A scene, its trees and the shaders as one HTML file for a browser with WebGL 2.

#include <view/frame.h>

#include <string>
#include <vector>

namespace haarlight::view {

struct PageOptions {
  std::string title;
  std::string provenance;
  ViewState state;              ///< the initial view; the page offers an environment if it has one
  double exposure = 0;          ///< stops
  std::vector<float> reference; ///< RGB that the page's #check compares with, or empty
};

/// The name of a format in page.js.
const char* texel_format_name(TexelFormat format);

/// The whole page, which needs no other file and no network.
/// @throws Error(Output) if the scene has 2^28 nodes or more
std::string view_page(const ViewScene& scene, const PageOptions& options);

} // namespace haarlight::view
