#pragma once
// What a window offers to show.

#include <view/window.h>
#include <view/window_panel.h>
#include <view/window_side.h>

#include <renderer/scene/scene.h>

#include <vector>

namespace haarlight::view {

struct WindowChoices {
  std::vector<Subject> materials;                 ///< of the left picture, the first as it is given
  std::vector<Subject> others;                    ///< of the right picture, the first being none
  std::vector<renderer::LightDescription> lights; ///< the first is none: the lamp; then what is
                                                  ///< given, if anything is
};

/// What is given, and what lies in the same folders and can be shown: θ_r-only BRDF sets, lights'
/// trees and .hdr images.
/// @param light the scene's own
/// @throws Error(Input) if a file that is given cannot be read
WindowChoices choices_of(const WindowInput& input, const renderer::LightDescription& light);

/// Their names; nothing else is filled in.
PanelContents contents_of(const WindowChoices& choices);

} // namespace haarlight::view
