#pragma once
// Which light haarrender follows, and what each way of doing so may be told.

#include <renderer/path/path.h>
#include <renderer/visibility/product_integral.h>
#include <support/tool.h>

#include <string>
#include <utility>
#include <vector>

namespace haarlight::tool {

enum class Integrator {
  Direct,         ///< from the distant light straight to what is seen
  Path,           ///< all of it, by paths
  ProductIntegral ///< as Direct, without samples
};

struct IntegratorOptions {
  Integrator kind = Integrator::Direct;
  renderer::PathOptions path;
  renderer::ProductIntegralOptions product_integral;
};

/// `options` holds the defaults and receives what is given.
void declare_integrator(Tool& app, IntegratorOptions& options);

/// @throws UsageError for what the integrator cannot be told
void check_integrator(const Tool& app, const IntegratorOptions& options,
                      const renderer::RenderOptions& render);

/// What the scene has to be loaded with, besides the sampler's: of SamplerNeed.
unsigned needs_of(const IntegratorOptions& options);

/// Key and value for provenance.
std::vector<std::pair<std::string, std::string>> texts_of(const IntegratorOptions& options);

renderer::RenderResult render_by(const IntegratorOptions& options,
                                 const renderer::LoadedScene& scene,
                                 const renderer::RenderOptions& render, int width, int height,
                                 const renderer::RenderProgress& progress);

} // namespace haarlight::tool
