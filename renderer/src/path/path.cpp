#include <renderer/path/path.h>

#include "film/film_rendering.h"
#include "light/light_samples.h"
#include "path/emitters.h"
#include "samplers/basic_samplers.h"

#include <algorithm>
#include <optional>

namespace haarlight::renderer {
namespace {

/// Dimensions of a vertex's points.
enum Dimension : std::uint32_t { OfLight, OfLobe, OfEmitter, OfEmitterChoice, OfRoulette = 8 };

/// The point sets of a vertex's samples.
struct VertexPoints {
  Points kind = Points::Sobol;
  std::uint32_t key = 0;   ///< of pixel, seed and vertex
  std::uint32_t first = 0; ///< index of the first path

  /// @param each consecutive points per path
  void fill(std::uint32_t dimension, int each, std::span<Vec2> out) const {
    fill_points(kind, hash_words(key, dimension), first * static_cast<std::uint32_t>(each), out);
  }
};

/// The random points of a pixel's paths.
struct PathPoints {
  Points kind = Points::Sobol;
  std::uint32_t key = 0; ///< of pixel and seed

  /// Of vertex 1, 2, … for the paths from `first` on.
  VertexPoints at(int vertex, std::uint32_t first) const {
    return {kind, hash_words(key, 0x70617468U + static_cast<std::uint32_t>(vertex)), first};
  }
};

/// A direction sampled from the reflectance.
struct BsdfSample {
  Vec3 direction = Vec3::UnitZ(); ///< unit, world
  Rgb weight = Rgb::Zero();       ///< f_r cos / pdf
  float pdf = 0;                  ///< sr⁻¹
};

/// The result of tracing a BSDF sample.
struct TracedSample {
  Rgb light = Rgb::Zero(); ///< emitted towards the vertex, times the sample's MIS weight
  std::optional<Hit> hit;  ///< the surface, its normal on this side; none if the ray escapes
};

/// Numbers of samples per path at a vertex.
struct VertexCounts {
  int lights = 1;             ///< of the distant light and of the emitters, each
  int bsdf_samples = 1;       ///< of the reflectance
  bool shares_distant = true; ///< whether BSDF samples that escape contribute the distant light
};

/// A surface point on a path: its reflected direct light, and the continuation of paths. Set to one
/// point after another, for any number of paths at each; one per thread.
class PathVertex {
public:
  PathVertex(const LoadedScene& scene, const Emitters& emitters)
      : m_scene(scene), m_emitters(emitters) {}

  /// @param hit its normal on the viewer's side
  /// @param wo  unit direction to the viewer, world
  void set_hit(const Hit& hit, const Vec3& wo, const VertexCounts& counts = {}) {
    const Light& light = m_scene.light();
    m_counts = counts;
    m_hit = hit;
    m_point = shading_point(light.to_light(hit.normal), light.to_light(wo));
    m_material = &m_scene.material_of(hit.object);
    m_lobe.prepare(m_point, *m_material);
  }

  /// Adds to each path's sum its samples of the distant light, weighted against BSDF samples that
  /// escape.
  void add_light(const VertexPoints& points, std::span<Rgb> sums) {
    const Light& light = m_scene.light();
    const std::size_t each = static_cast<std::size_t>(m_counts.lights);
    const std::size_t count = each * sums.size();
    m_points.resize(count);
    points.fill(OfLight, m_counts.lights, m_points);
    m_lights.resize(count);
    light.sample(m_points, m_lights);
    m_samples.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      m_samples[i].direction = m_lights[i].direction;
    evaluate(m_samples);
    m_lobe.pdfs(m_samples);
    m_radiance.resize(count);
    light.radiance(m_directions, m_radiance);
    for (std::size_t i = 0; i < count; ++i) {
      const Rgb reflected = m_reflected[i] * m_radiance[i];
      if (!(m_lights[i].pdf > 0) || !(reflected > 0).any())
        continue;
      if (!m_scene.shapes().occluded(leave(m_hit, light.to_world(m_directions[i]))))
        sums[i / each] +=
            reflected / (lights() * m_lights[i].pdf + bsdf_samples() * m_samples[i].pdf);
    }
  }

  /// Adds to each path's sum its samples of the emitters, weighted against BSDF samples that hit
  /// them.
  void add_emitters(const VertexPoints& points, std::span<Rgb> sums) {
    if (m_emitters.empty())
      return;
    const std::size_t each = static_cast<std::size_t>(m_counts.lights);
    m_points.resize(each * sums.size());
    points.fill(OfEmitter, m_counts.lights, m_points);
    m_choices.resize(m_points.size());
    points.fill(OfEmitterChoice, m_counts.lights, m_choices);
    for (std::size_t i = 0; i < m_points.size(); ++i)
      if (const auto to = m_emitters.sample(m_hit, m_choices[i].x(), m_points[i]))
        sums[i / each] += emitter_sample(*to);
  }

