#include <renderer/path.h>

#include "../film_rendering.h"
#include "../light_samples.h"
#include "path_tracer.h"

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
      : m_scene(scene), m_options(options), m_only_light(path.depth == 1 && !shines(scene)),
        m_vertex(scene, emitters), m_tracer(scene, emitters, path) {
    if (options.sampler != SamplerKind::Mis)
      m_light.emplace(scene, m_options, factories);
  }

  void forget() override {
    if (m_light)
      m_light->forget();
  }

  void shade(const PixelHit& seen, const Pass& pass, PixelSums& sums) override {
    const PathPoints points = {m_options.points, hash_words(seen.pixel, m_options.seed)};
    m_values.assign(pass.count, Rgb::Zero());
    m_vertex.arrive(seen.hit, seen.wo);
    add_light(seen, pass, points);
    m_vertex.add_emitters(points.at(1, pass.first), m_values);
    if (goes_on(seen.hit.object))
      add_departures(seen.hit, pass, points);
    for (std::size_t i = 0; i < pass.count; ++i)
      sums.add(m_values[i], true, m_light ? m_light->pdf(i) : 0.0F);
  }

private:
  /// Whether departures find anything that has not been counted already.
  bool goes_on(int object) const {
    return !m_light || (!m_only_light && m_scene.shapes().may_occlude(object));
  }

  void add_light(const PixelHit& seen, const Pass& pass, const PathPoints& points) {
    if (!m_light) {
      m_vertex.add_light(points.at(1, pass.first), m_values);
      ++m_cost.points;
      return;
    }
    m_light->prepare(seen, m_cost);
    m_light->sample(pass);
    for (std::size_t i = 0; i < pass.count; ++i)
      if (m_light->visible(i))
        m_values[i] += m_light->weight(i);
  }

  void add_departures(const Hit& from, const Pass& pass, const PathPoints& points) {
    m_departures.resize(pass.count);
    m_vertex.depart(points.at(1, pass.first), m_departures);
    for (std::size_t i = 0; i < pass.count; ++i) {
      const std::uint32_t path = pass.first + static_cast<std::uint32_t>(i);
      m_values[i] += m_tracer.follow(from, m_departures[i], points, path, !m_light);
    }
  }

  const LoadedScene& m_scene;
  const RenderOptions& m_options;
  bool m_only_light;
  std::optional<LightSamples> m_light; ///< none: by the first vertex itself
  PathVertex m_vertex;                 ///< the first
  PathTracer m_tracer;
  std::vector<Rgb> m_values; ///< radiance by path
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
  return render_paths(scene, RenderFactories(scene, options), options, path, width, height,
                      progress);
}

} // namespace haarlight::renderer
