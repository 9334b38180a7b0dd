#include "film/film_rendering.h"
#include "light/light_samples.h"
#include "path/emitters.h"
#include "samplers/basic_samplers.h"

#include <renderer/path/path.h>
#include <renderer/scene/loaded_scene.h>

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

namespace haarlight::renderer {
namespace {

/// How a path leaves a vertex.
struct BsdfSample {
  Vec3 direction = Vec3::UnitZ(); ///< unit, world
  Rgb weight = Rgb::Zero();       ///< f_r cos / pdf
  float pdf = 0;                  ///< sr⁻¹, of the reflectance's sampling
};

/// The point sets of a vertex's samples.
struct VertexPoints {
  Points kind = Points::Sobol;
  std::uint32_t key = 0;   ///< of pixel, seed and vertex
  std::uint32_t first = 0; ///< index of the first path

  /// @param each points for each path, side by side
  void fill(std::uint32_t dimension, int each, std::span<Vec2> out) const {
    fill_points(kind, hash_words(key, dimension), first * static_cast<std::uint32_t>(each), out);
  }
};

/// Samples that a path takes at a vertex.
struct VertexCounts {
  int lights = 1;             ///< of the distant light and of the emitters, each
  int bsdf_samples = 1;       ///< by the reflectance
  bool shares_distant = true; ///< whether bsdf_samples that escape count for the distant light; if
                              ///< not, it is left to others alone
};

/// What a technique counts with where another could have found the same: the balance heuristic.
/// @param own,other numbers of samples times density
inline float balance(float own, float other) { return own / (own + other); }

/// What a bsdf_sample comes upon.
struct PathStep {
  Rgb light = Rgb::Zero(); ///< its share of the light straight from there
  std::optional<Hit> hit;  ///< the surface, its normal on this side; nothing if it escapes
};

/// Turns from point to point, for any number of paths at each; one thread's.
class PathVertex {
public:
  PathVertex(const LoadedScene& scene, const Emitters& emitters)
      : m_scene(scene), m_emitters(emitters) {}

  /// @param hit its normal on the viewer's side
  /// @param wo  unit direction to the viewer, world
  void set_hit(const Hit& hit, const Vec3& wo, const VertexCounts& counts = {});

  /// Adds to each path's sum what its samples of the distant light by itself send back;
  /// bsdf_samples that escape have the rest.
  void add_light(const VertexPoints& points, std::span<Rgb> sums);

  /// Adds to each path's sum what its samples of the emitters send back; bsdf_samples that meet one
  /// have the rest.
  void add_emitters(const VertexPoints& points, std::span<Rgb> sums);

  /// Draws bsdf_samples by the reflectance, those of one path side by side.
  void sample_bsdf(const VertexPoints& points, std::span<BsdfSample> out);

