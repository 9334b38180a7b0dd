#pragma once
// Integer hash functions: bits that look random and are the same everywhere.

#include <cstdint>

namespace haarlight {

/// Bijection of 32 bits with low bias (Wellons, "lowbias32").
constexpr std::uint32_t hash_bits(std::uint32_t x) {
  x = (x ^ (x >> 16U)) * 0x7feb352dU;
  x = (x ^ (x >> 15U)) * 0x846ca68bU;
  return x ^ (x >> 16U);
}

inline constexpr std::uint64_t splitmix64_increment = 0x9e3779b97f4a7c15ULL;

/// SplitMix64 (Steele et al. 2014): the number that follows the state x. The next state is
/// x + splitmix64_increment.
constexpr std::uint64_t splitmix64(std::uint64_t x) {
  x += splitmix64_increment;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}

} // namespace haarlight
