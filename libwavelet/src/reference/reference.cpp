#include <wavelet/reference/reference.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace haarlight::wavelet::reference {
namespace {

/// 2^l times a value.
template <class T>
T scaled(T value, int l) {
  return std::ldexp(value, l);
}

template <class T>
T dot(const std::array<T, 3>& a, const std::array<T, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

} // namespace

template <class T>
T ParentSums<T>::operator()(const Square& s) {
  if (const auto found = m_table.find(s); found != m_table.end())
    return found->second;
  T value = m_function->root;
  if (s.level > 0) {
    const Square above = s.parent();
    const auto d = m_function->at(above);
    T step = 0;
    for (int m = 1; m <= 3; ++m)
      step += d[static_cast<std::size_t>(m - 1)] * static_cast<T>(sign(m, s.index_in_parent()));
    value = (*this)(above) + scaled(step, above.level);
  }
  m_table.emplace(s, value);
  return value;
}

template <class T>
ChildrenSums<T>::ChildrenSums(const CoefficientSet<T>& g, const CoefficientSet<T>& h) {
  const bool g_smaller = g.details.size() < h.details.size(); // either will do to walk over
  const CoefficientSet<T>& walked = g_smaller ? g : h;
  const CoefficientSet<T>& other = g_smaller ? h : g;
  for (const auto& [s, d] : walked.details) {
    const T c = dot(d, other.at(s));
    if (c == 0)
      continue;
    for (int l = s.level; l >= 0; --l)
      m_table[s.ancestor(l)] += c;
  }
}

template <class T>
T Product<T>::coefficient(const Square& s, int m) {
  const int m1 = m % 3 + 1;
  const int m2 = (m + 1) % 3 + 1;
  const CoefficientSet<T>& g = *m_g;
  const CoefficientSet<T>& h = *m_h;
  // All at the same square, of different types.
  const T c1 = scaled(g.at(s, m1) * h.at(s, m2) + g.at(s, m2) * h.at(s, m1), s.level);
  // Two identical wavelets at strictly finer levels.
  T finer = 0;
  for (unsigned q = 0; q < 4; ++q)
    finer += static_cast<T>(sign(m, q)) * m_csum(s.quadrant(q));
  const T c2 = scaled(finer, s.level);
  // One identical to this wavelet, the other at coarser levels.
  const T c3 = g.at(s, m) * m_psum_h(s) + h.at(s, m) * m_psum_g(s);
  return c1 + c2 + c3;
}

template <class T>
T Product<T>::average(const Square& s) {
  return m_psum_g(s) * m_psum_h(s) + scaled(m_csum(s), 2 * s.level);
}

template <class T>
void Product<T>::insert(const Square& s, CoefficientSet<T>& result) {
  if (result.details.contains(s))
    return;
  const typename CoefficientSet<T>::Details d = {coefficient(s, 1), coefficient(s, 2),
                                                 coefficient(s, 3)};
  if (d[0] != 0 || d[1] != 0 || d[2] != 0)
    result.details.emplace(s, d);
}

template <class T>
CoefficientSet<T> Product<T>::coefficients() {
  CoefficientSet<T> result;
  result.levels = std::max(m_g->levels, m_h->levels);
  result.root = root();
  for (const auto& entry : m_g->details)
    insert(entry.first, result);
  for (const auto& entry : m_h->details)
    insert(entry.first, result);
  for (const auto& entry : m_csum.table())
    insert(entry.first, result);
  return result;
}

template <class T>
CoefficientSet<T> multiply(const CoefficientSet<T>& g, const CoefficientSet<T>& h) {
  return Product<T>(g, h).coefficients();
}

template <class T>
CoefficientSet<T> multiply(std::span<const CoefficientSet<T>> functions) {
  assert(!functions.empty());
  CoefficientSet<T> result = functions[0];
  for (const CoefficientSet<T>& next : functions.subspan(1))
    result = multiply(result, next);
  return result;
}

template class ParentSums<float>;
template class ParentSums<double>;
template class ChildrenSums<float>;
template class ChildrenSums<double>;
template class Product<float>;
template class Product<double>;
template CoefficientSet<float> multiply(const CoefficientSet<float>&, const CoefficientSet<float>&);
template CoefficientSet<double> multiply(const CoefficientSet<double>&,
                                         const CoefficientSet<double>&);
template CoefficientSet<float> multiply(std::span<const CoefficientSet<float>>);
template CoefficientSet<double> multiply(std::span<const CoefficientSet<double>>);

} // namespace haarlight::wavelet::reference
