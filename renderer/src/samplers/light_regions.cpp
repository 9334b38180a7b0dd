// Representative lights for regions of the sphere:
// - `median-cut`: rectangles of latitude and longitude with equal energy (Debevec 2005, "A Median
// Cut
//   Algorithm for Light Probe Sampling");
// - `kollig-keller`: Voronoi cells of Lloyd's relaxation, weighted by luminance, with sites added
// step
//   by step where the energy is (Kollig and Keller 2003, "Efficient Illumination by High Dynamic
//   Range Images").

#include "samplers/representative_lights.h"
#include "samplers/sampler_factories.h"

#include <wavelet/base/parallel.h>
#include <wavelet/base/trigonometry.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <queue>

namespace haarlight::renderer {
namespace {

/// A rectangle of latitude and longitude, and its pixels.
struct LatLongRegion {
  std::size_t begin = 0; ///< in the order of pixels
  std::size_t end = 0;
  std::array<float, 2> low = {-pi, -0.5F * pi}; ///< longitude, latitude
  std::array<float, 2> high = {pi, 0.5F * pi};
  double energy = 0;
  int generation = 0;

  /// The longer side: 0 for longitude, scaled by the cosine of the latitude, 1 for latitude.
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
    LatLongRegion whole;
    whole.end = m_order.size();
    keep(whole);
    while (!m_regions.empty() && m_finished.size() + m_regions.size() < count)
      split_next();
  }

