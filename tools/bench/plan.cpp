#include <bench/plan.h>

#include <support/words.h>

#include <wavelet/input_file.h>

#include <algorithm>
#include <set>

namespace haarlight::bench {

using namespace renderer;

namespace {

/// The words between commas, of all texts.
std::vector<std::string> split(const std::vector<std::string>& texts) {
  std::vector<std::string> words;
  for (const std::string& text : texts)
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      words.push_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
  return words;
}

template <class T>
void sort_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// A usage error names its option.
template <class Number>
std::vector<Number> numbers(const std::vector<std::string>& texts, const std::string& option,
                            double low, double high) {
  std::vector<Number> result;
  try {
    for (const std::string& word : split(texts))
      if constexpr (std::is_integral_v<Number>)
        result.push_back(static_cast<Number>(
            tool::integer_of(word, static_cast<int>(low), static_cast<int>(high))));
      else
        result.push_back(tool::number_of(word, low, high));
  } catch (const tool::UsageError& error) {
    throw tool::UsageError(option + ": " + error.what());
  }
  sort_unique(result);
  return result;
}

std::string known_samplers() {
  std::string list = "all";
  for (const SamplerTraits& sampler : samplers())
    list.append(", ").append(sampler.name);
  return list;
}

/// The samplers named, each once; `product` first, as the base.
std::vector<SamplerKind> chosen_samplers(const std::vector<std::string>& texts) {
  std::vector<SamplerKind> kinds;
  const auto add = [&](SamplerKind kind) {
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
      kinds.insert(kind == SamplerKind::Product ? kinds.begin() : kinds.end(), kind);
  };
  for (const std::string& word : split(texts)) {
    const auto kind = sampler_from_name(word);
    if (!kind && word != "all")
      throw tool::UsageError("--samplers: '" + word + "' is none of " + known_samplers());
    if (kind)
      add(*kind);
    for (const SamplerTraits& sampler : samplers())
      if (!kind)
        add(sampler.kind);
  }
  return kinds;
}

void require_distinct(const std::vector<std::string>& paths, const std::string& option) {
  if (paths.empty())
    throw tool::UsageError(option + " is required");
  std::set<std::string> names;
  for (const std::string& path : paths)
    if (path.empty() || !names.insert(stem_of(path)).second)
      throw tool::UsageError(option + ": '" + path + "' has no name of its own");
}

void declare_measurement(tool::Tool& app, Plan& plan) {
  app.text_list(plan.sampler_words, "--samplers", "NAME,...|all",
                "Samplers to compare; renderer/SAMPLERS.md tells of each [all that need no "
                "tables]");
  app.text_list(plan.spp_words, "--spp", "INT,...",
                "Samples per pixel of the comparison at equal samples [16,64,256]");
  app.text_list(plan.seconds_words, "--seconds", "NUM,...",
                "CPU seconds per film of the comparison at equal time [what the base sampler, "
                "product or else the first, takes for each --spp]");
  app.text_list(plan.scenes, "--scene", "sphere|spheres|FILE.json",
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
    if (sampler.claim == SamplerClaim::Unbiased && (sampler.needs & NeedsTables) == 0)
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

std::string stem_of(const std::string& path) {
  const std::string name = base_name(path);
  const std::size_t dot = name.rfind('.');
  return dot == 0 || dot == std::string::npos ? name : name.substr(0, dot);
}

void declare(tool::Tool& app, Plan& plan) {
  app.text_list(plan.brdfs, "--brdf", "X.binary", "MERL files, one or more");
  app.text_list(plan.probes, "--probe", "Y", "Light probes, one or more");
  app.output(plan.folder, "DIR",
             "Folder for results.json, results.csv, report.html and cache/; made if need be");
  declare_measurement(app, plan);
  declare_cache(app, plan.cache);
  app.offer_json();
}

void check(Plan& plan) {
  require_distinct(plan.brdfs, "--brdf");
  require_distinct(plan.probes, "--probe");
  if (plan.scenes.empty())
    plan.scenes = {"sphere"};
  require_distinct(plan.scenes, "--scene");
  if (plan.seed >= 1U << 30U)
    throw tool::UsageError("--seed: must be below 2^30");
  if (plan.sampler_words.empty())
    for (const SamplerTraits& sampler : samplers())
      if ((sampler.needs & NeedsTables) == 0)
        plan.sampler_words.emplace_back(sampler.name);
  plan.samplers = chosen_samplers(plan.sampler_words);
  for (const SamplerKind kind : plan.samplers)
    if (const auto problem = problem_of(kind, plan.render.estimator))
      throw tool::UsageError(*problem);
  if (plan.spp_words.empty())
    plan.spp_words = {"16,64,256"};
  plan.spps = numbers<int>(plan.spp_words, "--spp", 1, 1 << 18);
  plan.seconds = numbers<double>(plan.seconds_words, "--seconds", 1e-6, 1e6);
  if (plan.point_choice != PointChoice::Sobol)
    plan.points.push_back(Points::Random);
  if (plan.point_choice != PointChoice::Random)
    plan.points.push_back(Points::Sobol);
  check(plan.cache);
}

} // namespace haarlight::bench
