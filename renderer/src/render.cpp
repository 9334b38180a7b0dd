#include <renderer/render.h>

#include "pixel_sums.h"

#include <wavelet/parallel.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>

namespace haarlight::renderer {
namespace {

constexpr int tile_side = 16;

constexpr std::array<std::pair<const char*, Estimator>, 3> estimator_names = {
    {{"unbiased", Estimator::Unbiased},
     {"bidirectional", Estimator::Bidirectional},
     {"ratio", Estimator::Ratio}}};

/// What this thread has computed so far; other programs on the machine do not count.
double thread_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A run of samples for every pixel.
struct Pass {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// What one tile cost.
struct TileCost {
  double prepare_seconds = 0;
  double seconds = 0;
  std::uint64_t points = 0;
  std::uint64_t leaves = 0;
};

/// What stands in the way of a hit.
class PointOcclusion : public wavelet::Occlusion {
public:
  PointOcclusion(const LoadedScene& scene, const Hit& hit) : m_scene(scene), m_hit(hit) {}

  /// Below the surface nothing counts as hidden: what lies there is no light's way.
  void find(std::span<const Vec3> directions, std::span<std::uint8_t> hidden) const override {
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const Vec3 w = m_scene.light().to_world(directions[i]);
      hidden[i] = m_hit.normal.dot(w) > 0 && m_scene.shapes().occluded(leave(m_hit, w)) ? 1 : 0;
    }
  }

private:
  const LoadedScene& m_scene;
  const Hit& m_hit;
};

/// Renders tiles of one pass; one for each thread at a time.
class TileRenderer {
public:
  TileRenderer(const LoadedScene& scene, const RenderOptions& options, const Camera& camera,
               const RenderFactories& factories, Film& film, std::vector<PixelSums>& sums)
      : m_scene(scene), m_options(options), m_camera(camera), m_film(film), m_sums(sums),
        m_sampler(factories.sampler->make()),
        m_integrator(factories.integrator ? factories.integrator->make() : nullptr) {}

