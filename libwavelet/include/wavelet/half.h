#pragma once
// IEEE 754 half precision, four lanes at a time, without special instructions.

#include <wavelet/lanes.h>

#include <bit>
#include <cstdint>
#include <cstring>

namespace haarlight::wavelet {

/// Four finite halves as floats, exact; lanes beyond what is wanted may hold anything finite.
inline Float4 halves_to_floats(const void* four_halves) {
  using Short4 = std::uint16_t __attribute__((vector_size(8)));
  using Unsigned4 = std::uint32_t __attribute__((vector_size(16)));
  Short4 raw;
  std::memcpy(&raw, four_halves, sizeof raw);
  const Unsigned4 bits = __builtin_convertvector(raw, Unsigned4);
  const Float4 magnitude = std::bit_cast<Float4>((bits & 0x7fffU) << 13U) * 0x1p112F;
  return std::bit_cast<Float4>(std::bit_cast<Unsigned4>(magnitude) | ((bits & 0x8000U) << 16U));
}

inline float half_to_float(std::uint16_t half) {
  const std::uint16_t four[4] = {half, 0, 0, 0};
  return halves_to_floats(four)[0];
}

/// True for the bit patterns of infinity and NaN.
inline bool half_is_special(std::uint16_t half) { return (half & 0x7c00U) == 0x7c00U; }

/// Nearest half, ties to even; |value| must be at most 65504.
std::uint16_t float_to_half(float value);

} // namespace haarlight::wavelet
