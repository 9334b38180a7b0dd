#include "tree/tree_writer.h"

#include <algorithm>
#include <cmath>

namespace haarlight::wavelet {

float coefficient_scale(CoefficientType type, float largest_difference) {
  if (type == CoefficientType::Float || largest_difference == 0)
    return 1;
  constexpr int half_exponent = 15; // of largest_stored_half
  int exponent = 0;
  std::frexp(largest_difference, &exponent);
  return std::ldexp(1.0F, std::max(exponent - half_exponent, -100));
}

float largest_difference(const Details& d) {
  const Float4 all = larger(larger(absolute(d.d1), absolute(d.d2)), absolute(d.d3));
  return std::max({all[0], all[1], all[2]});
}

void TreeWriter::add(std::uint32_t children, const Details& details) {
  if (m_tree.channels == 1) {
    add(children, std::array<float, 3>{luminance(to_rgb(details.d1)), luminance(to_rgb(details.d2)),
                                       luminance(to_rgb(details.d3))});
    return;
  }
  m_links.add(children);
  for (const Float4& d : {details.d1, details.d2, details.d3})
    for (int c = 0; c < 3; ++c)
      append(d[c]);
}

void TreeWriter::add(std::uint32_t children, const std::array<float, 3>& differences) {
  m_links.add(children);
  for (const float value : differences)
    append(value);
}

void TreeWriter::append(float value) {
  auto& bytes = m_tree.coefficients;
  const std::size_t at = bytes.size();
  bytes.resize(at + coefficient_bytes(m_tree.type));
  if (m_tree.type == CoefficientType::Float) {
    std::memcpy(bytes.data() + at, &value, 4);
    return;
  }
  const std::uint16_t half = float_to_half(value / m_tree.scale);
  std::memcpy(bytes.data() + at, &half, 2);
}

void TreeWriter::finish() {
  m_links.finish();
  m_tree.coefficients.resize(m_tree.coefficients.size() + 8);
}

} // namespace haarlight::wavelet
