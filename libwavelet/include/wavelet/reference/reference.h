#pragma once
// The algorithms of "Factoring of Multiple Function Wavelet Production Sampling" (Chen, Gao, Huang)
// as published, with printing errors corrected: hash tables of L2-normalised Haar coefficients.
// Meant to be read, and as the reference of faster code. The toolkit itself multiplies with
// <wavelet/product/synchronous_product.h>.
//
//     equation 17             CoefficientSet
//     Table 1, PSUM           ParentSums
//     Table 2, CSUM           ChildrenSums
//     Table 3, PRODUCT        Product::coefficient(), multiply()
//     Table 4, OPPRODUCT      Product::average()
//     equation 15             multiply() of many
//
// All functions are scalar (one channel) and live on the unit square; `T` is float or double.

#include <wavelet/square/square.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace haarlight::wavelet::reference {

struct SquareHash {
  std::size_t operator()(const Square& s) const {
    const auto key = (static_cast<std::uint64_t>(s.level) << 58U) ^
                     (static_cast<std::uint64_t>(s.column) << 29U) ^
                     static_cast<std::uint64_t>(s.row);
    const std::uint64_t mixed = key * 0x9e3779b97f4a7c15ULL;
    return static_cast<std::size_t>(mixed ^ (mixed >> 32U));
  }
};

/// sign(m, q) of section 4.5: of ψ^m over quadrant q = qx + 2 qy of its square. m = 1 is the
/// x-difference (+, −), m = 2 the y-difference, m = 3 the diagonal one, the product of the two;
/// m = 0, the scaling function, is positive.
inline int sign(int m, unsigned q) {
  const unsigned both = static_cast<unsigned>(m) & q;
  return 1 - 2 * static_cast<int>((both & 1U) ^ (both >> 1U));
}

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

/// PSUM (Table 1, after Ng et al. 2004): the average F(s) of a function over a square,
///     PSUM(root) = F⁰_root,   PSUM(s) = PSUM(s') + 2^(l−1) Σ_m sign(m, qx, qy) F^m_s',
/// s' being the parent of s at level l and (qx, qy) the quadrant that s is. (The paper prints 2^l
/// for the parent's 2^(l−1).) The memo is the function's own, which the paper's single psum_table
/// leaves open.
template <class T>
class ParentSums {
public:
  /// @param function must outlive this and not change
  explicit ParentSums(const CoefficientSet<T>& function) : m_function(&function) {}

  /// F(s), at any level; below the finest wavelets the function is constant.
  T operator()(const Square& s);

private:
  const CoefficientSet<T>* m_function;
  std::unordered_map<Square, T, SquareHash> m_table;
};

/// CSUM (Table 2): Σ G^m H^m over all wavelets on a square or under it. CsumHash adds every product
/// to its square and to each of that square's ancestors, the root included. (The paper's loop lacks
/// the start l' = l and the step of l'.) The root's scaling coefficients are no part of it.
template <class T>
class ChildrenSums {
public:
  /// CsumHash(G, H).
  ChildrenSums(const CoefficientSet<T>& g, const CoefficientSet<T>& h);

  /// CSUM(s): 0 where nothing is stored.
  T operator()(const Square& s) const {
    const auto found = m_table.find(s);
    return found == m_table.end() ? T(0) : found->second;
  }

  const std::unordered_map<Square, T, SquareHash>& table() const { return m_table; }

private:
  std::unordered_map<Square, T, SquareHash> m_table;
};

/// The product G·H of two functions, coefficient by coefficient or average by average.
template <class T>
class Product {
public:
  /// @param g,h must outlive this and not change
  Product(const CoefficientSet<T>& g, const CoefficientSet<T>& h)
      : m_g(&g), m_h(&h), m_psum_g(g), m_psum_h(h), m_csum(g, h) {}

  /// ∫∫ G·H = G⁰H⁰ + CSUM(root), the product's scaling coefficient at the root (before Table 3,
  /// which does not say that its s is the root).
  T root() const { return m_g->root * m_h->root + m_csum(Square{}); }

  /// PRODUCT (Table 3): the coefficient of ψ^m_s,
  ///     2^l (G^m1 H^m2 + G^m2 H^m1) + 2^l Σ_q sign(m, q) CSUM(child q) + G^m H(s) + H^m G(s),
  /// with m1 = (m mod 3) + 1 and m2 = ((m + 1) mod 3) + 1 the two other types. (The paper prints
  /// ((m + 1) mod 4) + 1 and ((m + 2) mod 4) + 1.)
  /// @param m 1, 2 or 3
  T coefficient(const Square& s, int m);

  /// OPPRODUCT (Table 4): the product's average over a square, G(s) H(s) + 4^l CSUM(s), which is
  /// all that sampling needs. (Equation 29, which this is 2^l times, has G^m H^m under its sum, not
  /// the printed F^m H^m.)
  T average(const Square& s);

  /// All of the product's coefficients. Those that may differ from zero lie on squares of G, of H,
  /// and on ancestors of squares of both.
  CoefficientSet<T> coefficients();

private:
  void insert(const Square& s, CoefficientSet<T>& result);

  const CoefficientSet<T>* m_g;
  const CoefficientSet<T>* m_h;
  ParentSums<T> m_psum_g;
  ParentSums<T> m_psum_h;
  ChildrenSums<T> m_csum;
};

/// The coefficients of G·H (equation 18).
template <class T>
CoefficientSet<T> multiply(const CoefficientSet<T>& g, const CoefficientSet<T>& h);

/// The product of n functions, one pairwise product after the other, exact up to rounding as
/// nothing is dropped on the way: the radiance transfer vector T of equation 15.
/// @param functions at least one
template <class T>
CoefficientSet<T> multiply(std::span<const CoefficientSet<T>> functions);

} // namespace haarlight::wavelet::reference
