#pragma once
// A scene, its trees and the shaders as one HTML file that needs nothing else but a browser.

#include <view/frame.h>
#include <view/view_scene.h>

#include <optional>
#include <string>
#include <vector>

namespace haarlight::view {

/// What the page shows at first, and says.
struct PageOptions {
  std::string title;
  std::string provenance;
  renderer::SceneDescription film; ///< its camera and size, and whether the light is seen
  Lamp lamp;
  std::optional<PackedLight> light; ///< with which it also has Lighting::Environment
  Eigen::Matrix3f to_world = Eigen::Matrix3f::Identity(); ///< from the light's frame
  int level = automatic_level;
  float tolerance = environment_tolerance;
  double exposure = 0;          ///< stops
  std::vector<float> reference; ///< RGB that the page's #check compares with, or nothing
};

/// HTML with WebGL 2, everything within. Lighting is by the environment if there is one.
/// @throws Error(Output) if there are 2^28 nodes or more
std::string view_page(const ViewScene& scene, const PageOptions& options);

} // namespace haarlight::view
