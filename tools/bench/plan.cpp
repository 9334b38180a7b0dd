#include <bench/plan.h>

#include <support/words.h>

#include <wavelet/file/input_file.h>

#include <algorithm>
#include <numeric>
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
      throw tool::UsageError(
          std::string(option).append(": '").append(path).append("' has no name of its own"));
}

} // namespace

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
  if (plan.sampler_words.empty())
    for (const SamplerTraits& sampler : samplers())
      if ((sampler.needs & NeedsTables) == 0)
        plan.sampler_words.emplace_back(sampler.name);
  plan.samplers = chosen_samplers(plan.sampler_words);
  for (const SamplerKind kind : plan.samplers)
    if (const auto problem = validate(kind, plan.render.estimator))
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
