// Representative lights in strata of similar brightness (Agarwal, Ramamoorthi, Belongie and Jensen
// 2003, "Structured Importance Sampling of Environment Maps").

#include "samplers/representative_lights.h"
#include "samplers/sampler_factories.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <queue>

namespace haarlight::renderer {
namespace {

constexpr int threshold_count = 6;
/// Solid angle (sr) up to which the visibility within a region is coherent.
constexpr double coherent_solid_angle = 0.01;

/// The pixels of a connected component above one threshold that are not above the next.
struct Stratum {
  std::uint32_t parent = 0; ///< of the lower threshold; itself for the first, the whole sphere
  double energy = 0;
  std::size_t pixels = 0;
  std::size_t lights = 0;

  /// The paper's Γ = L ΔΩ^¼.
  double importance(double pixel_solid_angle) const {
    const double area = static_cast<double>(pixels) * pixel_solid_angle;
    return energy * std::sqrt(std::sqrt(std::min(area, coherent_solid_angle)));
  }
};

/// The strata of a light and their numbers of lights.
class Stratification {
public:
  Stratification(const LightPixels& pixels, std::size_t count)
      : m_pixels(pixels), m_stratum(pixels.count(), 0), m_strata(1) {
    find_components();
    for (std::size_t i = 0; i < pixels.count(); ++i) {
      Stratum& s = m_strata[m_stratum[i]];
      s.energy += static_cast<double>(pixels.luminance[i]);
      ++s.pixels;
    }
    merge_weak(static_cast<double>(count));
    distribute(count);
  }

  const std::vector<Stratum>& strata() const { return m_strata; }

  /// Pixels in the order of their strata.
  std::vector<std::uint32_t> order() const {
    std::vector<std::uint32_t> result(m_pixels.count());
    std::iota(result.begin(), result.end(), 0U);
    std::ranges::stable_sort(result, std::less(), [&](std::uint32_t i) { return m_stratum[i]; });
    return result;
  }

private:
  void find_components() {
    double mean = 0;
    double square = 0;
    const auto n = static_cast<double>(m_pixels.count());
    for (const float value : m_pixels.luminance) {
      const auto y = static_cast<double>(value);
      mean += y / n;
      square += y * y / n;
    }
    const double deviation = std::sqrt(std::max(0.0, square - mean * mean));
    for (int i = 0; i < threshold_count; ++i)
      divide(mean + i * deviation);
  }

  /// Adds the connected components above a threshold as strata.
  void divide(double threshold) {
    const auto first = static_cast<std::uint32_t>(m_strata.size());
    for (std::size_t i = 0; i < m_pixels.count(); ++i)
      if (is_new(i, first, threshold)) {
        m_strata.push_back({.parent = m_stratum[i]});
        flood(i, first, threshold);
      }
  }

  bool is_new(std::size_t pixel, std::uint32_t first, double threshold) const {
    return m_stratum[pixel]<first&& static_cast<double>(m_pixels.luminance[pixel])> threshold;
  }

  void flood(std::size_t seed, std::uint32_t first, double threshold) {
    const auto label = static_cast<std::uint32_t>(m_strata.size() - 1);
    m_stack.assign(1, seed);
    m_stratum[seed] = label;
    while (!m_stack.empty()) {
      const std::size_t pixel = m_stack.back();
      m_stack.pop_back();
      for (const std::size_t next : neighbours(pixel))
        if (is_new(next, first, threshold)) {
          m_stratum[next] = label;
          m_stack.push_back(next);
        }
    }
  }

  /// The four pixels that share an edge, on the square or across its folded boundary.
  std::array<std::size_t, 4> neighbours(std::size_t pixel) const {
    const auto size = static_cast<std::size_t>(m_pixels.size);
    const std::size_t x = pixel % size;
    const std::size_t y = pixel / size;
    const std::size_t last = size - 1;
    const std::size_t beside = (last - y) * size + x;
    const std::size_t above = y * size + last - x;
    return {x > 0 ? pixel - 1 : beside, x < last ? pixel + 1 : beside, y > 0 ? pixel - size : above,
            y < last ? pixel + size : above};
  }

  double importance(const Stratum& s) const {
    return s.importance(static_cast<double>(m_pixels.solid_angle));
  }

  /// Strata that would get less than half a light are merged into their parents.
  void merge_weak(double count) {
    double sum = 0;
    for (const Stratum& s : m_strata)
      sum += importance(s);
    std::vector<std::uint32_t> into(m_strata.size());
    std::iota(into.begin(), into.end(), 0U);
    for (std::size_t k = m_strata.size(); --k > 0;)
      if (count * importance(m_strata[k]) < 0.5 * sum) {
        Stratum& parent = m_strata[m_strata[k].parent];
        parent.energy += m_strata[k].energy;
        parent.pixels += m_strata[k].pixels;
        into[k] = m_strata[k].parent;
        m_strata[k].energy = 0;
        m_strata[k].pixels = 0;
      }
    for (std::size_t k = 1; k < into.size(); ++k)
      into[k] = into[into[k]];
    for (std::uint32_t& stratum : m_stratum)
      stratum = into[stratum];
  }

