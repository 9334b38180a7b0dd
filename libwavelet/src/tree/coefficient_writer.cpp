#include "tree/coefficient_writer.h"

#include <algorithm>
#include <cmath>

namespace haarlight::wavelet {
namespace {

/// Largest magnitude of a stored half coefficient: leaves room below the half's 65504.
constexpr int half_exponent = 15;

} // namespace

float coefficient_scale(CoefficientType type, float largest_difference) {
  if (type == CoefficientType::Float || largest_difference == 0)
    return 1;
  int exponent = 0;
  std::frexp(largest_difference, &exponent);
  return std::ldexp(1.0F, std::max(exponent - half_exponent, -100));
}

void CoefficientWriter::append(const Details& details) {
  for (const Float4& d : {details.d1, details.d2, details.d3}) {
    if (m_tree.channels == 1) {
      append_value(luminance(to_rgb(d)));
      continue;
    }
    for (int c = 0; c < 3; ++c)
      append_value(d[c]);
  }
}

void CoefficientWriter::append_value(float value) {
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

void CoefficientWriter::finish() { m_tree.coefficients.resize(m_tree.coefficients.size() + 8); }

} // namespace haarlight::wavelet