  /// Samples the reflectance; consecutive samples belong to one path.
  void sample_bsdf(const VertexPoints& points, std::span<BsdfSample> out) {
    m_points.resize(out.size());
    points.fill(OfLobe, m_counts.bsdf_samples, m_points);
    m_samples.resize(out.size());
    m_lobe.sample(m_points, m_samples);
    evaluate(m_samples);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const DirectionSample& s = m_samples[i];
      const Rgb weight = s.pdf > 0 ? Rgb(m_reflected[i] / s.pdf) : Rgb(Rgb::Zero());
      out[i] = {m_scene.light().to_world(s.direction), weight, s.pdf};
    }
  }

  /// Traces a BSDF sample. Its light is to be averaged over the BSDF samples of a path.
  TracedSample trace(const BsdfSample& sample) const {
    Hit hit;
    if (!m_scene.shapes().intersect(leave(m_hit, sample.direction), hit))
      return {m_counts.shares_distant ? distant_light(sample) : Rgb(Rgb::Zero()), std::nullopt};
    TracedSample traced{emitted_light(sample, hit), hit};
    if (hit.normal.dot(sample.direction) > 0)
      traced.hit->normal = -hit.normal;
    return traced;
  }

private:
  /// Sets m_reflected to f_r cos in the samples' directions.
  void evaluate(std::span<const DirectionSample> samples) {
    m_directions.clear();
    for (const DirectionSample& s : samples)
      m_directions.push_back(s.direction);
    m_reflected.resize(samples.size());
    m_material->evaluate(m_point, m_directions, m_reflected);
  }

  Rgb emitter_sample(const EmitterDirection& to) const {
    Hit hit;
    if (!(m_hit.normal.dot(to.direction) > 0) ||
        !m_scene.shapes().intersect(leave(m_hit, to.direction), hit) || hit.object != to.object)
      return Rgb::Zero();
    const float pdf = m_emitters.pdf(m_hit, to.direction, hit);
    if (!(pdf > 0))
      return Rgb::Zero();
    const Vec3 w = m_scene.light().to_light(to.direction);
    return m_material->evaluate(m_point, w) * m_scene.material_of(hit.object).emission() /
           (lights() * pdf + bsdf_samples() * m_lobe.pdf(w));
  }

  /// The distant light along a BSDF sample, weighted against add_light().
  Rgb distant_light(const BsdfSample& sample) const {
    const Light& light = m_scene.light();
    const Vec3 w = light.to_light(sample.direction);
    return light.radiance(w) *
           balance_heuristic(bsdf_samples() * sample.pdf, lights() * light.pdf(w));
  }

  /// The emission of the surface that a BSDF sample hits, weighted against add_emitters().
  Rgb emitted_light(const BsdfSample& sample, const Hit& hit) const {
    const Rgb& emission = m_scene.material_of(hit.object).emission();
    if (m_emitters.empty() || !(emission > 0).any())
      return emission;
    const float pdf = m_emitters.pdf(m_hit, sample.direction, hit);
    return emission * balance_heuristic(bsdf_samples() * sample.pdf, lights() * pdf);
  }

  float lights() const { return static_cast<float>(m_counts.lights); }
  float bsdf_samples() const { return static_cast<float>(m_counts.bsdf_samples); }

