#pragma once
// Dense ways to what the reference algorithms find through coefficients: images of functions,
// multiplied and averaged pixel by pixel, in double.

#include "reference_basis.h"

#include <wavelet/reference/reference.h>
#include <wavelet/transform/transform.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

namespace reference_test {

using haarlight::wavelet::Square;
using haarlight::wavelet::reference::BasisFunction;
using haarlight::wavelet::reference::CoefficientSet;

using Image = std::vector<double>;

inline int side_of(const Image& image) {
  return static_cast<int>(std::lround(std::sqrt(static_cast<double>(image.size()))));
}

/// A basis function's pixels: wavelets by inverse transform of one difference.
inline Image basis_image(const BasisFunction& f, int size) {
  Image image(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  const int l = f.square.level;
  if (f.m > 0) {
    image[haarlight::wavelet::coefficient_index(size, f.square, f.m)] = std::ldexp(1.0, l);
    haarlight::wavelet::haar_inverse(image.data(), size, 1);
    return image;
  }
  const auto pixels = static_cast<std::uint32_t>(size);
  const std::uint32_t side = pixels >> static_cast<unsigned>(l);
  for (std::uint32_t j = f.square.row * side; j < (f.square.row + 1) * side; ++j)
    for (std::uint32_t i = f.square.column * side; i < (f.square.column + 1) * side; ++i)
      image[std::size_t{j} * pixels + i] = std::ldexp(1.0, l);
  return image;
}

/// Every function of the orthonormal basis of size × size images, the mother scaling function
/// first, with its image.
struct Basis {
  int size;
  std::vector<BasisFunction> functions;
  std::vector<Image> images;

  explicit Basis(int pixels) : size(pixels) {
    functions.push_back({});
    for (int l = 0; (1 << l) < size; ++l)
      for (std::uint32_t y = 0; y >> l == 0; ++y)
        for (std::uint32_t x = 0; x >> l == 0; ++x)
          for (int m = 1; m <= 3; ++m)
            functions.push_back({{l, x, y}, m});
    for (const BasisFunction& f : functions)
      images.push_back(basis_image(f, size));
  }

  std::size_t index_of(const BasisFunction& f) const {
    return static_cast<std::size_t>(std::find(functions.begin(), functions.end(), f) -
                                    functions.begin());
  }
};

inline Image times(Image a, const Image& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    a[i] *= b[i];
  return a;
}

inline Image product_image(std::span<const Image> images) {
  Image result = images[0];
  for (const Image& next : images.subspan(1))
    result = times(std::move(result), next);
  return result;
}

/// ∫∫ over the unit square.
inline double integral_of(const Image& image) {
  double sum = 0;
  for (const double value : image)
    sum += value;
  return sum / static_cast<double>(image.size());
}

/// ∫∫ of the product of two images.
inline double integral_of(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += a[i] * b[i];
  return sum / static_cast<double>(a.size());
}

/// Average of an image over a square no smaller than a pixel.
inline double average_of(const Image& image, const Square& s) {
  const auto size = static_cast<unsigned>(side_of(image));
  const unsigned side = size >> static_cast<unsigned>(s.level);
  double sum = 0;
  for (unsigned y = s.row * side; y < (s.row + 1) * side; ++y)
    for (unsigned x = s.column * side; x < (s.column + 1) * side; ++x)
      sum += image[y * size + x];
  return sum / (static_cast<double>(side) * side);
}

/// Calls `visit(square)` for every square from the root to the pixels of a 2^levels image.
template <class Visit>
void for_each_square(int levels, Visit visit) {
  for (int l = 0; l <= levels; ++l)
    for (unsigned y = 0; y < (1U << l); ++y)
      for (unsigned x = 0; x < (1U << l); ++x)
        visit(Square{l, x, y});
}

inline double largest(const Image& image) {
  double result = 0;
  for (const double value : image)
    result = std::max(result, std::abs(value));
  return result;
}

inline double largest_difference(const Image& a, const Image& b) {
  double result = a.size() == b.size() ? 0 : HUGE_VAL;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    result = std::max(result, std::abs(a[i] - b[i]));
  return result;
}

template <class T>
Image in_double(const std::vector<T>& image) {
  return Image(image.begin(), image.end());
}

/// A function like those that are multiplied: positive, rough, with a few bright pixels.
inline Image random_image(int size, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Image image(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (double& value : image)
    value = uniform(generator);
  for (int i = 0; i < size; i += 4)
    image[generator() % image.size()] += 30 * uniform(generator);
  return image;
}

template <class T>
CoefficientSet<T> set_of(const Image& image) {
  const std::vector<T> values(image.begin(), image.end());
  return haarlight::wavelet::reference::coefficient_set<T>(values, side_of(image));
}

/// A function of a few random coefficients.
/// @param type the wavelets' one type, or 0 for all
template <class T>
CoefficientSet<T> sparse_set(int levels, int wavelets, unsigned seed, int type = 0) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  CoefficientSet<T> result;
  result.levels = levels;
  result.root = static_cast<T>(uniform(generator) + 2);
  for (int i = 0; i < wavelets; ++i) {
    const int l = static_cast<int>(generator() % static_cast<unsigned>(levels));
    const unsigned side = 1U << static_cast<unsigned>(l);
    const auto column = static_cast<std::uint32_t>(generator() % side);
    const Square s = {l, column, static_cast<std::uint32_t>(generator() % side)};
    const auto m = type > 0 ? static_cast<unsigned>(type - 1) : generator() % 3;
    result.details[s][m] = static_cast<T>(std::ldexp(uniform(generator), -l));
  }
  return result;
}

} // namespace reference_test
