#pragma once
// The GLSL, HTML, CSS and JavaScript files of this folder as text. Shaders are written in the
// common subset of GLSL ES 3.00 and GLSL 3.30, without the #version line.

#include <string>

namespace haarlight::view {

/// The vertex shader of a triangle that covers the image.
std::string full_screen_shader();

// Fragment shaders, each with the files it includes.
std::string punctual_shader();    ///< punctual.glsl
std::string environment_shader(); ///< environment.glsl
std::string relight_shader();     ///< relight.glsl
std::string tone_map_shader();    ///< tone_map.glsl

std::string page_body();   ///< page.html, with a mark where the scene goes
std::string page_style();  ///< page.css
std::string page_script(); ///< page.js

} // namespace haarlight::view
