#include <bench/pictures.h>

#include <html/png_uri.h>

#include <image/false_colour.h>
#include <image/png.h>

#include <algorithm>
#include <cmath>

namespace haarlight::bench {
namespace {

constexpr int shown_at_most = 128;

Image cropped(const Image& picture, const Crop& crop) {
  Image result(crop.width, crop.height);
  for (int y = 0; y < crop.height; ++y)
    for (int x = 0; x < crop.width; ++x)
      result.set(x, y, picture.at(crop.x + x, crop.y + y));
  return result;
}

float root_with_sign(float value) { return std::copysign(std::sqrt(std::abs(value)), value); }

bool hit(const PairResult& pair, int x, int y) { return pair.hit[pair.reference.offset(x, y) / 3]; }

/// 1 % of the mean luminance of the pixels that hit an object.
float floor_of(const PairResult& pair) {
  double sum = 0;
  double count = 0;
  for (int y = 0; y < pair.reference.height; ++y)
    for (int x = 0; x < pair.reference.width; ++x)
      if (hit(pair, x, y)) {
        sum += static_cast<double>(luminance(pair.reference.at(x, y)));
        ++count;
      }
  return static_cast<float>(0.01 * sum / std::max(1.0, count));
}

} // namespace

Crop crop_of(const Image& picture) {
  const int width = std::min(shown_at_most, picture.width);
  const int height = std::min(shown_at_most, picture.height);
  return {(picture.width - width) / 2, (picture.height - height) / 2, width, height};
}

std::string picture_uri(const PairResult& pair, const Image& picture) {
  const Crop crop = crop_of(pair.reference);
  const float gain = image::middle_grey_gain(cropped(pair.reference, crop));
  return html::png_uri(cropped(picture, crop),
                       {std::log2(static_cast<double>(gain)), image::ToneMap::Filmic});
}

std::string error_uri(const PairResult& pair, const Image& picture) {
  const Crop crop = crop_of(pair.reference);
  const float floor = floor_of(pair);
  Image map(crop.width, crop.height);
  for (int y = 0; y < crop.height; ++y)
    for (int x = 0; x < crop.width; ++x) {
      const float truth = luminance(pair.reference.at(crop.x + x, crop.y + y));
      const float error = luminance(picture.at(crop.x + x, crop.y + y)) - truth;
      const float scale = std::max(std::hypot(truth, floor), 1e-30F);
      map.set(x, y,
              hit(pair, crop.x + x, crop.y + y)
                  ? image::false_colour(std::clamp(root_with_sign(error / scale), -1.0F, 1.0F))
                  : Rgb::Ones());
    }
  return html::png_uri(map);
}

std::string legend_uri() {
  Image bar(201, 1);
  for (int x = 0; x < bar.width; ++x)
    bar.set(x, 0, image::false_colour(static_cast<float>(x - 100) / 100));
  return html::png_uri(bar);
}

} // namespace haarlight::bench
