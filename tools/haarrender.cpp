// haarrender: renders a scene lit by a light probe.
#include <render/film_output.h>
#include <support/arguments.h>
#include <support/output_size.h>
#include <support/progress.h>
#include <support/tool.h>

#include <renderer/film/render.h>
#include <renderer/path/path.h>
#include <renderer/scene/scene.h>
#include <renderer/visibility/product_integral.h>
#include <wavelet/base/memory.h>
#include <wavelet/file/output_file.h>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

enum class Integrator {
  Direct,         ///< direct light of the probe
  Path,           ///< global illumination
  ProductIntegral ///< direct light without samples
};

struct IntegratorOptions {
  Integrator kind = Integrator::Direct;
  PathOptions path;
  ProductIntegralOptions product_integral;
};

void declare_integrator(tool::Tool& app, IntegratorOptions& options) {
  app.choice(options.kind, "--integrator",
             {{"direct", Integrator::Direct},
              {"path", Integrator::Path},
              {"product-integral", Integrator::ProductIntegral}},
             "direct: direct light of the probe; path: global illumination, including emitters "
             "(renderer/PATH.md); product-integral: direct light as an integral without samples "
             "(renderer/PRODUCT_INTEGRAL.md)");
  app.choice(options.product_integral.levels, "--resolution",
             {{"32", 5}, {"64", 6}, {"128", 7}, {"256", 8}},
             "product-integral: finest squares along a side of the visibility maps");
  app.value(options.path.depth, "--depth",
            "path: maximum number of surface points per path; 1 = direct light only, 0 = unlimited",
            0, 1 << 20);
  app.value(options.path.light_samples, "--light-samples",
            "path: light samples at the first surface point of each path", 1, 1 << 10);
}

void declare_sampling(tool::Tool& app, RenderOptions& render) {
  std::vector<std::pair<std::string, SamplerKind>> kinds;
  for (const SamplerTraits& sampler : samplers())
    kinds.emplace_back(sampler.name, sampler.kind);
  app.choice(render.sampler, "--sampler", kinds,
             "Sampling strategy for light directions; renderer/SAMPLERS.md describes each");
  app.choice(render.estimator, "--estimator",
             {{"unbiased", Estimator::Unbiased},
              {"bidirectional", Estimator::Bidirectional},
              {"ratio", Estimator::Ratio}},
             "Estimator of the pixel's radiance from the samples");
  app.choice(render.points, "--points", {{"random", Points::Random}, {"sobol", Points::Sobol}},
             "Random numbers or Owen-scrambled Sobol points");
  app.value(render.spp, "--spp", "Samples per pixel; with --time-limit those of the first pass", 1,
            1 << 20);
  app.value(
      render.time_limit, "--time-limit",
      "Render passes for this many seconds; the result then depends on the machine; 0 = one pass",
      0, 1e6);
  app.value(render.sampling.product.variance_bound, "--product-variance",
            "Relative variance per sample at which refinement of a product stops; 0 = 0.12 / "
            "sqrt(spp), clamped to 0.002 to 0.1; three times that if there are possible occluders "
            "(product-visibility: six times); 0.001 for bidirectional and ratio",
            0, 100);
  app.value(render.sampling.product.max_leaves, "--product-leaves",
            "Maximum number of leaves of a product; product-visibility uses at most 25 per sample, "
            "or 400 in total if there are possible occluders",
            64, 1 << 20);
  app.value(render.sampling.product.reuse_variance_bound, "--product-drift",
            "Relative variance per sample that reuse of a neighbouring pixel's product may add; 0 "
            "= no reuse",
            0, 100);
  app.value(render.sampling.candidates, "--candidates",
            "bis-reject, bis-sir, ris: candidates per sample", 1, 4096);
  app.value(render.sampling.regions, "--regions", "two-stage: number of regions of the probe", 4,
            1 << 20);
  app.value(render.sampling.pps_samples, "--pps-samples",
            "pps: initial BRDF samples per shading point", 1, 4096);
}

/// Refuses options of sampling.
void check_sampleless(const tool::Tool& app) {
  for (const char* option : {"--estimator", "--spp", "--time-limit"})
    if (app.given(option))
      throw tool::UsageError(
          std::string(option) +
          ": not an option of --integrator product-integral, which takes no samples");
}

