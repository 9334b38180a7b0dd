#include "maps/area_sum.h"

#include <wavelet/base/parallel.h>

#include <algorithm>

namespace haarlight::probe {

/// What a few pixels cover.
struct AreaSum::Group {
  std::vector<CoveredPixel> covered;
  std::vector<std::size_t> ends; ///< in covered, of each source pixel

  void clip(PixelCoverage coverage, std::span<const SourcePixel> pixels) {
    covered.clear();
    ends.clear();
    for (const SourcePixel& pixel : pixels) {
      coverage.append(pixel.x, pixel.y, covered);
      ends.push_back(covered.size());
    }
  }
};

AreaSum::AreaSum(int size)
    : m_size(size), m_rgb(3 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size)),
      m_covered(m_rgb.size() / 3) {}

void AreaSum::add(const PixelCoverage& coverage, std::span<const SourcePixel> pixels) {
  constexpr std::size_t batch = 4096;
  constexpr std::size_t group_size = 64;
  std::vector<Group> groups(std::min(batch / group_size, pixels.size() / group_size + 1));
  for (std::size_t begin = 0; begin < pixels.size(); begin += batch) {
    const auto part = pixels.subspan(begin, std::min(batch, pixels.size() - begin));
    parallel_for((part.size() + group_size - 1) / group_size, [&](std::size_t g) {
      const std::size_t from = g * group_size;
      groups[g].clip(coverage, part.subspan(from, std::min(group_size, part.size() - from)));
    });
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Group& group = groups[i / group_size];
      const std::size_t k = i % group_size;
      const std::size_t from = k == 0 ? 0 : group.ends[k - 1];
      add_covered(part[i].radiance, std::span(group.covered).subspan(from, group.ends[k] - from));
    }
  }
}

void AreaSum::add_covered(const Rgb& radiance, std::span<const CoveredPixel> covered) {
  for (const CoveredPixel& pixel : covered) {
    Eigen::Map<Rgb>(m_rgb.data() + 3 * std::size_t{pixel.index}) += pixel.fraction * radiance;
    m_covered[pixel.index] += pixel.fraction;
  }
}

Rgb AreaSum::mean(int x, int y, const Rgb& others, float layers) const {
  const std::size_t i = index(x, y);
  const float rest = std::max(0.0F, layers - m_covered[i]);
  const Rgb sum = Eigen::Map<const Rgb>(m_rgb.data() + 3 * i);
  return (sum + rest * others) / (m_covered[i] + rest);
}

Rgb AreaSum::covered_mean(int x, int y) const {
  const std::size_t i = index(x, y);
  const Rgb sum = Eigen::Map<const Rgb>(m_rgb.data() + 3 * i);
  return m_covered[i] > 0 ? Rgb(sum / m_covered[i]) : Rgb::Zero();
}

} // namespace haarlight::probe