  /// Numbers of lights in proportion to importance (Webster's method), at most one per pixel.
  void distribute(std::size_t count) {
    using Candidate = std::pair<double, std::size_t>;
    std::priority_queue<Candidate> candidates;
    const auto add_candidate = [&](std::size_t k) {
      const Stratum& s = m_strata[k];
      if (s.lights < s.pixels && s.energy > 0)
        candidates.push({importance(s) / (static_cast<double>(s.lights) + 0.5), k});
    };
    for (std::size_t k = 0; k < m_strata.size(); ++k)
      add_candidate(k);
    for (std::size_t i = 0; i < count && !candidates.empty(); ++i) {
      const std::size_t k = candidates.top().second;
      candidates.pop();
      ++m_strata[k].lights;
      add_candidate(k);
    }
  }

  const LightPixels& m_pixels;
  std::vector<std::uint32_t> m_stratum; ///< of each pixel
  std::vector<Stratum> m_strata;        ///< those of higher thresholds later
  std::vector<std::size_t> m_stack;
};

/// Partitions strata by the farthest-point heuristic (Hochbaum and Shmoys 1985: the next centre is
/// the pixel farthest from all centres), beginning with the brightest stratum.
class Centres {
public:
  Centres(const LightPixels& pixels, const Stratification& stratification)
      : m_pixels(pixels), m_order(stratification.order()), m_regions(pixels.count(), none) {
    const std::vector<Stratum>& strata = stratification.strata();
    std::size_t end = pixels.count();
    for (std::size_t k = strata.size(); k-- > 0;) {
      const std::size_t begin = end - strata[k].pixels;
      place(std::span(m_order).subspan(begin, end - begin), strata[k].lights);
      end = begin;
    }
    for (std::size_t i = 0; i < pixels.count(); ++i)
      if (m_regions[i] == none)
        m_regions[i] = nearest(i);
  }

  std::vector<RepresentativeLight> lights() const {
    if (m_centres.empty())
      return {};
    return lights_of_regions(m_pixels, m_regions, m_centres.size());
  }

private:
  static constexpr std::uint32_t none = 0xffffffffU;

  void place(std::span<const std::uint32_t> stratum, std::size_t lights) {
    if (lights == 0)
      return;
    m_any.assign(stratum.size(), std::numeric_limits<float>::max());
    m_own.assign(stratum.size(), std::numeric_limits<float>::max());
    for (std::size_t j = 0; j < stratum.size(); ++j)
      for (const Vec3& centre : m_centres)
        m_any[j] = std::min(m_any[j], distance(stratum[j], centre));
    std::size_t next = m_centres.empty() ? brightest(stratum) : furthest();
    for (; lights > 0 && m_any[next] > 0; --lights) {
      add(stratum, m_pixels.directions[stratum[next]]);
      next = furthest();
    }
  }

  void add(std::span<const std::uint32_t> stratum, const Vec3& centre) {
    const auto label = static_cast<std::uint32_t>(m_centres.size());
    m_centres.push_back(centre);
    for (std::size_t j = 0; j < stratum.size(); ++j) {
      const float d = distance(stratum[j], centre);
      m_any[j] = std::min(m_any[j], d);
      if (d < m_own[j]) {
        m_own[j] = d;
        m_regions[stratum[j]] = label;
      }
    }
  }

  float distance(std::size_t pixel, const Vec3& centre) const {
    return (m_pixels.directions[pixel] - centre).squaredNorm();
  }

  std::size_t furthest() const {
    return static_cast<std::size_t>(std::ranges::max_element(m_any) - m_any.begin());
  }

  std::size_t brightest(std::span<const std::uint32_t> stratum) const {
    const auto found = std::ranges::max_element(
        stratum, std::less(), [&](std::uint32_t i) { return m_pixels.luminance[i]; });
    return static_cast<std::size_t>(found - stratum.begin());
  }

  /// Among all centres, for pixels whose stratum has none.
  std::uint32_t nearest(std::size_t pixel) const {
    const auto found = std::ranges::min_element(
        m_centres, std::less(), [&](const Vec3& centre) { return distance(pixel, centre); });
    return static_cast<std::uint32_t>(found - m_centres.begin());
  }

  const LightPixels& m_pixels;
  std::vector<std::uint32_t> m_order;
  std::vector<std::uint32_t> m_regions; ///< of each pixel, its centre
  std::vector<Vec3> m_centres;
  std::vector<float> m_any; ///< of each of a stratum's pixels, squared distance to any centre
  std::vector<float> m_own; ///< to the nearest in the stratum
};

} // namespace

std::unique_ptr<SamplerFactory> make_structured_factory(const LoadedScene& scene,
                                                        const SamplerOptions& options) {
  return representative_light_factory(
      scene.light(),
      [](const LightPixels& pixels, std::size_t count) {
        return Centres(pixels, Stratification(pixels, count)).lights();
      },
      options);
}

} // namespace haarlight::renderer