  TileCost render(int x0, int y0, const Pass& pass) {
    const double start = thread_cpu_seconds();
    m_cost = {};
    m_sampler->forget();
    if (m_integrator)
      m_integrator->forget();
    const int width = std::min(tile_side, m_film.width - x0);
    for (int y = y0; y < std::min(y0 + tile_side, m_film.height); ++y)
      for (int i = 0; i < width; ++i) // to and fro: each pixel beside the last
        pixel((y - y0) % 2 == 0 ? x0 + i : x0 + width - 1 - i, y, pass);
    m_cost.seconds = thread_cpu_seconds() - start;
    return m_cost;
  }

private:
  void pixel(int x, int y, const Pass& pass) {
    const std::size_t index = m_film.index(x, y);
    const Ray ray =
        m_camera.generate_ray(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
    Hit hit;
    if (!m_scene.shapes().intersect(ray, hit)) {
      if (m_scene.description().light.background)
        m_film.set_color(index, m_scene.light().radiance(m_scene.light().to_light(ray.direction)));
      return;
    }
    if (hit.normal.dot(ray.direction) > 0)
      hit.normal = -hit.normal;
    m_film.set_normal(index, hit.normal);
    shade(hit, -ray.direction, static_cast<std::uint32_t>(index), pass, m_sums[index]);
  }

  void shade(const Hit& hit, const Vec3& wo, std::uint32_t pixel_index, const Pass& pass,
             PixelSums& sums) {
    const Light& light = m_scene.light();
    const Material& material = m_scene.material_of(hit.object);
    ShadingPoint point = shading_point(light.to_light(hit.normal), light.to_light(wo));
    const PointOcclusion occlusion(m_scene, hit);
    if (m_options.estimator == Estimator::Unbiased && m_scene.shapes().may_occlude(hit.object))
      point.occlusion = &occlusion;
    prepare(point, material, sums);
    m_directions.resize(pass.count);
    m_sampler->sample({m_options.points, hash_words(pixel_index, m_options.seed), pass.first},
                      m_directions);
    m_candidates.clear();
    for (const DirectionSample& s : m_directions)
      m_candidates.push_back(s.direction);
    m_reflectance.resize(pass.count);
    material.evaluate(point, m_candidates, m_reflectance);
    m_radiance.resize(pass.count);
    m_sampler->radiance(light, m_candidates, m_radiance);
    for (std::size_t i = 0; i < m_directions.size(); ++i)
      add_sample(hit, m_directions[i], m_reflectance[i] * m_radiance[i], sums);
  }

  void prepare(const ShadingPoint& point, const Material& material, PixelSums& sums) {
    const auto start = std::chrono::steady_clock::now();
    m_sampler->prepare(point, material);
    if (m_integrator)
      m_integrator->prepare(point, material);
    m_cost.prepare_seconds += seconds_since(start);
    ++m_cost.points;
    m_cost.leaves += m_sampler->leaves();
    if (needs_unshadowed(m_options.estimator))
      sums.product = (m_integrator ? *m_integrator : *m_sampler).unshadowed().value_or(Rgb::Zero());
  }

  /// @param reflected f_r L cos of the sample's direction
  void add_sample(const Hit& hit, const DirectionSample& s, const Rgb& reflected,
                  PixelSums& sums) const {
    if (!(s.pdf > 0) || !(reflected > 0).any()) {
      sums.add(Rgb::Zero(), false, s.pdf);
      return;
    }
    const Rgb weight = reflected / s.pdf;
    const bool visible =
        !m_scene.shapes().occluded(leave(hit, m_scene.light().to_world(s.direction)));
    sums.add(weight, visible, s.pdf);
  }

  const LoadedScene& m_scene;
  const RenderOptions& m_options;
  const Camera& m_camera;
  Film& m_film;
  std::vector<PixelSums>& m_sums;
  std::unique_ptr<Sampler> m_sampler;
  std::unique_ptr<Sampler> m_integrator; ///< of L_ns, where the sampler has none
  std::vector<DirectionSample> m_directions;
  std::vector<Vec3> m_candidates;
  std::vector<Rgb> m_reflectance;
  std::vector<Rgb> m_radiance;
  TileCost m_cost;
};

/// One rendering from first pass to finished film.
class Rendering {
public:
  Rendering(const LoadedScene& scene, const RenderFactories& factories,
            const RenderOptions& options, int width, int height, const RenderProgress& progress)
      : m_scene(scene), m_options(options), m_camera(scene.description().camera, width, height),
        m_factories(factories), m_progress(progress),
        m_sums(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    m_result.film = Film(width, height);
  }

  RenderResult run() {
    const auto start = std::chrono::steady_clock::now();
    Pass pass = {0, static_cast<std::uint32_t>(m_options.spp)};
    while (pass.count > 0) {
      const auto pass_start = std::chrono::steady_clock::now();
      run_pass(pass);
      pass = next_pass(pass, seconds_since(pass_start), seconds_since(start));
    }
    m_result.statistics.seconds = seconds_since(start);
    m_result.statistics.spp = static_cast<int>(pass.first);
    finish();
    return std::move(m_result);
  }

private:
  int tiles_across() const { return (m_result.film.width + tile_side - 1) / tile_side; }
  int tiles_down() const { return (m_result.film.height + tile_side - 1) / tile_side; }

  void run_pass(const Pass& pass) {
    const auto count =
        static_cast<std::size_t>(tiles_across()) * static_cast<std::size_t>(tiles_down());
    std::vector<TileCost> costs(count);
    std::atomic<std::size_t> done = 0;
    parallel_ranges(count, 1, [&](std::size_t begin, std::size_t end) {
      TileRenderer renderer(m_scene, m_options, m_camera, m_factories, m_result.film, m_sums);
      for (std::size_t i = begin; i < end; ++i) {
        const int tile = static_cast<int>(i);
        costs[i] = renderer.render(tile % tiles_across() * tile_side,
                                   tile / tiles_across() * tile_side, pass);
        if (m_progress && m_options.time_limit <= 0)
          m_progress(static_cast<double>(++done) / static_cast<double>(count));
      }
    });
    account(costs, pass);
  }

