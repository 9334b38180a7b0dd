#include "samplers/light_sums.h"

#include <wavelet/base/parallel.h>

#include <algorithm>
#include <numeric>

namespace haarlight::renderer {
namespace {

constexpr double all_units = 0x1p52; ///< so many or a little more: exact as double too

/// Where a place in the light of a range falls: the first step whose sum surpasses it, and how far
/// into that step it is.
struct Step {
  int index = 0;
  double fraction = 0;
};

/// @param sum_up_to light of the steps before a given one; grows from 0 at `begin`
template <class Sum>
Step find_step(int begin, int end, double u, Sum sum_up_to) {
  const double place = u * static_cast<double>(sum_up_to(end));
  int low = begin;
  int high = end;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (static_cast<double>(sum_up_to(middle)) <= place ? low : high) = middle;
  }
  const auto before = static_cast<double>(sum_up_to(low));
  const auto width = static_cast<double>(sum_up_to(high)) - before;
  return {low, width > 0 ? std::min((place - before) / width, 0x1.fffffep-1) : 0.5};
}

} // namespace

LightSums::LightSums(const probe::Probe& probe)
    : m_width(probe.width()), m_height(probe.height()),
      m_sums(static_cast<std::size_t>(m_width + 1) * static_cast<std::size_t>(m_height + 1)) {
  const auto width = static_cast<std::size_t>(m_width);
  std::vector<double> light(width * static_cast<std::size_t>(m_height));
  parallel_for(static_cast<std::size_t>(m_height), [&](std::size_t y) {
    for (int x = 0; x < m_width; ++x)
      light[y * width + static_cast<std::size_t>(x)] =
          probe.mean_luminance(x, static_cast<int>(y)) *
          probe.pixel_solid_angle(x, static_cast<int>(y));
  });
  const double total = std::accumulate(light.begin(), light.end(), 0.0);
  const double scale = total > 0 ? all_units / total : 0;
  for (std::size_t y = 0; y < static_cast<std::size_t>(m_height); ++y) {
    std::uint64_t row = 0;
    for (std::size_t x = 0; x < width; ++x) {
      const double units = light[y * width + x] * scale;
      row += units > 0 ? std::max<std::uint64_t>(1, static_cast<std::uint64_t>(units)) : 0;
      m_sums[(y + 1) * (width + 1) + x + 1] = m_sums[y * (width + 1) + x + 1] + row;
    }
  }
}

LightSums::Place LightSums::draw(const PixelRange& r, double u, double v) const {
  const Step column = find_step(r.x0, r.x1, u, [&](int x) { return sum({r.x0, r.y0, x, r.y1}); });
  const int x = column.index;
  const Step row = find_step(r.y0, r.y1, v, [&](int y) { return sum({x, r.y0, x + 1, y}); });
  const int y = row.index;
  return {Vec2(static_cast<float>((x + column.fraction) / m_width),
               static_cast<float>((y + row.fraction) / m_height)),
          sum({x, y, x + 1, y + 1})};
}

} // namespace haarlight::renderer
