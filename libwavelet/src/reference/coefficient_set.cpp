#include <wavelet/reference/coefficient_set.h>

#include <wavelet/transform/transform.h>

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
  for (int l = 0; l < levels; ++l)
    for (int y = 0; y < (1 << l); ++y)
      for (int x = 0; x < (1 << l); ++x)
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
  for (int q = 0; q < 4; ++q)
    insert_nodes(tree, channel, tree.child(node, static_cast<unsigned>(q)), child(s, q & 1, q >> 1),
                 function);
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
          std::ldexp(differences[coefficient_index(size, s.level, s.x, s.y, m)], -s.level);
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
        image[coefficient_index(size, s.level, s.x, s.y, m)] =
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

} // namespace haarlight::wavelet::reference