  void account(const std::vector<TileCost>& costs, const Pass& pass) {
    RenderStatistics& s = m_result.statistics;
    for (const TileCost& cost : costs) {
      s.prepare_seconds += cost.prepare_seconds;
      s.thread_seconds += cost.seconds;
      s.points += cost.points;
      s.samples += cost.points * pass.count;
      m_leaves += cost.leaves;
    }
  }

  /// Passes double in size while the time allows; without a limit there is one.
  Pass next_pass(const Pass& last, double pass_seconds, double elapsed) const {
    const std::uint32_t total = last.first + last.count;
    const double left = m_options.time_limit - elapsed;
    if (left <= 0)
      return {total, 0};
    const double affordable = left / std::max(pass_seconds, 1e-9) * last.count;
    const auto count = static_cast<std::uint32_t>(std::min<double>(total, affordable));
    if (m_progress)
      m_progress(std::min(1.0, elapsed / m_options.time_limit));
    return {total, count >= std::max(1U, total / 8) ? count : 0};
  }

  void finish() {
    Film& film = m_result.film;
    double variance_sum = 0;
    std::uint64_t lit = 0;
    for (std::size_t i = 0; i < m_sums.size(); ++i) {
      const PixelSums& sums = m_sums[i];
      if (sums.count == 0)
        continue;
      const Rgb color = estimate(sums, m_options.estimator);
      const double variance = estimate_variance(sums, m_options.estimator);
      film.set_color(i, color);
      film.pdf_sum[i] = static_cast<float>(sums.pdf);
      film.variance[i] = static_cast<float>(variance);
      film.samples[i] = static_cast<float>(sums.count);
      const auto y = static_cast<double>(luminance(color));
      if (y > 0) {
        variance_sum += sums.count * variance / (y * y);
        ++lit;
      }
    }
    RenderStatistics& s = m_result.statistics;
    s.relative_variance_per_sample = lit > 0 ? variance_sum / static_cast<double>(lit) : 0;
    s.mean_leaves =
        s.points > 0 ? static_cast<double>(m_leaves) / static_cast<double>(s.points) : 0;
  }

  const LoadedScene& m_scene;
  const RenderOptions& m_options;
  Camera m_camera;
  const RenderFactories& m_factories;
  const RenderProgress& m_progress;
  std::vector<PixelSums> m_sums;
  std::uint64_t m_leaves = 0;
  RenderResult m_result;
};

SamplerOptions sampling_of(const RenderOptions& options) {
  SamplerOptions result = options.sampling;
  result.count = static_cast<std::size_t>(options.spp);
  if (needs_unshadowed(options.estimator)) // whose product has to be each point's own
    result.product.drift_bound = 0;
  return result;
}

} // namespace

std::optional<Estimator> estimator_from_name(const std::string& name) {
  for (const auto& [text, estimator] : estimator_names)
    if (name == text)
      return estimator;
  return std::nullopt;
}

std::string estimator_name(Estimator estimator) {
  return estimator_names[static_cast<std::size_t>(estimator)].first;
}

std::optional<std::string> problem_of(SamplerKind sampler, Estimator estimator) {
  if (estimator == Estimator::Bidirectional && !traits(sampler).follows_product)
    return "the bidirectional estimator needs directions that follow the product: --sampler "
           "product or "
           "product-table";
  return std::nullopt;
}

RenderFactories::RenderFactories(const LoadedScene& scene, const RenderOptions& options)
    : sampler(make_sampler_factory(options.sampler, scene, sampling_of(options))) {
  if (needs_unshadowed(options.estimator) && !traits(options.sampler).follows_product)
    integrator = make_sampler_factory(SamplerKind::Product, scene, sampling_of(options));
}

RenderResult render(const LoadedScene& scene, const RenderFactories& factories,
                    const RenderOptions& options, int width, int height,
                    const RenderProgress& progress) {
  return Rendering(scene, factories, options, width, height, progress).run();
}

RenderResult render(const LoadedScene& scene, const RenderOptions& options, int width, int height,
                    const RenderProgress& progress) {
  return render(scene, RenderFactories(scene, options), options, width, height, progress);
}

} // namespace haarlight::renderer
