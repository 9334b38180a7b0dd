#pragma once
// Integrals of products of Haar basis functions, and sums over them: slow and sure.

#include <wavelet/reference/coefficient_set.h>

#include <span>

namespace haarlight::wavelet::reference {

/// φ_s (m = 0) or ψ^m_s (m = 1, 2, 3); by default the mother scaling function.
struct BasisFunction {
  Square square;
  int m = 0;

  bool operator==(const BasisFunction&) const = default;
};

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
double product_integral(std::span<const BasisFunction> functions);

/// C_ijk of equation 20, by the three cases of the tripling coefficient theorem (Ng et al. 2004):
/// 1 if all are the mother scaling function; 2^l if three different wavelets share one square at
/// level l; ±2^l if two are the same wavelet and the third, at level l, is strictly coarser over it
/// or the mother scaling function (l = 0); else 0.
/// @param i,j,k wavelets or the mother scaling function
double tripling_coefficient(const BasisFunction& i, const BasisFunction& j, const BasisFunction& k);

/// C'_ijk of equation 28, ∫∫ φ_s ψ_j ψ_k, by the two cases of section 4.4: ±2^(l_j + l_k − l) if
/// both are strictly coarser over s, or the mother scaling function; 2^l if they are the same
/// wavelet under s, at its level l or finer; else 0.
/// @param j,k wavelets or the mother scaling function
double scaling_tripling_coefficient(const Square& s, const BasisFunction& j,
                                    const BasisFunction& k);

/// ∫∫ of the product of n functions (equation 13): the sum over all n-tuples of coefficients of
/// their product with product_integral(). Takes the product of the numbers of coefficients in
/// steps: an oracle for small functions.
template <class T>
double integral_by_theorem(std::span<const CoefficientSet<T>> functions);

} // namespace haarlight::wavelet::reference
