#pragma once
// What the pairs are rendered on.

#include <renderer/scene/scene.h>

#include <string>

namespace haarlight::bench {

/// `sphere`: orthographic, one unoccluded sphere that fills the film. `spheres`: in perspective,
/// three spheres that shade a plane and each other, all of one material, which every pixel hits.
/// Neither shows a background. Anything else is a scene file.
/// @throws Error(Input) as load_scene(), and for a file without materials
renderer::SceneDescription scene_of(const std::string& word);

/// What rows call it.
std::string scene_name(const std::string& word);

} // namespace haarlight::bench
