#pragma once
// Integrals of products of Haar basis functions, and sums over them: the theorems of the published
// method, slow and independent of the library's products.

#include <wavelet/reference/reference.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>
#include <vector>

namespace haarlight::wavelet::reference {

/// Sign over all of `inner` of the function of type m on `outer`. @param inner strictly finer than
/// `outer`, and within it
inline int sign_over(int m, const Square& outer, const Square& inner) {
  assert(outer.level < inner.level && outer.contains(inner));
  return sign(m, inner.ancestor(outer.level + 1).index_in_parent());
}

/// φ_s (m = 0) or ψ^m_s (m = 1, 2, 3); by default the mother scaling function.
struct BasisFunction {
  Square square;
  int m = 0;

  bool operator==(const BasisFunction&) const = default;
};

inline constexpr BasisFunction mother_scaling = {};

inline bool in_basis(const BasisFunction& f) { return f.m > 0 || f == mother_scaling; }

/// ±2^l, the value that a strictly coarser function at level l, or the mother scaling function, has
/// over all of a square; 0 if it has not one value other than 0 there.
inline double value_over(const BasisFunction& f, const Square& s) {
  if (f == mother_scaling)
    return 1;
  if (f.square.level >= s.level || !f.square.contains(s))
    return 0;
  return std::ldexp(sign_over(f.m, f.square, s), f.square.level);
}

/// ∫∫ of the product of n basis functions, the n-th order Haar integral coefficient (Generalized
/// Haar Integral Coefficient Theorem, section 4.2, after Sun and Mukherjee 2006).
///
/// Let the finest scale be j0, with n1, n2, n3 wavelets of the three types at that scale. The
/// integral is non-zero if and only if those all lie on one square, every other support contains
/// it, and n1 ≡ n2 ≡ n3 (mod 2); then it is ±2^(Σj − 2·j0), Σj the sum of all scales, and its sign
/// the product of the coarser functions' signs over that square. (The paper prints the exponent as
/// Σj − 2^j0, which is right for j0 = 1 and 2 only, and says nothing of the supports.) Scaling
/// functions at any scale take part, with type 0 and sign +, as equation 28 needs them.
/// @param functions any number; of none the integral is 1
inline double product_integral(std::span<const BasisFunction> functions) {
  if (functions.empty())
    return 1;
  const Square finest = std::max_element(functions.begin(), functions.end(),
                                         [](const BasisFunction& a, const BasisFunction& b) {
                                           return a.square.level < b.square.level;
                                         })
                            ->square;
  int scale_sum = 0;
  int sign_product = 1;
  unsigned odd[4] = {}; // by type: whether the number of functions at the finest scale is odd
  for (const BasisFunction& f : functions) {
    if (!f.square.contains(finest))
      return 0;
    scale_sum += f.square.level;
    if (f.square.level == finest.level)
      odd[f.m] ^= 1U;
    else
      sign_product *= sign_over(f.m, f.square, finest);
  }
  if (odd[1] != odd[2] || odd[2] != odd[3])
    return 0;
  return std::ldexp(sign_product, scale_sum - 2 * finest.level);
}

/// C_ijk of equation 20, by the three cases of the tripling coefficient theorem (Ng et al. 2004):
/// 1 if all are the mother scaling function; 2^l if three different wavelets share one square at
/// level l; ±2^l if two are the same wavelet and the third, at level l, is strictly coarser over it
/// or the mother scaling function (l = 0); else 0.
/// @param i,j,k wavelets or the mother scaling function
inline double tripling_coefficient(const BasisFunction& i, const BasisFunction& j,
                                   const BasisFunction& k) {
  assert(in_basis(i) && in_basis(j) && in_basis(k));
  if (i.m == 0 && j.m == 0 && k.m == 0)
    return 1;
  const bool one_square = i.square == j.square && j.square == k.square;
  if (one_square && i.m * j.m * k.m == 1 * 2 * 3)
    return std::ldexp(1.0, i.square.level);
  if (i.m > 0 && i == j)
    return value_over(k, i.square);
  if (i.m > 0 && i == k)
    return value_over(j, i.square);
  if (j.m > 0 && j == k)
    return value_over(i, j.square);
  return 0;
}

/// C'_ijk of equation 28, ∫∫ φ_s ψ_j ψ_k, by the two cases of section 4.4: ±2^(l_j + l_k − l) if
/// both are strictly coarser over s, or the mother scaling function; 2^l if they are the same
/// wavelet under s, at its level l or finer; else 0.
/// @param j,k wavelets or the mother scaling function
inline double scaling_tripling_coefficient(const Square& s, const BasisFunction& j,
                                           const BasisFunction& k) {
  assert(in_basis(j) && in_basis(k));
  if (j.m > 0 && j == k && s.contains(j.square))
    return std::ldexp(1.0, s.level);
  return std::ldexp(value_over(j, s) * value_over(k, s), -s.level);
}

/// Sums over all tuples, one function after the other.
template <class T>
class TupleSum {
public:
  explicit TupleSum(std::span<const CoefficientSet<T>> functions) : m_functions(functions) {}

  /// The share of all tuples that begin as m_tuple does. @param weight product of its coefficients
  double sum(double weight) {
    if (m_tuple.size() == m_functions.size())
      return weight * product_integral(m_tuple);
    const CoefficientSet<T>& next = m_functions[m_tuple.size()];
    double result = sum_with(mother_scaling, weight * static_cast<double>(next.root));
    for (const auto& [s, d] : next.details)
      for (int m = 1; m <= 3; ++m)
        result +=
            sum_with({s, m}, weight * static_cast<double>(d[static_cast<std::size_t>(m - 1)]));
    return result;
  }

private:
  double sum_with(const BasisFunction& f, double weight) {
    if (weight == 0)
      return 0;
    m_tuple.push_back(f);
    const double result = sum(weight);
    m_tuple.pop_back();
    return result;
  }

  std::span<const CoefficientSet<T>> m_functions;
  std::vector<BasisFunction> m_tuple;
};

/// ∫∫ of the product of n functions (equation 13): the sum over all n-tuples of coefficients of
/// their product with product_integral(). Takes the product of the numbers of coefficients in
/// steps: an oracle for small functions.
template <class T>
double integral_by_theorem(std::span<const CoefficientSet<T>> functions) {
  return TupleSum<T>(functions).sum(1);
}

/// ∫∫ of the product of n functions, factored (equation 16): the inner product of the product of
/// the first k with that of the others. @param k 0 < k < n
template <class T>
T factored_integral(std::span<const CoefficientSet<T>> functions, std::size_t k) {
  return inner_product(multiply(functions.first(k)), multiply(functions.subspan(k)));
}

} // namespace haarlight::wavelet::reference
