// haarrender: renders a scene lit by a probe.
#include <render/film_output.h>
#include <render/integrator.h>
#include <render/render_options.h>
#include <support/output_size.h>
#include <support/program.h>
#include <support/progress.h>

#include <renderer/film/render.h>
#include <renderer/scene/scene.h>
#include <wavelet/base/memory.h>
#include <wavelet/file/output_file.h>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

struct Options {
  std::string scene;
  std::string output;
  std::string png;
  std::string size;
  double exposure = 0;
  std::uint64_t seed = 0;
  SourceLookups lookups;
  RenderOptions render;
  tool::IntegratorOptions integrator;
  bool force = false;
};

void declare(tool::Tool& app, Options& options) {
  app.input(options.scene, "SCENE.json", "Scene; renderer/SCENE.md documents the format");
  app.output(options.output, "OUT.exr", "Picture to write: R, G, B and further channels");
  tool::declare_integrator(app, options.integrator);
  tool::declare_sampling(app, options.render);
  app.value(options.seed, "--seed", "Tells random point sets apart, below 2^32");
  app.choice(options.lookups.brdf, "--brdf-lookup",
             {{"trilinear", brdf::Lookup::Trilinear}, {"nearest", brdf::Lookup::Nearest}},
             "How measured BRDFs are looked up");
  app.choice(options.lookups.probe, "--probe-lookup",
             {{"nearest", probe::Lookup::Nearest}, {"bilinear", probe::Lookup::Bilinear}},
             "How the probe is looked up");
  app.text(options.size, "--size", "WxH", "Size of the film in pixels, in place of the scene's");
  app.optional_output(options.png, "--png", "OUT.png", "Write a tone-mapped preview too");
  app.value(options.exposure, "--exposure", "Stops that the preview is brightened by", -30, 30);
  tool::add_force(app, options.force);
  app.offer_json();
}

/// Throws now rather than after the work if nothing can be written there.
void require_writable(const std::string& path) { const OutputFile trial(path); }

/// Refuses contradictions and unwritable outputs before any work is done.
void check(const tool::Tool& app, Options& options) {
  if (const auto problem = validate(options.render.sampler, options.render.estimator))
    throw tool::UsageError(*problem);
  tool::check_integrator(app, options.integrator, options.render);
  if (options.seed > 0xFFFFFFFFU)
    throw tool::UsageError("--seed: must be below 2^32");
  options.render.seed = static_cast<std::uint32_t>(options.seed);
  require_writable(options.output);
  if (!options.png.empty())
    require_writable(options.png);
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
                       needs_unshadowed(options.render.estimator),
                       tool::needs_of(options.integrator));
  });
  if (!scene.light().note().empty())
    app.detail(scene.light().note());
  tool::ProgressBar bar(app, "rendering");
  const std::string film = "rendering a film of " + std::to_string(description.width) + " x " +
                           std::to_string(description.height) + " pixels";
  const RenderResult result = with_memory_for(film, 0, [&] {
    return tool::render_by(options.integrator, scene, options.render, description.width,
                           description.height,
                           [&](double fraction) { bar(static_cast<int>(1000 * fraction), 1000); });
  });
  tool::write_film_exr(options.output, result, description, options.render,
                       tool::texts_of(options.integrator));
  if (!options.png.empty())
    tool::write_film_png(options.png, result.film, options.exposure);
  app.print(tool::describe(result));
  return tool::exit_ok;
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(argc, argv, "haarrender",
                           "Renders a scene of analytic shapes lit by a probe.", declare,
                           render_scene);
}
