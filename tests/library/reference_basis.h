#pragma once
// The published method apart from its products: coefficients of images and trees, and the theorems
// on integrals of products of Haar basis functions; slow and independent of the library's products.

#include <wavelet/reference/reference.h>
#include <wavelet/transform/transform.h>
#include <wavelet/tree/tree.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <span>
#include <vector>

namespace haarlight::wavelet::reference {

/// The scalar taken from a colour.
enum class Channel { Red, Green, Blue, Luminance };

inline std::size_t pixel_count(int size) {
  return static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
}

/// Calls `visit(square)` for every square that may have wavelets in a function of so many levels.
template <class Visit>
void for_each_wavelet_square(int levels, Visit visit) {
  for (std::int32_t l = 0; l < levels; ++l)
    for (std::uint32_t y = 0; y < (1U << l); ++y)
      for (std::uint32_t x = 0; x < (1U << l); ++x)
        visit(Square{l, x, y});
}

template <class T>
void insert(CoefficientSet<T>& function, const Square& s,
            const typename CoefficientSet<T>::Details& d) {
  if (d[0] != 0 || d[1] != 0 || d[2] != 0)
    function.details.emplace(s, d);
}

/// The scalar of a colour, in the precision asked for.
template <class T>
T scalar_of(Float4 c, Channel channel) {
  if (channel != Channel::Luminance)
    return static_cast<T>(c[static_cast<int>(channel)]);
  T result = 0;
  for (int i = 0; i < 3; ++i)
    result += static_cast<T>(luminance_weights[i]) * static_cast<T>(c[i]);
  return result;
}

template <class T>
void insert_nodes(const TreeView& tree, Channel channel, std::uint32_t node, const Square& s,
                  CoefficientSet<T>& function) {
  if (node == no_node)
    return;
  const Details d = tree.details(node);
  const T scale = std::ldexp(T(1), -s.level);
  insert(function, s,
         {scale * scalar_of<T>(d.d1, channel), scale * scalar_of<T>(d.d2, channel),
          scale * scalar_of<T>(d.d3, channel)});
  for (unsigned q = 0; q < 4; ++q)
    insert_nodes(tree, channel, tree.child(node, q), s.quadrant(q), function);
}

/// The coefficients of an image, by transform (section 5.2).
/// @param image size × size averages over pixels, row 0 first
/// @param size  a power of two
template <class T>
CoefficientSet<T> coefficient_set(std::span<const T> image, int size) {
  assert(image.size() == pixel_count(size));
  std::vector<T> differences(image.begin(), image.end());
  haar_forward(differences.data(), size, 1);
  CoefficientSet<T> result;
  result.levels = std::countr_zero(static_cast<unsigned>(size));
  result.root = differences[0];
  for_each_wavelet_square(result.levels, [&](const Square& s) {
    typename CoefficientSet<T>::Details d = {};
    for (int m = 1; m <= 3; ++m)
      d[static_cast<std::size_t>(m - 1)] =
          std::ldexp(differences[coefficient_index(size, s, m)], -s.level);
    insert(result, s, d);
  });
  return result;
}

/// The coefficients of a stored tree: F^m_s = 2^-l d_m for the tree's differences d_m.
template <class T>
CoefficientSet<T> coefficient_set(const TreeView& tree, Channel channel) {
  CoefficientSet<T> result;
  result.levels = tree.levels;
  result.root = scalar_of<T>(to_lanes(tree.mean), channel);
  insert_nodes(tree, channel, tree.root(), Square{}, result);
  return result;
}

/// The function as 2^level × 2^level averages over pixels, row 0 first, by inverse transform.
template <class T>
std::vector<T> image_of(const CoefficientSet<T>& function, int level) {
  assert(level >= 0 && level <= 13);
  const int size = 1 << level;
  std::vector<T> image(pixel_count(size));
  image[0] = function.root;
  for (const auto& [s, d] : function.details)
    if (s.level < level)
      for (int m = 1; m <= 3; ++m)
        image[coefficient_index(size, s, m)] =
            std::ldexp(d[static_cast<std::size_t>(m - 1)], s.level);
  haar_inverse(image.data(), size, 1);
  return image;
}

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

/// ⟨F, G⟩ = ∫∫ F·G = Σ_i F_i G_i, the basis being orthonormal. With T from multiply() of the fixed
/// functions this is the integral for one varying function (equation 14).
template <class T>
T inner_product(const CoefficientSet<T>& f, const CoefficientSet<T>& g) {
  const bool f_smaller = f.details.size() < g.details.size();
  const CoefficientSet<T>& small = f_smaller ? f : g;
  const CoefficientSet<T>& large = f_smaller ? g : f;
  T result = f.root * g.root;
  for (const auto& [s, d] : small.details)
    result += d[0] * large.at(s, 1) + d[1] * large.at(s, 2) + d[2] * large.at(s, 3);
  return result;
}

/// ∫∫ of the product of n functions, factored (equation 16): the inner product of the product of
/// the first k with that of the others. @param k 0 < k < n
template <class T>
T factored_integral(std::span<const CoefficientSet<T>> functions, std::size_t k) {
  return inner_product(multiply(functions.first(k)), multiply(functions.subspan(k)));
}

} // namespace haarlight::wavelet::reference
