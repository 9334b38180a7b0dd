#include <wavelet/reference/reference.h>

#include <wavelet/transform/transform.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace haarlight::wavelet::reference {
namespace {

std::size_t pixel_count(int size) {
  return static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
}

/// Calls `visit(square)` for every square that may have wavelets in a function of so many levels.
template <class Visit>
void for_each_square(int levels, Visit visit) {
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

} // namespace

template <class T>
CoefficientSet<T> coefficient_set(std::span<const T> image, int size) {
  assert(image.size() == pixel_count(size));
  std::vector<T> differences(image.begin(), image.end());
  haar_forward(differences.data(), size, 1);
  CoefficientSet<T> result;
  result.levels = std::countr_zero(static_cast<unsigned>(size));
  result.root = differences[0];
  for_each_square(result.levels, [&](const Square& s) {
    typename CoefficientSet<T>::Details d = {};
    for (int m = 1; m <= 3; ++m)
      d[static_cast<std::size_t>(m - 1)] =
          std::ldexp(differences[coefficient_index(size, s, m)], -s.level);
    insert(result, s, d);
  });
  return result;
}

template <class T>
CoefficientSet<T> coefficient_set(const TreeView& tree, Channel channel) {
  CoefficientSet<T> result;
  result.levels = tree.levels;
  result.root = scalar_of<T>(to_lanes(tree.mean), channel);
  insert_nodes(tree, channel, tree.root(), Square{}, result);
  return result;
}

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

template CoefficientSet<float> coefficient_set(std::span<const float>, int);
template CoefficientSet<double> coefficient_set(std::span<const double>, int);
template CoefficientSet<float> coefficient_set(const TreeView&, Channel);
template CoefficientSet<double> coefficient_set(const TreeView&, Channel);
template std::vector<float> image_of(const CoefficientSet<float>&, int);
template std::vector<double> image_of(const CoefficientSet<double>&, int);

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

template <class T>
T inner_product(const CoefficientSet<T>& f, const CoefficientSet<T>& g) {
  const bool f_smaller = f.details.size() < g.details.size();
  const CoefficientSet<T>& small = f_smaller ? f : g;
  const CoefficientSet<T>& large = f_smaller ? g : f;
  T result = f.root * g.root;
  for (const auto& [s, d] : small.details)
    result += dot(d, large.at(s));
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
template float inner_product(const CoefficientSet<float>&, const CoefficientSet<float>&);
template double inner_product(const CoefficientSet<double>&, const CoefficientSet<double>&);

} // namespace haarlight::wavelet::reference
