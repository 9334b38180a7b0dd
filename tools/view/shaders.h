#pragma once
// The .glsl files of this folder, as GLSL ES 3.00.

#include <string>

namespace haarlight::view {

/// One triangle over the whole image.
std::string covering_vertex_shader();

/// lamp.glsl and what it rests on.
std::string lamp_fragment_shader();

} // namespace haarlight::view
