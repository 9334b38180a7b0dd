#include <wavelet/reference/basis.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace haarlight::wavelet::reference {
namespace {

constexpr BasisFunction mother_scaling = {};

[[maybe_unused]] bool in_basis(const BasisFunction& f) { return f.m > 0 || f == mother_scaling; }

/// ±2^l, the value that a strictly coarser function at level l, or the mother scaling function, has
/// over all of a square; 0 if it has not one value other than 0 there.
double value_over(const BasisFunction& f, const Square& s) {
  if (f == mother_scaling)
    return 1;
  if (f.square.level >= s.level || !contains(f.square, s))
    return 0;
  return std::ldexp(sign_over(f.m, f.square, s), f.square.level);
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

} // namespace

double product_integral(std::span<const BasisFunction> functions) {
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
    if (!contains(f.square, finest))
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

double tripling_coefficient(const BasisFunction& i, const BasisFunction& j,
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

double scaling_tripling_coefficient(const Square& s, const BasisFunction& j,
                                    const BasisFunction& k) {
  assert(in_basis(j) && in_basis(k));
  if (j.m > 0 && j == k && contains(s, j.square))
    return std::ldexp(1.0, s.level);
  return std::ldexp(value_over(j, s) * value_over(k, s), -s.level);
}

template <class T>
double integral_by_theorem(std::span<const CoefficientSet<T>> functions) {
  return TupleSum<T>(functions).sum(1);
}

template double integral_by_theorem(std::span<const CoefficientSet<float>>);
template double integral_by_theorem(std::span<const CoefficientSet<double>>);

} // namespace haarlight::wavelet::reference