  const LoadedScene& m_scene;
  const Emitters& m_emitters;
  VertexCounts m_counts;
  Hit m_hit;
  ShadingPoint m_point;
  const Material* m_material = nullptr;
  Lobe m_lobe;
  std::vector<Vec2> m_points;
  std::vector<Vec2> m_choices;
  std::vector<probe::LightSample> m_lights;
  std::vector<DirectionSample> m_samples;
  std::vector<Vec3> m_directions;
  std::vector<Rgb> m_reflected;
  std::vector<Rgb> m_radiance;
};

/// Russian roulette from the third vertex on. @return whether the path continues
bool survives(int vertex, const VertexPoints& points, Rgb& throughput) {
  constexpr int first_roulette = 3;
  constexpr float max_probability = 0.95F;
  if (vertex < first_roulette)
    return true;
  const float probability = std::min(max_probability, throughput.maxCoeff());
  Vec2 u;
  points.fill(OfRoulette, 1, std::span(&u, 1));
  if (!(u.x() < probability))
    return false;
  throughput /= probability;
  return true;
}

/// Light along all path types.
class PathShader : public PixelShader {
public:
  PathShader(const LoadedScene& scene, const RenderOptions& options, const PathOptions& path,
             const RenderFactories& factories, const Emitters& emitters)
      : m_scene(scene), m_options(options), m_path(path),
        m_has_emission(std::ranges::any_of(
            scene.materials(), [](const Material& m) { return (m.emission() > 0).any(); })),
        m_first(scene, emitters), m_later(scene, emitters) {
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
    m_first.set_hit(seen.hit, seen.wo, m_counts);
    SumVariance variance = add_light(seen, pass, points);
    m_other.resize(pass.count);
    for (std::size_t i = 0; i < pass.count; ++i)
      m_other[i].luminance = m_light ? -static_cast<double>(luminance(m_values[i])) : 0;
    m_first.add_emitters(points.at(1, pass.first), m_values);
    if (continues(seen.hit.object))
      add_bsdf_samples(pass, points);
    for (std::size_t i = 0; i < pass.count; ++i) {
      sums.add(m_values[i], true, m_pdfs[i]);
      m_other[i].luminance += static_cast<double>(luminance(m_values[i]));
      m_other[i].visible = true;
    }
    variance += variance_of_sums(m_other);
    sums.add_variance(variance, pass.count);
  }

private:
  /// Whether BSDF samples can find light that is not counted otherwise.
  bool continues(int object) const {
    return !m_light ||
           ((m_path.depth != 1 || m_has_emission) && m_scene.shapes().may_occlude(object));
  }

  /// @return the variance of the sum of the sampler's samples, which is independent of all else; 0
  /// without a sampler
  SumVariance add_light(const PixelHit& seen, const Pass& pass, const PathPoints& points) {
    if (!m_light) {
      m_first.add_light(points.at(1, pass.first), m_values);
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

  /// All BSDF samples gather light; the first of each path continues it.
  void add_bsdf_samples(const Pass& pass, const PathPoints& points) {
    const auto each = static_cast<std::size_t>(m_counts.bsdf_samples);
    m_bsdf_samples.resize(pass.count * each);
    m_first.sample_bsdf(points.at(1, pass.first), m_bsdf_samples);
    for (std::size_t i = 0; i < m_bsdf_samples.size(); ++i) {
      const BsdfSample& sample = m_bsdf_samples[i];
      if (!(sample.weight > 0).any())
        continue;
      const TracedSample traced = m_first.trace(sample);
      m_values[i / each] += sample.weight * traced.light / static_cast<float>(each);
      if (i % each == 0 && traced.hit)
        m_values[i / each] += later_light(*traced.hit, sample, points,
                                          pass.first + static_cast<std::uint32_t>(i / each));
    }
  }

  /// The light reflected at a path's second and later vertices, times the path's throughput.
  /// @param hit    the second vertex
  /// @param sample that led there
  /// @param path   the path's index among the pixel's
  Rgb later_light(Hit hit, BsdfSample sample, const PathPoints& points, std::uint32_t path) {
    Rgb sum = Rgb::Zero();
    Rgb throughput = sample.weight;
    for (int vertex = 2; m_path.depth == 0 || vertex <= m_path.depth; ++vertex) {
      const VertexPoints source = points.at(vertex, path);
      m_later.set_hit(hit, -sample.direction);
      Rgb direct = Rgb::Zero();
      m_later.add_light(source, std::span(&direct, 1));
      m_later.add_emitters(source, std::span(&direct, 1));
      sum += throughput * direct;
      m_later.sample_bsdf(source, std::span(&sample, 1));
      throughput *= sample.weight;
      if (!(throughput > 0).any() || !survives(vertex, source, throughput))
        break;
      const TracedSample traced = m_later.trace(sample);
      sum += throughput * traced.light;
      if (!traced.hit)
        break;
      hit = *traced.hit;
    }
    return sum;
  }

  const LoadedScene& m_scene;
  const RenderOptions& m_options;
  PathOptions m_path;
  bool m_has_emission;
  VertexCounts m_counts;               ///< of the first vertex
  std::optional<LightSamples> m_light; ///< none: sampled by the first vertex itself
  PathVertex m_first;
  PathVertex m_later;
  std::vector<Rgb> m_values;                 ///< radiance by path
  std::vector<float> m_pdfs;                 ///< mean of a path's light samples
  std::vector<Contribution> m_contributions; ///< of the sampler's samples
  std::vector<Contribution> m_other;         ///< of everything else, by path
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
  RenderOptions counted = options; // samplers expect the number of light samples
  counted.spp *= path.light_samples;
  return render_paths(scene, RenderFactories(scene, counted), options, path, width, height,
                      progress);
}

} // namespace haarlight::renderer
