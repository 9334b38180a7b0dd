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
      m_counts.bsdf_samples = path.light_samples;
      return;
    }
    m_counts.shares_distant = false;
    m_light.emplace(scene, m_options, factories);
  }

  void reset() override {
    if (m_light)
      m_light->reset();
  }

  void shade(const PixelHit& seen, const Pass& pass, PixelSums& sums) override {
    const PathPoints points = {m_options.points, hash_words(seen.pixel, m_options.seed)};
    m_values.assign(pass.count, Rgb::Zero());
    m_pdfs.assign(pass.count, 0);
    m_techniques.assign(pass.count, Technique::First);
    m_vertex.set_hit(seen.hit, seen.wo, m_counts);
    add_light(seen, pass, points, sums);
    m_vertex.add_emitters(points.at(1, pass.first), m_values);
    if (goes_on(seen.hit.object))
      add_bsdf_samples(pass, points);
    for (std::size_t i = 0; i < pass.count; ++i)
      sums.add(m_values[i], true, m_pdfs[i], m_techniques[i]);
  }

private:
  /// Whether bsdf_samples find anything that has not been counted already.
  bool goes_on(int object) const {
    return !m_light || ((m_path.depth != 1 || m_shines) && m_scene.shapes().may_occlude(object));
  }

  void add_light(const PixelHit& seen, const Pass& pass, const PathPoints& points,
                 PixelSums& sums) {
    if (!m_light) {
      m_vertex.add_light(points.at(1, pass.first), m_values);
      ++m_cost.points;
      return;
    }
    const auto each = static_cast<std::uint32_t>(m_counts.lights);
    m_light->prepare(seen, m_cost);
    m_light->sample({pass.first * each, pass.count * each});
    m_visible.resize(m_values.size() * each);
    for (std::size_t i = 0; i < m_visible.size(); ++i) {
      m_pdfs[i / each] += m_light->pdf(i) / static_cast<float>(each);
      m_visible[i] = m_light->visible(i) ? 1 : 0;
      if (m_light->technique(i) == Technique::Second)
        m_techniques[i / each] = Technique::Second;
      if (m_visible[i] != 0)
        add_light_sample(i, each, sums);
    }
    const SumVariance shared = m_light->shared_variance(m_visible);
    sums.add_shared({shared.shadowed / (each * each), 0, 0});
  }

  /// What does not depend on the seed adds no variance to its path.
  void add_light_sample(std::size_t i, std::uint32_t each, PixelSums& sums) {
    const Rgb value = m_light->weight(i) / static_cast<float>(each);
    const Technique technique = m_light->technique(i);
    if (technique == Technique::Fixed)
      sums.shadowed += value;
    else
      m_values[i / each] += value;
  }

  /// All bsdf_samples look for light; one of each path's goes on.
  void add_bsdf_samples(const Pass& pass, const PathPoints& points) {
    const auto each = static_cast<std::size_t>(m_counts.bsdf_samples);
    m_bsdf_samples.resize(pass.count * each);
    m_vertex.sample_bsdf(points.at(1, pass.first), m_bsdf_samples);
    for (std::size_t i = 0; i < m_bsdf_samples.size(); ++i) {
      const BsdfSample& bsdf_sample = m_bsdf_samples[i];
      if (!(bsdf_sample.weight > 0).any())
        continue;
      const PathStep found = m_vertex.look(bsdf_sample);
      m_values[i / each] += bsdf_sample.weight * found.light / static_cast<float>(each);
      if (i % each == 0 && found.hit)
        m_values[i / each] += m_tracer.follow(*found.hit, bsdf_sample, points,
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
  std::vector<Rgb> m_values;           ///< radiance by path
  std::vector<float> m_pdfs;           ///< mean of its light samples'
  std::vector<Technique> m_techniques; ///< of its light samples
  std::vector<std::uint8_t> m_visible; ///< of all light samples
  std::vector<BsdfSample> m_bsdf_samples;
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
