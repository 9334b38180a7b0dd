#include "peaks.h"

#include <wavelet/parallel.h>

#include <algorithm>

namespace haarlight::probe {
namespace {

constexpr int reach = 2;
constexpr int neighbours = (2 * reach + 1) * (2 * reach + 1) - 1;
constexpr float brightest = 3; ///< times the mean of the neighbours

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

  float sum_around(int x, int y) const {
    float sum = 0;
    for (int j = -reach; j <= reach; ++j)
      for (int i = -reach; i <= reach; ++i)
        sum += i == 0 && j == 0 ? 0.0F : at(x + i, y + j);
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

/// Share of a pixel that stays in the base.
float base_share(const Probe& probe, const OwnLuminance& own, int x, int y) {
  const float value = luminance(probe.pixel(x, y));
  float around = own.sum_around(x, y);
  if (!probe.owns(x, y)) // a copy of one of those around, which must not justify it
    around = std::max(0.0F, around - value);
  const float limit = around * (brightest / neighbours);
  return value > limit ? limit / value : 1.0F;
}

SplitProbe split_row(const Probe& probe, const OwnLuminance& own, int y) {
  SplitProbe row;
  row.base.resize(4 * static_cast<std::size_t>(probe.width()));
  for (int x = 0; x < probe.width(); ++x) {
    const Rgb value = probe.pixel(x, y);
    const float share = base_share(probe, own, x, y);
    Eigen::Map<Rgb>(row.base.data() + 4 * static_cast<std::size_t>(x)) = share * value;
    if (share < 1)
      row.peaks.push_back({x, y, (1 - share) * value});
  }
  return row;
}

} // namespace

SplitProbe split_peaks(const Probe& probe) {
  const OwnLuminance own(probe);
  std::vector<SplitProbe> rows(static_cast<std::size_t>(probe.height()));
  parallel_for(rows.size(),
               [&](std::size_t y) { rows[y] = split_row(probe, own, static_cast<int>(y)); });
  SplitProbe all;
  all.base.reserve(rows.size() * 4 * static_cast<std::size_t>(probe.width()));
  for (auto& row : rows) {
    all.base.insert(all.base.end(), row.base.begin(), row.base.end());
    all.peaks.insert(all.peaks.end(), row.peaks.begin(), row.peaks.end());
    row = {};
  }
  return all;
}

} // namespace haarlight::probe
