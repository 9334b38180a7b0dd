#pragma once
// The same picture without GL: what frames are held against.

#include <view/view_scene.h>

#include <vector>

namespace haarlight::view {

/// RGB of all pixels, top row first: reflectance from the same trees at their full level, one ray
/// through the centre of each pixel.
std::vector<float> cpu_frame(const ViewScene& scene, const Lamp& lamp, int width, int height);

/// The same under the scene's distant light, by product integrals of visibilities of 128 squares a
/// side; black where there is no object. @throws Error(Input) if a file is broken
std::vector<float> cpu_environment_frame(const renderer::SceneDescription& scene, int width,
                                         int height);

/// Root mean square of the difference over that of the reference; 0 for two black pictures.
double relative_rms(const std::vector<float>& frame, const std::vector<float>& reference);

} // namespace haarlight::view
