#include "maps/peaks.h"

#include <wavelet/base/parallel.h>

#include <algorithm>

namespace haarlight::probe {
namespace {

constexpr int reach = 2;
constexpr int neighbours = (2 * reach + 1) * (2 * reach + 1) - 1;

/// Luminance of the pixels whose centre is in the map, black around them: pixels beyond the map may
/// be copies of one within.
class OwnLuminance {
public:
  explicit OwnLuminance(const Probe& probe)
      : m_width(probe.width() + 2 * reach),
        m_value(static_cast<std::size_t>(m_width) *
                static_cast<std::size_t>(probe.height() + 2 * reach)) {
    parallel_for(static_cast<std::size_t>(probe.height()), [&](std::size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < probe.width(); ++x)
        if (probe.owns(x, y))
          m_value[index(x, y)] = luminance(probe.pixel(x, y));
    });
  }

  float at(int x, int y) const { return m_value[index(x, y)]; }

  double sum_around(int x, int y) const {
    double sum = 0;
    for (int j = -reach; j <= reach; ++j)
      for (int i = -reach; i <= reach; ++i)
        sum += i == 0 && j == 0 ? 0.0 : at(x + i, y + j);
    return sum;
  }

private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y + reach) * static_cast<std::size_t>(m_width) +
           static_cast<std::size_t>(x + reach);
  }

  int m_width;
  std::vector<float> m_value;
};

bool is_peak(const Probe& probe, const OwnLuminance& own, int x, int y, double contrast) {
  const double value = luminance(probe.pixel(x, y));
  double around = own.sum_around(x, y);
  if (!probe.owns(x, y)) // a copy of one of those around, which must not justify it
    around = std::max(0.0, around - value);
  return value > around * (contrast / neighbours);
}

} // namespace

std::vector<PixelPlace> find_peaks(const Probe& probe, double contrast) {
  const OwnLuminance own(probe);
  std::vector<std::vector<PixelPlace>> rows(static_cast<std::size_t>(probe.height()));
  parallel_for(rows.size(), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < probe.width(); ++x)
      if (is_peak(probe, own, x, y, contrast))
        rows[row].push_back({x, y});
  });
  std::vector<PixelPlace> all;
  for (const auto& row : rows)
    all.insert(all.end(), row.begin(), row.end());
  return all;
}

float radiance_unit(const Probe& probe) {
  float largest = 0;
  for (int y = 0; y < probe.height(); ++y)
    for (int x = 0; x < probe.width(); ++x)
      largest = std::max(largest, probe.pixel(x, y).maxCoeff());
  return largest > 0x1p96F ? 0x1p32F : 1.0F;
}

} // namespace haarlight::probe
