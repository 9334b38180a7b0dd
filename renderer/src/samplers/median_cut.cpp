// Lamps for regions of equal energy (Debevec 2005, "A Median Cut Algorithm for Light Probe
// Sampling").

#include "samplers/representative_lights.h"
#include "samplers/sampler_factories.h"

#include <wavelet/base/trigonometry.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <queue>

namespace haarlight::renderer {
namespace {

/// A rectangle of the probe's latitude and longitude, and the pixels in it.
struct Region {
  std::size_t begin = 0; ///< in the order of pixels
  std::size_t end = 0;
  std::array<float, 2> low = {-pi, -0.5F * pi}; ///< longitude, latitude
  std::array<float, 2> high = {pi, 0.5F * pi};
  double energy = 0;
  int generation = 0;

  /// The longer side: 0 for longitude, whose circles are the shorter the nearer they are to a pole.
  int longer_side() const {
    float sine = 0;
    float cosine = 0;
    sine_cosine(0.5F * (low[1] + high[1]), sine, cosine);
    return (high[0] - low[0]) * cosine >= high[1] - low[1] ? 0 : 1;
  }
};

class MedianCut {
public:
  MedianCut(const LightPixels& pixels, std::size_t count)
      : m_pixels(pixels), m_order(pixels.count()), m_regions(Later{generations_of(count)}) {
    std::iota(m_order.begin(), m_order.end(), 0U);
    for (const Vec3& w : pixels.directions) {
      const float across = std::sqrt(w.x() * w.x() + w.z() * w.z());
      m_places.push_back({arctangent(w.x(), -w.z()), arctangent(w.y(), across)});
    }
    Region whole;
    whole.end = m_order.size();
    keep(whole);
    while (!m_regions.empty() && m_finished.size() + m_regions.size() < count)
      split_next();
  }

  std::vector<RepresentativeLight> lights() {
    for (; !m_regions.empty(); m_regions.pop())
      m_finished.push_back(m_regions.top());
    // The last region takes what is dark altogether and makes no lamp.
    std::vector<std::uint32_t> labels(m_pixels.count(),
                                      static_cast<std::uint32_t>(m_finished.size()));
    for (std::size_t k = 0; k < m_finished.size(); ++k)
      for (std::size_t i = m_finished[k].begin; i < m_finished[k].end; ++i)
        labels[m_order[i]] = static_cast<std::uint32_t>(k);
    return lights_of_regions(m_pixels, labels, m_finished.size() + 1);
  }

private:
  /// All regions are split as often as there are powers of two in the count, then the strongest.
  struct Later {
    int generations;
    bool operator()(const Region& a, const Region& b) const {
      const int round_a = std::min(a.generation, generations);
      const int round_b = std::min(b.generation, generations);
      if (round_a != round_b)
        return round_a > round_b;
      return a.energy != b.energy ? a.energy < b.energy : a.begin > b.begin;
    }
  };

  static int generations_of(std::size_t count) {
    int result = 0;
    while ((std::size_t{2} << static_cast<unsigned>(result)) <= count)
      ++result;
    return result;
  }

  float luminance(std::size_t place) const { return m_pixels.luminance[m_order[place]]; }

  void keep(Region region) {
    region.energy = 0;
    for (std::size_t i = region.begin; i < region.end; ++i)
      region.energy += static_cast<double>(luminance(i));
    if (!(region.energy > 0))
      return;
    if (region.end - region.begin > 1)
      m_regions.push(region);
    else
      m_finished.push_back(region);
  }

  void split_next() {
    Region first = m_regions.top();
    m_regions.pop();
    const auto side = static_cast<std::size_t>(first.longer_side());
    sort(first, side);
    Region second = first;
    first.generation = second.generation = first.generation + 1;
    first.end = second.begin = median(first);
    first.high[side] = second.low[side] =
        0.5F * (m_places[m_order[first.end - 1]][side] + m_places[m_order[second.begin]][side]);
    keep(first);
    keep(second);
  }

  void sort(const Region& region, std::size_t side) {
    const auto at = [&](std::size_t place) {
      return m_order.begin() + static_cast<std::ptrdiff_t>(place);
    };
    std::sort(at(region.begin), at(region.end), [&](std::uint32_t a, std::uint32_t b) {
      return m_places[a][side] != m_places[b][side] ? m_places[a][side] < m_places[b][side] : a < b;
    });
  }

  /// Where the sorted pixels' energy is halved most evenly, neither part being empty.
  std::size_t median(const Region& region) const {
    std::size_t place = region.begin;
    double sum = 0;
    while (sum + static_cast<double>(luminance(place)) < 0.5 * region.energy)
      sum += static_cast<double>(luminance(place++));
    const double beyond = sum + static_cast<double>(luminance(place));
    if (beyond - 0.5 * region.energy < 0.5 * region.energy - sum)
      ++place;
    return std::clamp(place, region.begin + 1, region.end - 1);
  }

  const LightPixels& m_pixels;
  std::vector<std::uint32_t> m_order;
  std::vector<std::array<float, 2>> m_places; ///< longitude and latitude of each pixel
  std::priority_queue<Region, std::vector<Region>, Later> m_regions;
  std::vector<Region> m_finished; ///< single pixels
};

} // namespace

std::unique_ptr<SamplerFactory> make_median_cut_factory(const LoadedScene& scene,
                                                        const SamplerOptions& options) {
  return representative_light_factory(
      scene.light(),
      [](const LightPixels& pixels, std::size_t count) {
        return MedianCut(pixels, count).lights();
      },
      options);
}

} // namespace haarlight::renderer
