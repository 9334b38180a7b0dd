#include "film/film_rendering.h"

#include <renderer/scene/camera.h>

#include <wavelet/base/parallel.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>

namespace haarlight::renderer {
namespace {

constexpr int tile_side = 16;

/// CPU time of this thread.
double thread_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Cost of a tile.
struct TileCost {
  ShadingCost shading;
  double seconds = 0;
};

/// Renders tiles of one pass; one per thread.
class TileRenderer {
public:
  TileRenderer(const LoadedScene& scene, const Camera& camera, std::unique_ptr<PixelShader> shader,
               Film& film, std::vector<PixelSums>& sums)
      : m_scene(scene), m_camera(camera), m_film(film), m_sums(sums), m_shader(std::move(shader)) {}

  TileCost render(int x0, int y0, const Pass& pass) {
    const double start = thread_cpu_seconds();
    m_shader->reset();
    const int width = std::min(tile_side, m_film.width - x0);
    for (int y = y0; y < std::min(y0 + tile_side, m_film.height); ++y)
      for (int i = 0; i < width; ++i) // serpentine order: each pixel is beside the previous one
        pixel((y - y0) % 2 == 0 ? x0 + i : x0 + width - 1 - i, y, pass);
    return {m_shader->take_cost(), thread_cpu_seconds() - start};
  }

private:
  void pixel(int x, int y, const Pass& pass) {
    const std::size_t index = m_film.index(x, y);
    const Ray ray =
        m_camera.generate_ray(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
    PixelHit seen{{}, -ray.direction, static_cast<std::uint32_t>(index)};
    if (!m_scene.shapes().intersect(ray, seen.hit)) {
      if (m_scene.description().light.background)
        m_film.set_color(index, m_scene.light().radiance(m_scene.light().to_light(ray.direction)));
      return;
    }
    if (seen.hit.normal.dot(ray.direction) > 0)
      seen.hit.normal = -seen.hit.normal;
    m_film.set_normal(index, seen.hit.normal);
    m_sums[index].emitted = m_scene.material_of(seen.hit.object).emission();
    m_shader->shade(seen, pass, m_sums[index]);
  }

  const LoadedScene& m_scene;
  const Camera& m_camera;
  Film& m_film;
  std::vector<PixelSums>& m_sums;
  std::unique_ptr<PixelShader> m_shader;
};

/// A rendering, from the first pass to the finished film.
class Rendering {
public:
  Rendering(const LoadedScene& scene, const RenderOptions& options, const MakeShader& make,
            int width, int height, const RenderProgress& progress)
      : m_scene(scene), m_options(options), m_camera(scene.description().camera, width, height),
        m_make(make), m_progress(progress),
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
      TileRenderer renderer(m_scene, m_camera, m_make(), m_result.film, m_sums);
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
      s.prepare_seconds += cost.shading.prepare_seconds;
      s.thread_seconds += cost.seconds;
      s.points += cost.shading.points;
      s.samples += cost.shading.points * pass.count;
      m_leaves += cost.shading.leaves;
    }
  }

  /// Passes double in size up to the time limit; without a limit there is one pass.
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
  const MakeShader& m_make;
  const RenderProgress& m_progress;
  std::vector<PixelSums> m_sums;
  std::uint64_t m_leaves = 0;
  RenderResult m_result;
};

} // namespace

RenderResult render_film(const LoadedScene& scene, const RenderOptions& options,
                         const MakeShader& make, int width, int height,
                         const RenderProgress& progress) {
  return Rendering(scene, options, make, width, height, progress).run();
}

} // namespace haarlight::renderer
