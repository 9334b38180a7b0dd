#pragma once
// The files of this folder that are not C++. Shaders are in what GLSL ES 3.00 and GLSL 3.30 have in
// common, without the line that says which of them it is.

#include <string>

namespace haarlight::view {

/// One triangle over the whole image.
std::string covering_vertex_shader();

/// lamp.glsl and what it rests on.
std::string lamp_fragment_shader();

/// environment.glsl and what it rests on.
std::string environment_fragment_shader();

/// relight.glsl and what it rests on.
std::string relight_fragment_shader();

/// show.glsl and what it rests on.
std::string show_fragment_shader();

/// page.html, with marks where the others go, and the scripts.
std::string page_html();
std::string page_script();

} // namespace haarlight::view
