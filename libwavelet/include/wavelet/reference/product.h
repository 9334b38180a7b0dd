#pragma once
// Products of functions given as coefficient sets (section 4.5), and integrals of n of them
// (section 3.2).

#include <wavelet/reference/coefficient_set.h>

#include <span>
#include <unordered_map>

namespace haarlight::wavelet::reference {

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

/// ⟨F, G⟩ = ∫∫ F·G = Σ_i F_i G_i, the basis being orthonormal. With T from multiply() of the fixed
/// functions this is the integral for one varying function (equation 14).
template <class T>
T inner_product(const CoefficientSet<T>& f, const CoefficientSet<T>& g);

/// ∫∫ of the product of n functions, factored (equation 16): ⟨T1, T2⟩ with T1 the product of the
/// first k and T2 that of the others. All functions must share one frame.
/// @param k 0 < k < n
template <class T>
T factored_integral(std::span<const CoefficientSet<T>> functions, std::size_t k);

} // namespace haarlight::wavelet::reference
