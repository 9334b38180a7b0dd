#include <wavelet/base/half.h>

#include <cassert>
#include <cmath>

namespace haarlight::wavelet {

std::uint16_t float_to_half(float value) {
  assert(std::abs(value) <= 65504.0F);
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t sign = (bits >> 16U) & 0x8000U;
  const float magnitude = std::abs(value);
  if (magnitude < 0x1p-14F) { // subnormal half: the unit is 2^-24, and adding 2^-1 rounds to it
    const float rounded = magnitude + 0.5F;
    return static_cast<std::uint16_t>(sign | (std::bit_cast<std::uint32_t>(rounded) - 0x3f000000U));
  }
  const std::uint32_t m = bits & 0x7fffffffU;
  const std::uint32_t rounded = m + 0xfffU + ((m >> 13U) & 1U);
  return static_cast<std::uint16_t>(sign | ((rounded - 0x38000000U) >> 13U));
}

} // namespace haarlight::wavelet
