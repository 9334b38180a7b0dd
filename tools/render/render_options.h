#pragma once
// The command line of haarrender, as far as it says how a scene is rendered.

#include <renderer/film/render.h>
#include <support/tool.h>

namespace haarlight::tool {

/// Which sampler, estimator and points, how many samples, and what each sampler may be told.
/// `render` holds the defaults and receives what is given.
void declare_sampling(Tool& app, renderer::RenderOptions& render);

} // namespace haarlight::tool
