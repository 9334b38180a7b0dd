#include <wavelet/tree/map_set.h>

#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace haarlight::wavelet {

Eigen::Array3d map_mean(const Map& map) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (std::size_t i = 0; i < map.rgb.size(); i += 3)
    sum += Eigen::Map<const Rgb>(map.rgb.data() + i).cast<double>();
  return sum / (static_cast<double>(map.size) * map.size);
}

Map halved(const Map& map) {
  assert(map.size >= 2);
  Map half(map.size / 2);
  for (int y = 0; y < half.size; ++y)
    for (int x = 0; x < half.size; ++x)
      half.set(x, y,
               0.25F * ((map.at(2 * x, 2 * y) + map.at(2 * x + 1, 2 * y)) +
                        (map.at(2 * x, 2 * y + 1) + map.at(2 * x + 1, 2 * y + 1))));
  return half;
}

namespace {

double luminance_of(const Eigen::Array3d& c) {
  return luminance_weights[0] * c[0] + luminance_weights[1] * c[1] + luminance_weights[2] * c[2];
}

} // namespace

ConservationMeter::ConservationMeter(const SetInfo& info)
    : m_columns(info.columns), m_pairs(static_cast<std::size_t>(info.map_count())) {}

void ConservationMeter::add(int column, int row, const Map& map, const std::optional<Rgb>& truth) {
  if (!truth)
    return;
  const double integral = luminance_of(map_mean(map)) * static_cast<double>(sphere_area);
  m_pairs[static_cast<std::size_t>(row) * static_cast<std::size_t>(m_columns) +
          static_cast<std::size_t>(column)] = {integral, luminance_of(truth->cast<double>()), true};
}

std::optional<Conservation> ConservationMeter::result() const {
  double map_sum = 0;
  double truth_sum = 0;
  for (const Pair& pair : m_pairs) {
    if (!pair.known)
      return std::nullopt;
    map_sum += pair.map;
    truth_sum += pair.truth;
  }
  Conservation result;
  if (truth_sum <= 0)
    return result;
  result.mean_error = map_sum / truth_sum - 1;
  const double floor = 0.1 * truth_sum / static_cast<double>(m_pairs.size());
  for (std::size_t i = 0; i < m_pairs.size(); ++i) {
    const double error =
        std::abs(m_pairs[i].map - m_pairs[i].truth) / std::max(m_pairs[i].truth, floor);
    if (error > result.largest_error) {
      result.largest_error = error;
      result.worst_column = static_cast<int>(i) % m_columns;
      result.worst_row = static_cast<int>(i) / m_columns;
    }
  }
  return result;
}

} // namespace haarlight::wavelet
