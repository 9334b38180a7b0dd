#include <render/integrator.h>

namespace haarlight::tool {

using namespace renderer;

void declare_integrator(Tool& app, IntegratorOptions& options) {
  app.choice(options.kind, "--integrator",
             {{"direct", Integrator::Direct},
              {"path", Integrator::Path},
              {"product-integral", Integrator::ProductIntegral}},
             "Which light: direct, from the probe alone; path, by every way, from what shines "
             "too; or product-integral, direct without samples. renderer/PATH.md and "
             "renderer/PRODUCT_INTEGRAL.md tell of these");
  app.choice(options.product_integral.levels, "--resolution",
             {{"32", 5}, {"64", 6}, {"128", 7}, {"256", 8}},
             "Of product-integral: finest squares along the side of the visibilities' maps");
  app.value(options.path.depth, "--depth",
            "Of path: surface points on a path that are lit, at most; 1 = direct light only, 0 = "
            "as many as there are",
            0, 1 << 20);
  app.value(options.path.light_samples, "--light-samples",
            "Of path: samples of light at the first of these points, for each of --spp paths", 1,
            1 << 10);
}

namespace {

/// @throws UsageError for what only samples know
void check_sampleless(const Tool& app) {
  for (const char* option : {"--estimator", "--spp", "--time-limit"})
    if (app.given(option))
      throw UsageError(std::string(option) + ": --integrator product-integral takes no samples");
}

} // namespace

void check_integrator(const Tool& app, const IntegratorOptions& options,
                      const RenderOptions& render) {
  if (options.kind == Integrator::Path && needs_unshadowed(render.estimator))
    throw UsageError("--integrator path: goes with --estimator unbiased alone");
  for (const char* own : {"--depth", "--light-samples"})
    if (options.kind != Integrator::Path && app.given(own))
      throw UsageError(std::string(own).append(": is of --integrator path"));
  if (options.kind != Integrator::ProductIntegral && app.given("--resolution"))
    throw UsageError("--resolution: is of --integrator product-integral");
  if (options.kind == Integrator::ProductIntegral)
    check_sampleless(app);
}

unsigned needs_of(const IntegratorOptions& options) {
  switch (options.kind) {
  case Integrator::Path:
    return path_needs;
  case Integrator::ProductIntegral:
    return product_integral_needs;
  default:
    return NeedsNothing;
  }
}

std::vector<std::pair<std::string, std::string>> texts_of(const IntegratorOptions& options) {
  if (options.kind == Integrator::Path)
    return {{"integrator", "path"},
            {"depth", std::to_string(options.path.depth)},
            {"light samples", std::to_string(options.path.light_samples)}};
  if (options.kind == Integrator::ProductIntegral)
    return {{"integrator", "product-integral"},
            {"resolution", std::to_string(1 << options.product_integral.levels)}};
  return {{"integrator", "direct"}};
}

RenderResult render_by(const IntegratorOptions& options, const LoadedScene& scene,
                       const RenderOptions& render, int width, int height,
                       const RenderProgress& progress) {
  if (options.kind == Integrator::Path)
    return render_paths(scene, render, options.path, width, height, progress);
  if (options.kind == Integrator::ProductIntegral)
    return render_product_integral(scene, options.product_integral, width, height, progress);
  return renderer::render(scene, render, width, height, progress);
}

} // namespace haarlight::tool
