#pragma once
// Output of rendered pictures, and files named by scenes.

#include <renderer/film/render.h>
#include <support/tool.h>
#include <wavelet/file/provenance.h>

#include <string>
#include <utility>
#include <vector>

namespace haarlight::tool {

/// Adds every file that a scene names, with its hash. @throws Error(Input)
void set_sources(const renderer::SceneDescription& scene, Provenance& provenance);

/// @throws UsageError if an output of the tool is a file that the scene names
void check_sources(const Tool& tool, const renderer::SceneDescription& scene);

/// Writes the film as EXR: R, G, B, the normal N.X N.Y N.Z, pdf_sum, variance, samples; the
/// attribute haarlight:provenance names scene, sources (each with its hash) and options,
/// `integrator` by key and value among them. @throws Error(Output)
void write_film_exr(const std::string& path, const renderer::RenderResult& result,
                    const renderer::SceneDescription& scene, const renderer::RenderOptions& options,
                    const std::vector<std::pair<std::string, std::string>>& integrator);

/// Writes the tone-mapped picture. @param exposure in stops. @throws Error(Output)
void write_film_png(const std::string& path, const renderer::Film& film, double exposure);

/// Size, cost and quality of a rendering.
Report describe(const renderer::RenderResult& result);

/// Sets the film size from a text as in 640x480. @throws UsageError
void set_film_size(const std::string& text, renderer::SceneDescription& scene);

} // namespace haarlight::tool
