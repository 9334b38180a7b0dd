#include <render/integrator.h>

namespace haarlight::tool {

using namespace renderer;

void declare_integrator(Tool& app, IntegratorOptions& options) {
  app.choice(options.kind, "--integrator",
             {{"direct", Integrator::Direct}, {"path", Integrator::Path}},
             "Which light: direct, from the probe alone; or path, by every way, from what shines "
             "too. renderer/PATH.md tells of paths");
  app.value(options.path.depth, "--depth",
            "Of path: surface points on a path that are lit, at most; 1 = direct light only, 0 = "
            "as many as there are",
            0, 1 << 20);
  app.value(options.path.light_samples, "--light-samples",
            "Of path: samples of light at the first of these points, for each of --spp paths", 1,
            1 << 10);
}

void check_integrator(const Tool& app, const IntegratorOptions& options,
                      const RenderOptions& render) {
  if (options.kind == Integrator::Path && needs_unshadowed(render.estimator))
    throw UsageError("--integrator path: goes with --estimator unbiased alone");
  for (const char* own : {"--depth", "--light-samples"})
    if (options.kind != Integrator::Path && app.given(own))
      throw UsageError(std::string(own).append(": is of --integrator path"));
}

unsigned needs_of(const IntegratorOptions& options) {
  return options.kind == Integrator::Path ? path_needs : NeedsNothing;
}

std::vector<std::pair<std::string, std::string>> texts_of(const IntegratorOptions& options) {
  if (options.kind == Integrator::Path)
    return {{"integrator", "path"},
            {"depth", std::to_string(options.path.depth)},
            {"light samples", std::to_string(options.path.light_samples)}};
  return {{"integrator", "direct"}};
}

RenderResult render_by(const IntegratorOptions& options, const LoadedScene& scene,
                       const RenderOptions& render, int width, int height,
                       const RenderProgress& progress) {
  if (options.kind == Integrator::Path)
    return render_paths(scene, render, options.path, width, height, progress);
  return renderer::render(scene, render, width, height, progress);
}

} // namespace haarlight::tool
