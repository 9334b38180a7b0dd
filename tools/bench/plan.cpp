#include <bench/plan.h>

#include <wavelet/file/input_file.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace haarlight::bench {

using namespace renderer;

namespace {

void declare_measurement(tool::Tool& app, Plan& plan) {
  std::vector<std::pair<std::string, SamplerKind>> all;
  std::vector<std::pair<std::string, SamplerKind>> references;
  for (const SamplerTraits& sampler : samplers()) {
    all.emplace_back(sampler.name, sampler.kind);
    if (sampler.bias == Bias::Unbiased && (sampler.needs & NeedsTables) == 0)
      references.emplace_back(sampler.name, sampler.kind);
  }
  app.choices(plan.samplers, "--samplers", all,
              "Samplers to compare; renderer/SAMPLERS.md describes each [all that need no tables]");
  app.list(plan.spps, "--spp", "Samples per pixel of the comparison at equal samples", 1, 1 << 18);
  app.list(plan.seconds, "--seconds",
           "CPU seconds per picture of the comparison at equal time [the time of the base sampler, "
           "product or else the first, at each --spp]",
           1e-6, 1e6);
  app.optional_inputs(plan.scenes, "--scene", "sphere|spheres|FILE.json",
                      "Scene: an unoccluded sphere; three spheres on a plane, all of the BRDF; or "
                      "a file whose light and first material are replaced [sphere]");
  app.text(plan.size, "--size", "WxH", "Size of the film in pixels");
  app.value(plan.seeds, "--seeds", "Number of runs per figure, which differ in their seed", 2,
            1000);
  app.value(plan.seed, "--seed", "First seed, below 2^30");
  app.choice(
      plan.point_choice, "--points",
      {{"random", PointChoice::Random}, {"sobol", PointChoice::Sobol}, {"both", PointChoice::Both}},
      "Random numbers, Owen-scrambled Sobol points, or both in turn");
  app.choice(
      plan.render.estimator, "--estimator",
      {{"unbiased", Estimator::Unbiased},
       {"bidirectional", Estimator::Bidirectional},
       {"ratio", Estimator::Ratio}},
      "Estimator of the pixel's radiance from the samples; the reference is always unbiased");
  app.value(plan.reference_spp, "--reference-spp",
            "Samples per pixel of the reference, in 8 independent runs", 16, 1 << 20);
  app.choice(plan.reference_sampler, "--reference-sampler", references, "Sampler of the reference");
}

void declare_cache(tool::Tool& app, CacheOptions& cache) {
  app.value(cache.brdf_size, "--brdf-size",
            "Pixels along a side of the BRDF's maps, a power of two; 0 = 512", 0, 8192);
  app.value(cache.theta, "--theta",
            "Number of cells of theta_r of the BRDF's maps, over 90 degrees", 1, 4096);
  app.value(cache.probe_size, "--probe-size",
            "Pixels along a side of the probe's map, a power of two; 0 = from 512 to 2048 as the "
            "probe's resolution requires",
            0, 8192);
  app.value(cache.table_size, "--table-size",
            "Pixels along a side of the maps of tables, a power of two", 4, 1024);
  app.value(cache.rolls, "--roll", "Number of cells of the roll of BRDF tables, over 360 degrees",
            2, 4096);
  app.value(cache.orientations, "--orientations", "M: probe tables hold M x M mirror directions", 2,
            1024);
}

template <class T>
void sort_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// Each sampler once; `product` first, as the base.
std::vector<SamplerKind> distinct(const std::vector<SamplerKind>& samplers) {
  std::vector<SamplerKind> kinds;
  for (const SamplerKind kind : samplers)
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
      kinds.insert(kind == SamplerKind::Product ? kinds.begin() : kinds.end(), kind);
  return kinds;
}

void require_distinct(const std::vector<std::string>& paths, const std::string& option) {
  if (paths.empty())
    throw tool::UsageError(option + " is required");
  std::set<std::string> names;
  for (const std::string& path : paths)
    if (path.empty() || !names.insert(stem_of(path)).second)
      throw tool::UsageError(std::string(option).append(": '").append(path).append(
          "' does not have a name of its own"));
}

} // namespace

void declare(tool::Tool& app, Plan& plan) {
  app.optional_inputs(plan.brdfs, "--brdf", "X.binary", "MERL files to compare on, one or more");
  app.optional_inputs(plan.probes, "--probe", "Y", "Light probes to compare on, one or more");
  app.output(plan.folder, "DIR",
             "Folder for results.json, results.csv, report.html and cache/; created if missing",
             tool::Stream::No);
  declare_measurement(app, plan);
  declare_cache(app, plan.cache);
  app.offer_json();
}

std::string stem_of(const std::string& path) {
  const std::string name = base_name(path);
  const std::size_t dot = name.rfind('.');
  return dot == 0 || dot == std::string::npos ? name : name.substr(0, dot);
}

void check(Plan& plan) {
  require_distinct(plan.brdfs, "--brdf");
  require_distinct(plan.probes, "--probe");
  if (plan.scenes.empty())
    plan.scenes = {"sphere"};
  require_distinct(plan.scenes, "--scene");
  if (plan.seed >= 1U << 30U)
    throw tool::UsageError("--seed: must be below 2^30");
  if (plan.samplers.empty())
    for (const SamplerTraits& sampler : samplers())
      if ((sampler.needs & NeedsTables) == 0)
        plan.samplers.push_back(sampler.kind);
  plan.samplers = distinct(plan.samplers);
  for (const SamplerKind kind : plan.samplers)
    if (const auto problem = validate(kind, plan.render.estimator))
      throw tool::UsageError(*problem);
  sort_unique(plan.spps);
  sort_unique(plan.seconds);
  if (plan.point_choice != PointChoice::Sobol)
    plan.points.push_back(Points::Random);
  if (plan.point_choice != PointChoice::Random)
    plan.points.push_back(Points::Sobol);
  check(plan.cache);
}

double work_units(const Plan& plan) {
  const int samples = std::accumulate(plan.spps.begin(), plan.spps.end(), 0);
  const auto budgets = plan.seconds.empty() ? 1.0
                                            : static_cast<double>(plan.seconds.size()) /
                                                  static_cast<double>(plan.spps.size());
  return plan.reference_spp + (1 + budgets) * samples * plan.seeds *
                                  static_cast<double>(plan.samplers.size()) *
                                  static_cast<double>(plan.points.size());
}

} // namespace haarlight::bench
