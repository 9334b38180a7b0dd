#include <renderer/path/path.h>

#include "film/film_rendering.h"
#include "light/light_samples.h"
#include "path/path_tracer.h"

#include <algorithm>
#include <optional>

namespace haarlight::renderer {
namespace {

bool shines(const LoadedScene& scene) {
  return std::ranges::any_of(scene.materials(),
                             [](const Material& m) { return (m.emission() > 0).any(); });
}

/// Light that comes by any way.
class PathShader : public PixelShader {
public:
  PathShader(const LoadedScene& scene, const RenderOptions& options, const PathOptions& path,
             const RenderFactories& factories, const Emitters& emitters)
      : m_scene(scene), m_options(options), m_path(path), m_shines(shines(scene)),
        m_vertex(scene, emitters), m_tracer(scene, emitters, path) {
    m_counts.lights = path.light_samples;
    if (options.sampler == SamplerKind::Mis) {
      m_counts.departures = path.light_samples;
      return;
    }
    m_counts.shares_distant = false;
    m_light.emplace(scene, m_options, factories);
  }

  void forget() override {
    if (m_light)
      m_light->forget();
  }

  void shade(const PixelHit& seen, const Pass& pass, PixelSums& sums) override {
    const PathPoints points = {m_options.points, hash_words(seen.pixel, m_options.seed)};
    m_values.assign(pass.count, Rgb::Zero());
    m_pdfs.assign(pass.count, 0);
    m_vertex.arrive(seen.hit, seen.wo, m_counts);
    SumVariance variance = add_light(seen, pass, points);
    m_rest.resize(pass.count); // the light's samples are counted by themselves
    for (std::size_t i = 0; i < pass.count; ++i)
      m_rest[i].luminance = m_light ? -static_cast<double>(luminance(m_values[i])) : 0;
    m_vertex.add_emitters(points.at(1, pass.first), m_values);
    if (goes_on(seen.hit.object))
      add_departures(pass, points);
    for (std::size_t i = 0; i < pass.count; ++i) {
      sums.add(m_values[i], true, m_pdfs[i]);
      m_rest[i].luminance += static_cast<double>(luminance(m_values[i]));
      m_rest[i].visible = true;
    }
    variance += variance_of_sums(m_rest);
    sums.add_variance(variance, pass.count);
  }

private:
  /// Whether departures find anything that has not been counted already.
  bool goes_on(int object) const {
    return !m_light || ((m_path.depth != 1 || m_shines) && m_scene.shapes().may_occlude(object));
  }

  /// @return the variance of the light samples' sum, which is independent of all else; 0 without
  /// these
  SumVariance add_light(const PixelHit& seen, const Pass& pass, const PathPoints& points) {
    if (!m_light) {
      m_vertex.add_light(points.at(1, pass.first), m_values);
      ++m_cost.points;
      return {};
    }
    const auto each = static_cast<std::uint32_t>(m_counts.lights);
    m_light->prepare(seen, m_cost);
    m_light->sample({pass.first * each, pass.count * each});
    m_contributions.resize(m_values.size() * each);
    for (std::size_t i = 0; i < m_contributions.size(); ++i) {
      m_pdfs[i / each] += m_light->pdf(i) / static_cast<float>(each);
      const Rgb weight = m_light->weight(i);
      const bool visible = m_light->visible(i);
      m_contributions[i] = m_light->contribution(i, weight, visible);
      if (visible)
        m_values[i / each] += weight / static_cast<float>(each);
    }
    SumVariance variance = m_light->variance_of_sums(m_contributions);
    variance *= 1.0 / (each * each);
    return variance;
  }

  /// All departures look for light; one of each path's goes on.
  void add_departures(const Pass& pass, const PathPoints& points) {
    const auto each = static_cast<std::size_t>(m_counts.departures);
    m_departures.resize(pass.count * each);
    m_vertex.depart(points.at(1, pass.first), m_departures);
    for (std::size_t i = 0; i < m_departures.size(); ++i) {
      const Departure& departure = m_departures[i];
      if (!(departure.weight > 0).any())
        continue;
      const Found found = m_vertex.look(departure);
      m_values[i / each] += departure.weight * found.light / static_cast<float>(each);
      if (i % each == 0 && found.hit)
        m_values[i / each] += m_tracer.follow(*found.hit, departure, points,
                                              pass.first + static_cast<std::uint32_t>(i / each));
    }
  }

  const LoadedScene& m_scene;
  const RenderOptions& m_options;
  PathOptions m_path;
  bool m_shines;
  VertexCounts m_counts;               ///< of the first vertex
  std::optional<LightSamples> m_light; ///< none: by the first vertex itself
  PathVertex m_vertex;                 ///< the first
  PathTracer m_tracer;
  std::vector<Rgb> m_values;                 ///< radiance by path
  std::vector<float> m_pdfs;                 ///< mean of its light samples'
  std::vector<Contribution> m_contributions; ///< of all light samples
  std::vector<Contribution> m_rest;          ///< of all else, by path
  std::vector<Departure> m_departures;
};

} // namespace

RenderResult render_paths(const LoadedScene& scene, const RenderFactories& factories,
                          const RenderOptions& options, const PathOptions& path, int width,
                          int height, const RenderProgress& progress) {
  RenderOptions unbiased = options;
  unbiased.estimator = Estimator::Unbiased;
  const Emitters emitters(scene.description());
  const auto make = [&] {
    return std::make_unique<PathShader>(scene, unbiased, path, factories, emitters);
  };
  return render_film(scene, unbiased, make, width, height, progress);
}

RenderResult render_paths(const LoadedScene& scene, const RenderOptions& options,
                          const PathOptions& path, int width, int height,
                          const RenderProgress& progress) {
  RenderOptions counted = options; // samplers are told how many light samples to expect
  counted.spp *= path.light_samples;
  return render_paths(scene, RenderFactories(scene, counted), options, path, width, height,
                      progress);
}

} // namespace haarlight::renderer
