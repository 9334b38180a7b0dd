#include <bench/session.h>

#include <algorithm>
#include <ctime>
#include <limits>

namespace haarlight::bench {

using namespace renderer;

namespace {

std::vector<std::size_t> hit_pixels(const Film& film) {
  std::vector<std::size_t> pixels;
  for (std::size_t i = 0; i < film.count(); ++i)
    if (film.samples[i] > 0)
      pixels.push_back(i);
  return pixels;
}

Pixels luminances_of(const Film& film, const std::vector<std::size_t>& pixels) {
  Pixels result;
  result.reserve(pixels.size());
  for (const std::size_t i : pixels)
    result.push_back(static_cast<double>(luminance(film.color(i))));
  return result;
}

void add(const std::vector<float>& rgb, float share, Image& mean) {
  for (std::size_t i = 0; i < rgb.size(); ++i)
    mean.rgb[i] += share * rgb[i];
}

void add_variances(const Film& film, const std::vector<std::size_t>& pixels, double share,
                   Pixels& variances) {
  variances.resize(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i)
    variances[i] += share * static_cast<double>(film.variance[pixels[i]]);
}

} // namespace

std::vector<double> seconds_of(const std::vector<Runs>& all) {
  std::vector<double> seconds;
  seconds.reserve(all.size());
  for (const Runs& runs : all)
    seconds.push_back(runs.seconds);
  return seconds;
}

Session::Session(const SceneDescription& description, const RenderOptions& options)
    : m_options(options),
      m_scene(std::make_unique<LoadedScene>(description, SourceLookups{}, options.sampler,
                                            needs_unshadowed(options.estimator))) {
  const std::clock_t start = std::clock();
  m_factories = std::make_unique<RenderFactories>(*m_scene, m_options);
  m_setup_seconds = m_scene->preparation_seconds() +
                    static_cast<double>(std::clock() - start) / static_cast<double>(CLOCKS_PER_SEC);
}

Runs Session::run(Points points, int spp, std::uint32_t seed, int count) const {
  Runs result;
  result.spp = spp;
  result.seconds = std::numeric_limits<double>::infinity();
  RenderOptions options = m_options;
  options.points = points;
  options.spp = spp;
  const SceneDescription& scene = m_scene->description();
  result.first = Image(scene.width, scene.height);
  result.mean = result.first;
  for (int k = 0; k < count; ++k) {
    options.seed = seed + static_cast<std::uint32_t>(k);
    const RenderResult rendered =
        render(*m_scene, *m_factories, options, scene.width, scene.height);
    if (k == 0) {
      result.pixels = hit_pixels(rendered.film);
      result.first.rgb = rendered.film.rgb;
    }
    add(rendered.film.rgb, 1.0F / static_cast<float>(count), result.mean);
    result.luminances.push_back(luminances_of(rendered.film, result.pixels));
    add_variances(rendered.film, result.pixels, 1.0 / count, result.variances);
    result.seconds = std::min(result.seconds, rendered.statistics.thread_seconds);
  }
  return result;
}

CostModel Session::cost(Points points, std::uint32_t seed, int count,
                        const std::vector<Runs>& all) const {
  CostModel cost;
  for (const Runs& runs : all)
    cost.add(runs.spp, runs.seconds);
  if (all.size() == 1) {
    const int pilot = all.front().spp > 1 ? std::max(1, all.front().spp / 8) : 8;
    cost.add(pilot, run(points, pilot, seed, count).seconds);
  }
  return cost;
}

Runs Session::run_within(double budget, Points points, std::uint32_t seed, int count,
                         CostModel& cost) const {
  constexpr int rounds = 3;
  constexpr int most_spp = 1 << 18;
  Runs runs;
  for (int round = 0; round < rounds; ++round) {
    const int spp = cost.affordable(budget, most_spp);
    if (spp == runs.spp)
      break;
    runs = run(points, spp, seed, count);
    cost.add(spp, runs.seconds);
  }
  return runs;
}

} // namespace haarlight::bench