/// Refuses options of other integrators.
void check_integrator(const tool::Tool& app, const IntegratorOptions& options,
                      const RenderOptions& render) {
  if (options.kind == Integrator::Path && needs_unshadowed(render.estimator))
    throw tool::UsageError("--integrator path: needs --estimator unbiased");
  for (const char* own : {"--depth", "--light-samples"})
    if (options.kind != Integrator::Path && app.given(own))
      throw tool::UsageError(std::string(own).append(": needs --integrator path"));
  if (options.kind != Integrator::ProductIntegral && app.given("--resolution"))
    throw tool::UsageError("--resolution: needs --integrator product-integral");
  if (options.kind == Integrator::ProductIntegral)
    check_sampleless(app);
}

/// What the scene must provide for the integrator, of SamplerNeed.
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

/// Keys and values for the provenance.
std::vector<std::pair<std::string, std::string>> provenance_of(const IntegratorOptions& options) {
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

struct Options {
  std::string scene;
  std::string output;
  std::string image;
  std::string size;
  double exposure = 0;
  std::uint64_t seed = 0;
  SourceLookups lookups;
  RenderOptions render;
  IntegratorOptions integrator;
  bool force = false;
};

void declare(tool::Tool& app, Options& options) {
  app.input(options.scene, "SCENE.json", "Scene; renderer/SCENE.md documents the format");
  app.output(options.output, "OUT.exr",
             "Picture to write: R, G, B, normal, sum of pdfs, variance, number of samples");
  declare_integrator(app, options.integrator);
  declare_sampling(app, options.render);
  app.value(options.seed, "--seed", "Random seed, below 2^32");
  app.choice(options.lookups.brdf, "--brdf-lookup",
             {{"trilinear", brdf::Lookup::Trilinear}, {"nearest", brdf::Lookup::Nearest}},
             "Interpolation of measured BRDFs");
  app.choice(options.lookups.probe, "--probe-lookup",
             {{"nearest", probe::Lookup::Nearest}, {"bilinear", probe::Lookup::Bilinear}},
             "Interpolation of the probe");
  app.text(options.size, "--size", "WxH", "Size of the film in pixels [the scene's]");
  app.optional_output(options.image, "--image", "OUT.png", "Tone-mapped picture to write as well");
  app.value(options.exposure, "--exposure", "Exposure of --image, stops", -30, 30);
  tool::add_force(app, options.force);
  app.alias("--png", "--image");
  app.offer_json();
}

/// Throws before the work if the path cannot be written.
void require_writable(const std::string& path) { const OutputFile trial(path); }

/// Refuses contradictory options and unwritable outputs before any work is done.
void check(const tool::Tool& app, Options& options) {
  if (const auto problem = validate(options.render.sampler, options.render.estimator))
    throw tool::UsageError(*problem);
  check_integrator(app, options.integrator, options.render);
  if (options.seed > 0xFFFFFFFFU)
    throw tool::UsageError("--seed: must be below 2^32");
  options.render.seed = static_cast<std::uint32_t>(options.seed);
  if (tool::has_extension(options.image, ".exr"))
    throw tool::UsageError("--image: '" + options.image + "' is written as PNG; -o writes the EXR");
  require_writable(options.output);
  if (!options.image.empty())
    require_writable(options.image);
}

int render_scene(const tool::Tool& app, Options& options) {
  check(app, options);
  SceneDescription description = load_scene(options.scene);
  tool::check_sources(app, description);
  if (!options.size.empty())
    tool::set_film_size(options.size, description);
  tool::require_room(options.output, tool::film_size(description.width, description.height),
                     options.force);
  const LoadedScene scene = with_memory_for("the light and the materials of the scene", 0, [&] {
    return LoadedScene(description, options.lookups, options.render.sampler,
                       needs_unshadowed(options.render.estimator), needs_of(options.integrator));
  });
  if (!scene.light().note().empty())
    app.detail(scene.light().note());
  tool::ProgressBar bar(app, "rendering");
  const std::string film = "rendering a film of " + std::to_string(description.width) + " x " +
                           std::to_string(description.height) + " pixels";
  const RenderResult result = with_memory_for(film, 0, [&] {
    return render_by(options.integrator, scene, options.render, description.width,
                     description.height,
                     [&](double fraction) { bar(static_cast<int>(1000 * fraction), 1000); });
  });
  tool::write_film_exr(options.output, result, description, options.render,
                       provenance_of(options.integrator));
  if (!options.image.empty())
    tool::write_film_png(options.image, result.film, options.exposure);
  app.print(tool::describe(result));
  return tool::exit_ok;
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(argc, argv,
                           tool::command("haarrender",
                                         "Renders a scene of analytic shapes lit by a light probe.",
                                         declare, render_scene));
}
