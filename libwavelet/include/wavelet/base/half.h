#pragma once
// IEEE 754 half precision, four lanes at a time, without special instructions.

#include <wavelet/base/lanes.h>

#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace haarlight::wavelet {

/// Four finite halves as floats divided by half_unit; exact. Unused lanes may hold anything finite.
inline Float4 small_floats(const void* four_halves) {
  using Short8 = std::uint16_t __attribute__((vector_size(16)));
  using Long2 = std::uint64_t __attribute__((vector_size(16)));
  std::uint64_t raw = 0;
  std::memcpy(&raw, four_halves, sizeof raw);
  const auto halves = std::bit_cast<Short8>(Long2{raw, 0});
  const auto upper =
      std::bit_cast<Int4>(__builtin_shufflevector(Short8{}, halves, 0, 8, 1, 9, 2, 10, 3, 11));
  // The shift leaves three copies of the sign.
  return std::bit_cast<Float4>((upper >> 3) & static_cast<std::int32_t>(0x8fffffffU));
}

/// 2 to the difference of the exponent biases of the two formats.
inline constexpr float half_unit = 0x1p112F;

/// Four finite halves as floats, exact; unused lanes may hold anything finite.
inline Float4 halves_to_floats(const void* four_halves) {
  return small_floats(four_halves) * half_unit;
}

inline float half_to_float(std::uint16_t half) {
  const std::uint16_t four[4] = {half, 0, 0, 0};
  return halves_to_floats(four)[0];
}

/// True for the bit patterns of infinity and NaN.
inline bool half_is_special(std::uint16_t half) { return (half & 0x7c00U) == 0x7c00U; }

/// Nearest half, ties to even; |value| must be at most 65504.
inline std::uint16_t float_to_half(float value) {
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
