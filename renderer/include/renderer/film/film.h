#pragma once
// The result of rendering: a picture and per-pixel statistics, as flat arrays. No I/O.

#include <wavelet/base/geometry.h>

#include <cstddef>
#include <string>
#include <vector>

namespace haarlight::renderer {

/// Maximum number of pixels of a film: its arrays then take 2.3 GiB.
inline constexpr long long film_pixels_max = 1LL << 26;

/// An error message for a film size that is not allowed; empty if it is.
inline std::string validate_film_size(long long width, long long height) {
  const std::string size = std::to_string(width) + "x" + std::to_string(height);
  if (width < 1 || height < 1)
    return "a film of " + size + " pixels has no area";
  if (width > film_pixels_max / height)
    return "a film of " + size + " pixels is too large, " + std::to_string(film_pixels_max) +
           " pixels are the limit";
  return {};
}

/// Row 0 is the top row, x runs to the right; pixel (x, y) has index y·width + x.
struct Film {
  int width = 0;
  int height = 0;
  std::vector<float> rgb; ///< 3 per pixel, linear Rec. 709, radiance in the probe's unit
  std::vector<float>
      normal; ///< 3 per pixel, world axes, towards the viewer; 0 for background pixels
  std::vector<float> pdf_sum;  ///< sum over the samples of their direction pdfs, sr⁻¹
  std::vector<float> variance; ///< estimated variance of the pixel's mean luminance
  std::vector<float> samples;  ///< light samples taken

  Film() = default;
  /// All zero. @param w,h a size that validate_film_size() accepts
  Film(int w, int h)
      : width(w), height(h), rgb(3 * count()), normal(3 * count()), pdf_sum(count()),
        variance(count()), samples(count()) {}

  std::size_t count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  Rgb color(std::size_t pixel) const { return Eigen::Map<const Rgb>(rgb.data() + 3 * pixel); }
  void set_color(std::size_t pixel, const Rgb& c) { Eigen::Map<Rgb>(rgb.data() + 3 * pixel) = c; }
  void set_normal(std::size_t pixel, const Vec3& n) {
    Eigen::Map<Vec3>(normal.data() + 3 * pixel) = n;
  }
};

} // namespace haarlight::renderer