  std::vector<RepresentativeLight> lights() {
    for (; !m_regions.empty(); m_regions.pop())
      m_finished.push_back(m_regions.top());
    // The last region takes black pixels and yields no light.
    std::vector<std::uint32_t> labels(m_pixels.count(),
                                      static_cast<std::uint32_t>(m_finished.size()));
    for (std::size_t k = 0; k < m_finished.size(); ++k)
      for (std::size_t i = m_finished[k].begin; i < m_finished[k].end; ++i)
        labels[m_order[i]] = static_cast<std::uint32_t>(k);
    return lights_of_regions(m_pixels, labels, m_finished.size() + 1);
  }

private:
  /// All regions are split ⌊log₂ count⌋ times, then those of the greatest energy.
  struct Later {
    int generations;
    bool operator()(const LatLongRegion& a, const LatLongRegion& b) const {
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

  void keep(LatLongRegion region) {
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
    LatLongRegion first = m_regions.top();
    m_regions.pop();
    const auto side = static_cast<std::size_t>(first.longer_side());
    sort(first, side);
    LatLongRegion second = first;
    first.generation = second.generation = first.generation + 1;
    first.end = second.begin = median(first);
    first.high[side] = second.low[side] =
        0.5F * (m_places[m_order[first.end - 1]][side] + m_places[m_order[second.begin]][side]);
    keep(first);
    keep(second);
  }

  void sort(const LatLongRegion& region, std::size_t side) {
    const auto at = [&](std::size_t place) {
      return m_order.begin() + static_cast<std::ptrdiff_t>(place);
    };
    std::sort(at(region.begin), at(region.end), [&](std::uint32_t a, std::uint32_t b) {
      return m_places[a][side] != m_places[b][side] ? m_places[a][side] < m_places[b][side] : a < b;
    });
  }

  /// The position that halves the sorted pixels' energy best; neither part is empty.
  std::size_t median(const LatLongRegion& region) const {
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
  std::priority_queue<LatLongRegion, std::vector<LatLongRegion>, Later> m_regions;
  std::vector<LatLongRegion> m_finished; ///< single pixels
};

constexpr int rounds_between_splits = 4;
constexpr int rounds_at_last = 16;

/// A block of pixels, which share a list of candidate sites.
struct Block {
  Vec3 centre;
  float reach = 0; ///< the longest chord from the centre to a pixel
};

class Relaxation {
public:
  explicit Relaxation(const LightPixels& pixels)
      : m_pixels(pixels), m_block_side(std::min(8, pixels.size)),
        m_blocks_across(pixels.size / m_block_side), m_cells(pixels.count()) {
    const auto blocks =
        static_cast<std::size_t>(m_blocks_across) * static_cast<std::size_t>(m_blocks_across);
    for (std::size_t b = 0; b < blocks; ++b)
      m_blocks.push_back(bounds_of(b));
  }

  std::vector<RepresentativeLight> lights(std::size_t count) {
    Centroid whole;
    for (std::size_t i = 0; i < m_pixels.count(); ++i)
      whole.add(m_pixels.directions[i], m_pixels.luminance[i]);
    if (!(whole.weight() > 0))
      return {};
    m_sites.assign(1, whole.direction());
    while (m_sites.size() < count && split(count))
      relax(rounds_between_splits);
    relax(rounds_at_last);
    assign();
    return lights_of_regions(m_pixels, m_cells, m_sites.size());
  }

private:
  template <class Visit>
  void for_each_pixel(std::size_t block, Visit visit) const {
    const int x0 = static_cast<int>(block) % m_blocks_across * m_block_side;
    const int y0 = static_cast<int>(block) / m_blocks_across * m_block_side;
    for (int y = y0; y < y0 + m_block_side; ++y)
      for (int x = x0; x < x0 + m_block_side; ++x)
        visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(m_pixels.size) +
              static_cast<std::size_t>(x));
  }

  Block bounds_of(std::size_t block) const {
    Vec3 sum = Vec3::Zero();
    for_each_pixel(block, [&](std::size_t i) { sum += m_pixels.directions[i]; });
    Block result{sum.norm() > 1e-3F ? sum.normalized() : Vec3(Vec3::UnitZ())};
    for_each_pixel(block, [&](std::size_t i) {
      result.reach = std::max(result.reach, (m_pixels.directions[i] - result.centre).norm());
    });
    return result;
  }

  void relax(int rounds) {
    for (int i = 0; i < rounds; ++i) {
      assign();
      move();
    }
  }

  /// Assigns every pixel to the nearest site.
  void assign() {
    parallel_ranges(m_blocks.size(), 64, [&](std::size_t begin, std::size_t end) {
      std::vector<float> distances(m_sites.size());
      std::vector<std::uint32_t> near;
      for (std::size_t b = begin; b < end; ++b) {
        find_near(m_blocks[b], distances, near);
        for_each_pixel(b, [&](std::size_t i) { m_cells[i] = nearest(i, near); });
      }
    });
  }

  /// Candidate sites of a block's pixels, by the triangle inequality: all within the distance of
  /// the block's nearest site plus twice the block's radius.
  void find_near(const Block& block, std::vector<float>& distances,
                 std::vector<std::uint32_t>& near) const {
    float least = std::numeric_limits<float>::max();
    for (std::size_t k = 0; k < m_sites.size(); ++k) {
      distances[k] = (m_sites[k] - block.centre).squaredNorm();
      least = std::min(least, distances[k]);
    }
    const float limit = std::sqrt(least) + 2 * block.reach + 1e-5F;
    near.clear();
    for (std::size_t k = 0; k < m_sites.size(); ++k)
      if (distances[k] <= limit * limit)
        near.push_back(static_cast<std::uint32_t>(k));
  }

  std::uint32_t nearest(std::size_t pixel, const std::vector<std::uint32_t>& near) const {
    float least = std::numeric_limits<float>::max();
    std::uint32_t result = 0;
    for (const std::uint32_t k : near) {
      const float distance = squared_distance(pixel, k);
      if (distance < least) {
        least = distance;
        result = k;
      }
    }
    return result;
  }

  float squared_distance(std::size_t pixel, std::uint32_t site) const {
    return (m_pixels.directions[pixel] - m_sites[site]).squaredNorm();
  }

  /// Moves sites to the centroids of their cells, and removes sites with black cells.
  void move() {
    std::vector<Centroid> centroids(m_sites.size());
    for (std::size_t i = 0; i < m_pixels.count(); ++i)
      centroids[m_cells[i]].add(m_pixels.directions[i], m_pixels.luminance[i]);
    m_sites.clear();
    for (const Centroid& c : centroids)
      if (c.weight() > 0)
        m_sites.push_back(c.direction());
  }

  /// A cell's energy, and the pixel with the greatest contribution to its moment of inertia.
  struct Spread {
    double energy = 0;
    float inertia = 0;
    std::size_t pixel = 0;
  };

  /// Adds sites to the cells of greatest energy: half as many as there are, up to `count` in total.
  /// @return whether any cell could be split
  bool split(std::size_t count) {
    assign();
    std::vector<Spread> spreads(m_sites.size());
    for (std::size_t i = 0; i < m_pixels.count(); ++i)
      measure(i, spreads[m_cells[i]]);
    std::erase_if(spreads, [](const Spread& s) { return !(s.inertia > 0); });
    std::ranges::stable_sort(spreads, std::greater(), &Spread::energy);
    const std::size_t room = std::min(count - m_sites.size(), (m_sites.size() + 1) / 2);
    spreads.resize(std::min(spreads.size(), room));
    for (const Spread& s : spreads)
      m_sites.push_back(m_pixels.directions[s.pixel]);
    return !spreads.empty();
  }

  void measure(std::size_t pixel, Spread& spread) const {
    const float weight = m_pixels.luminance[pixel];
    spread.energy += static_cast<double>(weight);
    // The centroid of a single pixel differs from it by rounding.
    const float distance = squared_distance(pixel, m_cells[pixel]);
    const float inertia = distance > 1e-10F ? weight * distance : 0;
    if (inertia > spread.inertia) {
      spread.inertia = inertia;
      spread.pixel = pixel;
    }
  }

  const LightPixels& m_pixels;
  int m_block_side;
  int m_blocks_across;
  std::vector<Block> m_blocks;
  std::vector<Vec3> m_sites;
  std::vector<std::uint32_t> m_cells; ///< of each pixel, its site
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

std::unique_ptr<SamplerFactory> make_kollig_keller_factory(const LoadedScene& scene,
                                                           const SamplerOptions& options) {
  return representative_light_factory(
      scene.light(),
      [](const LightPixels& pixels, std::size_t count) { return Relaxation(pixels).lights(count); },
      options);
}

} // namespace haarlight::renderer
