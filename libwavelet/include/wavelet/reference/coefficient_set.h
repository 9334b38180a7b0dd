#pragma once
// A scalar function on the unit square as a hash table of its non-zero Haar coefficients.

#include <wavelet/reference/square.h>
#include <wavelet/tree/tree.h>

#include <array>
#include <span>
#include <unordered_map>
#include <vector>

namespace haarlight::wavelet::reference {

/// F = F⁰_root φ_root + Σ_s Σ_m F^m_s ψ^m_s (equation 17), in the orthonormal basis of the unit
/// square: φ_s = 2^l and ψ^m_s = ±2^l on the square s at level l, so that coefficients are in the
/// unit of F, ∫∫ F = F⁰_root is the average, and ∫∫ F² the sum of all squares of coefficients.
template <class T>
struct CoefficientSet {
  /// F^1, F^2, F^3 of one square.
  using Details = std::array<T, 3>;

  int levels = 0; ///< squares of the finest wavelets have side 2^-(levels-1), or larger
  T root = 0;     ///< F⁰_root
  std::unordered_map<Square, Details, SquareHash> details; ///< squares not all zero

  /// All three of a square, zero where nothing is stored.
  Details at(const Square& s) const {
    const auto found = details.find(s);
    return found == details.end() ? Details{} : found->second;
  }

  /// F^m_s. @param m 1, 2 or 3
  T at(const Square& s, int m) const { return at(s)[static_cast<std::size_t>(m - 1)]; }
};

/// What of a colour is taken as the scalar.
enum class Channel { Red, Green, Blue, Luminance };

/// The coefficients of an image, by transform (section 5.2).
/// @param image size × size averages over pixels, row 0 first
/// @param size  a power of two
template <class T>
CoefficientSet<T> coefficient_set(std::span<const T> image, int size);

/// The coefficients of a stored tree: F^m_s = 2^-l d_m for the tree's differences d_m.
template <class T>
CoefficientSet<T> coefficient_set(const TreeView& tree, Channel channel);

/// The function as 2^level × 2^level averages over pixels, row 0 first, by inverse transform.
template <class T>
std::vector<T> image_of(const CoefficientSet<T>& function, int level);

} // namespace haarlight::wavelet::reference
