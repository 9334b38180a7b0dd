#include <image/false_colour.h>

#include <image/contact_sheet.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace haarlight::image {
namespace {

constexpr int bar_height = 12;
constexpr int figures_height = 10; ///< below the bar

float larger_magnitude(float a, float b) { return std::abs(b) > std::abs(a) ? b : a; }

std::string figure_text(float value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%+.2g", static_cast<double>(value));
  return value == 0 ? "0" : text.data();
}

/// A bar of all colours with their values, over the lowest rows of a picture.
void draw_legend(Image& picture, float largest) {
  const int top = picture.height - bar_height - figures_height;
  for (int x = 0; x < picture.width; ++x) {
    const float t = 2 * (static_cast<float>(x) + 0.5F) / static_cast<float>(picture.width) - 1;
    for (int y = top + 2; y < top + bar_height; ++y)
      picture.set(x, y, false_colour(t));
  }
  for (int mark = -2; mark <= 2; ++mark) {
    const float t = 0.5F * static_cast<float>(mark);
    const std::string text = figure_text(t * t * t * largest);
    const int width = 6 * static_cast<int>(text.size());
    const int centre = (mark + 2) * picture.width / 4;
    const int left = std::clamp(centre - width / 2, 0, picture.width - width);
    draw_text(picture, left, picture.height - figures_height + 2, picture.width, 1, text);
  }
}

} // namespace

SignedField halved(const SignedField& field) {
  const auto width = static_cast<std::size_t>(field.size);
  SignedField half{field.size / 2, {}};
  for (std::size_t y = 0; y < width; y += 2)
    for (std::size_t x = 0; x < width; x += 2) {
      const float* v = field.values.data() + y * width + x;
      half.values.push_back(
          larger_magnitude(larger_magnitude(v[0], v[1]), larger_magnitude(v[width], v[width + 1])));
    }
  return half;
}

Rgb false_colour(float t) {
  const Rgb middle(1.0F, 0.15F, 0.05F);
  const Rgb end(1.0F, 0.9F, 0.3F);
  const float s = std::abs(t);
  const Rgb colour = s < 0.5F ? Rgb(2 * s * middle) : Rgb(middle + (2 * s - 1) * (end - middle));
  return t < 0 ? colour.reverse() : colour;
}

Image false_colour_picture(const SignedField& field, int scale) {
  float largest = 0;
  for (const float value : field.values)
    largest = std::max(largest, std::abs(value));
  const int side = scale * field.size;
  Image picture(side, side + bar_height + figures_height);
  for (int y = 0; y < side && largest > 0; ++y) {
    const auto row = static_cast<std::size_t>(y / scale) * static_cast<std::size_t>(field.size);
    for (int x = 0; x < side; ++x) {
      const float value = field.values[row + static_cast<std::size_t>(x / scale)];
      picture.set(x, y, false_colour(std::cbrt(value / largest)));
    }
  }
  draw_legend(picture, largest);
  return picture;
}

} // namespace haarlight::image
