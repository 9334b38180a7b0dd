#include <renderer/film/points.h>

#include <wavelet/base/cpu_clones.h>
#include <wavelet/base/hash.h>

namespace haarlight::renderer {
namespace {

std::uint32_t reverse_bits(std::uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x & 0x0f0f0f0fU) << 4U) | ((x >> 4U) & 0x0f0f0f0fU);
  x = ((x & 0x33333333U) << 2U) | ((x >> 2U) & 0x33333333U);
  return ((x & 0x55555555U) << 1U) | ((x >> 1U) & 0x55555555U);
}

/// Owen's nested scrambling of a bit-reversed number by a hash whose bits depend on lower ones only
/// (Laine and Karras 2011, constants of Burley 2020).
std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cU;
  x ^= x * 0xb82f1e52U;
  x ^= x * 0xc7afe638U;
  return x ^ (x * 0x8d22f6e6U);
}

/// Second dimension of Sobol's sequence, bit-reversed: Pascal's triangle modulo 2 applied to the
/// index. As a polynomial over GF(2) with the index's bits as coefficients it is p(1 + x), found by
/// halves: with p = l + x^m h and m a power of two, p(1 + x) = l(1 + x) + (1 + x^m) h(1 + x).
std::uint32_t sobol_second_reversed(std::uint32_t index) {
  index ^= index >> 16U;
  index ^= (index >> 8U) & 0x00ff00ffU;
  index ^= (index >> 4U) & 0x0f0f0f0fU;
  index ^= (index >> 2U) & 0x33333333U;
  return index ^ ((index >> 1U) & 0x55555555U);
}

float to_unit(std::uint32_t bits) {
  return static_cast<float>(static_cast<std::int32_t>(bits >> 8U)) * 0x1p-24F;
}

Vec2 random_point(std::uint32_t key, std::uint32_t index) {
  const std::uint32_t a = hash_words(key, index);
  return {to_unit(a), to_unit(hash_bits(a + 0x9e3779b9U))};
}

/// Bits of integers only, so that all CPUs agree; as vectors they take a third of the time.
HAARLIGHT_CPU_CLONES void fill_sobol(std::uint32_t key, std::uint32_t first, std::span<Vec2> out) {
  const std::uint32_t seed_x = hash_words(key, 0x1234567U);
  const std::uint32_t seed_y = hash_words(key, 0x7654321U);
  const std::uint32_t seed_order = hash_words(key, 0x5f3759dU);
  for (std::size_t i = 0; i < out.size(); ++i) {
    // Nested: a permutation of whole aligned runs, within which runs half as long are permuted.
    const std::uint32_t place = reverse_bits(first + static_cast<std::uint32_t>(i));
    const std::uint32_t index = reverse_bits(scramble_reversed(place, seed_order));
    // The first dimension is the reversed index, so the index is the first dimension reversed.
    out[i] = {to_unit(reverse_bits(scramble_reversed(index, seed_x))),
              to_unit(reverse_bits(scramble_reversed(sobol_second_reversed(index), seed_y)))};
  }
}

} // namespace

std::uint32_t hash_words(std::uint32_t a, std::uint32_t b) {
  return hash_bits(hash_bits(a + 0x9e3779b9U) ^ (b * 0x85ebca6bU + 0xc2b2ae35U));
}

void fill_points(Points kind, std::uint32_t key, std::uint32_t first, std::span<Vec2> out) {
  if (kind == Points::Sobol)
    return fill_sobol(key, first, out);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = random_point(key, first + static_cast<std::uint32_t>(i));
}

} // namespace haarlight::renderer
