// The command line of haarbench.
#include <bench/plan.h>

namespace haarlight::bench {

using namespace renderer;

namespace {

void declare_measurement(tool::Tool& app, Plan& plan) {
  app.text_list(plan.sampler_words, "--samplers", "NAME,...|all",
                "Samplers to compare; renderer/SAMPLERS.md tells of each [all that need no "
                "tables]");
  app.text_list(plan.spp_words, "--spp", "INT,...",
                "Samples per pixel of the comparison at equal samples [16,64,256]");
  app.text_list(plan.seconds_words, "--seconds", "NUM,...",
                "CPU seconds per film of the comparison at equal time [what the base sampler, "
                "product or else the first, takes for each --spp]");
  app.optional_inputs(
      plan.scenes, "--scene", "sphere|spheres|FILE.json",
      "Unoccluded sphere; three spheres on a plane, all of the BRDF; or a scene whose "
      "light and first material are replaced [sphere]");
  app.text(plan.size, "--size", "WxH", "Size of the film in pixels");
  app.value(plan.seeds, "--seeds", "Runs that differ in their seed, for each figure", 2, 1000);
  app.value(plan.seed, "--seed", "First seed, below 2^30");
  app.choice(
      plan.point_choice, "--points",
      {{"random", PointChoice::Random}, {"sobol", PointChoice::Sobol}, {"both", PointChoice::Both}},
      "Random numbers, Owen-scrambled Sobol points, or one after the other");
  app.choice(plan.render.estimator, "--estimator",
             {{"unbiased", Estimator::Unbiased},
              {"bidirectional", Estimator::Bidirectional},
              {"ratio", Estimator::Ratio}},
             "How samples become radiance; the reference is always unbiased");
  app.value(plan.reference_spp, "--reference-spp",
            "Samples per pixel of the reference, over 8 independent runs", 16, 1 << 20);
  std::vector<std::pair<std::string, SamplerKind>> kinds;
  for (const SamplerTraits& sampler : samplers())
    if (sampler.bias == Bias::Unbiased && (sampler.needs & NeedsTables) == 0)
      kinds.emplace_back(sampler.name, sampler.kind);
  app.choice(plan.reference_sampler, "--reference-sampler", kinds, "What the reference draws from");
}

void declare_cache(tool::Tool& app, CacheOptions& cache) {
  app.value(cache.brdf_size, "--brdf-size", "Pixels along a BRDF map's side; 0 = 512", 0, 8192);
  app.value(cache.theta, "--theta", "Cells of theta_r of the BRDF's maps", 1, 4096);
  app.value(cache.probe_size, "--probe-size",
            "Pixels along the side of the probe's map; 0 = 512 to 2048, losing nothing", 0, 8192);
  app.value(cache.table_size, "--table-size", "Pixels along the side of the maps of tables", 4,
            1024);
  app.value(cache.rolls, "--roll", "Cells of the roll of BRDF tables", 2, 4096);
  app.value(cache.orientations, "--orientations", "M: probe tables hold M x M mirror directions", 2,
            1024);
}

} // namespace

void declare(tool::Tool& app, Plan& plan) {
  app.optional_inputs(plan.brdfs, "--brdf", "X.binary", "MERL files, one or more");
  app.optional_inputs(plan.probes, "--probe", "Y", "Light probes, one or more");
  app.output(plan.folder, "DIR",
             "Folder for results.json, results.csv, report.html and cache/; made if need be",
             tool::Stream::No);
  declare_measurement(app, plan);
  declare_cache(app, plan.cache);
  app.offer_json();
}

} // namespace haarlight::bench