  /// Looks along one of the bsdf_samples. Its light is to be averaged over those of a path.
  PathStep look(const BsdfSample& bsdf_sample) const;

private:
  void evaluate(std::span<const DirectionSample> samples);
  Rgb emitter_sample(const EmitterDirection& to) const;
  Rgb escaped(const BsdfSample& bsdf_sample) const;
  Rgb met(const BsdfSample& bsdf_sample, const Hit& hit) const;
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

/// Dimensions of a vertex's points.
enum Dimension : std::uint32_t { OfLight, OfLobe, OfEmitter, OfChoice };

void PathVertex::set_hit(const Hit& hit, const Vec3& wo, const VertexCounts& counts) {
  const Light& light = m_scene.light();
  m_counts = counts;
  m_hit = hit;
  m_point = shading_point(light.to_light(hit.normal), light.to_light(wo));
  m_material = &m_scene.material_of(hit.object);
  m_lobe.prepare(m_point, *m_material);
}

/// Sets m_reflected to f_r cos of the samples' directions.
void PathVertex::evaluate(std::span<const DirectionSample> samples) {
  m_directions.clear();
  for (const DirectionSample& s : samples)
    m_directions.push_back(s.direction);
  m_reflected.resize(samples.size());
  m_material->evaluate(m_point, m_directions, m_reflected);
}

void PathVertex::add_light(const VertexPoints& points, std::span<Rgb> sums) {
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

void PathVertex::add_emitters(const VertexPoints& points, std::span<Rgb> sums) {
  if (m_emitters.empty())
    return;
  const std::size_t each = static_cast<std::size_t>(m_counts.lights);
  m_points.resize(each * sums.size());
  points.fill(OfEmitter, m_counts.lights, m_points);
  m_choices.resize(m_points.size());
  points.fill(OfChoice, m_counts.lights, m_choices);
  for (std::size_t i = 0; i < m_points.size(); ++i)
    if (const auto to = m_emitters.sample(m_hit, m_choices[i].x(), m_points[i]))
      sums[i / each] += emitter_sample(*to);
}

Rgb PathVertex::emitter_sample(const EmitterDirection& to) const {
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

void PathVertex::sample_bsdf(const VertexPoints& points, std::span<BsdfSample> out) {
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

PathStep PathVertex::look(const BsdfSample& bsdf_sample) const {
  Hit hit;
  if (!m_scene.shapes().intersect(leave(m_hit, bsdf_sample.direction), hit))
    return {m_counts.shares_distant ? escaped(bsdf_sample) : Rgb(Rgb::Zero()), std::nullopt};
  PathStep found{met(bsdf_sample, hit), hit};
  if (hit.normal.dot(bsdf_sample.direction) > 0)
    found.hit->normal = -hit.normal;
  return found;
}

/// The share of the distant light seen along a bsdf_sample that add_light() leaves to it.
Rgb PathVertex::escaped(const BsdfSample& bsdf_sample) const {
  const Light& light = m_scene.light();
  const Vec3 w = light.to_light(bsdf_sample.direction);
  return light.radiance(w) * balance(bsdf_samples() * bsdf_sample.pdf, lights() * light.pdf(w));
}

/// The share of what `hit` emits that add_emitters() leaves to a bsdf_sample.
Rgb PathVertex::met(const BsdfSample& bsdf_sample, const Hit& hit) const {
  const Rgb& emission = m_scene.material_of(hit.object).emission();
  if (m_emitters.empty() || !(emission > 0).any())
    return emission;
  const float pdf = m_emitters.pdf(m_hit, bsdf_sample.direction, hit);
  return emission * balance(bsdf_samples() * bsdf_sample.pdf, lights() * pdf);
}

/// The random points of a pixel's paths.
struct PathPoints {
  Points kind = Points::Sobol;
  std::uint32_t key = 0; ///< of the pixel and the seed

  /// Of a vertex, 1 being the first, from path `first` on.
  VertexPoints at(int vertex, std::uint32_t first) const {
    return {kind, hash_words(key, 0x70617468U + static_cast<std::uint32_t>(vertex)), first};
  }
};

/// One thread's.
class PathTracer {
public:
  PathTracer(const LoadedScene& scene, const Emitters& emitters, const PathOptions& options)
      : m_options(options), m_vertex(scene, emitters) {}

  /// The light that comes back from a path's second vertex, times its weight so far.
  /// @param at        the second vertex
  /// @param bsdf_sample that led there
  /// @param points    of the pixel
  /// @param path      the path's index among the pixel's
  Rgb follow(Hit at, BsdfSample bsdf_sample, const PathPoints& points, std::uint32_t path);

private:
  bool survives(int vertex, const VertexPoints& points, Rgb& throughput) const;

  PathOptions m_options;
  PathVertex m_vertex;
};

constexpr int first_roulette = 3; ///< vertex
constexpr float most_survive = 0.95F;
constexpr std::uint32_t roulette_dimension = 8; ///< above those of PathVertex

Rgb PathTracer::follow(Hit at, BsdfSample bsdf_sample, const PathPoints& points,
                       std::uint32_t path) {
  Rgb sum = Rgb::Zero();
  Rgb throughput = bsdf_sample.weight;
  for (int vertex = 2; m_options.depth == 0 || vertex <= m_options.depth; ++vertex) {
    const VertexPoints source = points.at(vertex, path);
    m_vertex.set_hit(at, -bsdf_sample.direction);
    Rgb direct = Rgb::Zero();
    m_vertex.add_light(source, std::span(&direct, 1));
    m_vertex.add_emitters(source, std::span(&direct, 1));
    sum += throughput * direct;
    m_vertex.sample_bsdf(source, std::span(&bsdf_sample, 1));
    throughput *= bsdf_sample.weight;
    if (!(throughput > 0).any() || !survives(vertex, source, throughput))
      break;
    const PathStep found = m_vertex.look(bsdf_sample);
    sum += throughput * found.light;
    if (!found.hit)
      break;
    at = *found.hit;
  }
  return sum;
}

/// Russian roulette; what survives stands for the rest.
bool PathTracer::survives(int vertex, const VertexPoints& points, Rgb& throughput) const {
  if (vertex < first_roulette)
    return true;
  const float chance = std::min(most_survive, throughput.maxCoeff());
  Vec2 u;
  points.fill(roulette_dimension, 1, std::span(&u, 1));
  if (!(u.x() < chance))
    return false;
  throughput /= chance;
  return true;
}

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
