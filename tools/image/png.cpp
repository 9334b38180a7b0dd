#include <image/png.h>

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>
#include <wavelet/file/output_file.h>

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace haarlight::image {
namespace {

double linear_of(double code) {
  const double value = code / 255;
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

/// Linear values halfway (in codes) between neighbouring codes.
std::array<float, 255> make_thresholds() {
  std::array<float, 255> thresholds{};
  for (std::size_t i = 0; i < thresholds.size(); ++i)
    thresholds[i] = static_cast<float>(linear_of(static_cast<double>(i) + 0.5));
  return thresholds;
}

float filmic(float x) {
  return x <= 0 ? 0 : (x * (2.51F * x + 0.03F)) / (x * (2.43F * x + 0.59F) + 0.14F);
}

png_image description(int width, int height) {
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  return image;
}

/// Frees libpng's state for an image that is being read.
struct Cleaner {
  png_image& image;
  explicit Cleaner(png_image& owned) : image(owned) {}
  ~Cleaner() { png_image_free(&image); }
  Cleaner(const Cleaner&) = delete;
  Cleaner& operator=(const Cleaner&) = delete;
};

constexpr std::uint64_t most_pixels = std::uint64_t{1} << 28;
constexpr std::uint64_t png_deflate_ratio = 1032; ///< most bytes per compressed byte (zlib)

/// Refuses pictures whose pixels the file cannot hold, before they are allocated.
/// @param image of a file whose header libpng has read
void check_png_size(const InputFile& file, const png_image& image) {
  const std::uint64_t width = image.width;
  if (width * image.height > most_pixels)
    throw_input_error(file.path(), "has more than 2^28 pixels");
  // The header chunk IHDR comes first: width, height at byte 16, then bits and type of a pixel.
  const auto bits = std::to_integer<std::uint64_t>(file.bytes()[24]);
  constexpr std::array<std::uint64_t, 7> channels = {1, 1, 3, 1, 2, 1, 4};
  const auto type = std::to_integer<std::size_t>(file.bytes()[25]);
  const std::uint64_t raw = image.height * ((width * bits * channels[type % 7] + 7) / 8);
  if (raw / png_deflate_ratio > file.bytes().size())
    throw_input_error(file.path(), "is too short for its " + std::to_string(width) + " x " +
                                       std::to_string(image.height) + " pixels");
}

} // namespace

float middle_grey_gain(const Image& picture) {
  double sum = 0;
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3)
    sum += std::max(0.0,
                    static_cast<double>(luminance(Eigen::Map<const Rgb>(picture.rgb.data() + i))));
  return sum > 0 ? static_cast<float>(0.06 * static_cast<double>(picture.rgb.size()) / sum) : 1.0F;
}

void brighten(Image& picture, float gain) {
  for (float& value : picture.rgb)
    value *= gain;
}

void tone_map(Image& picture, const PngOptions& options) {
  const auto gain = static_cast<float>(std::exp2(options.exposure));
  for (float& value : picture.rgb) {
    const float exposed = std::clamp(value * gain, 0.0F, 1e6F);
    value = std::min(options.tone_map == ToneMap::Filmic ? filmic(exposed) : exposed, 1.0F);
  }
}

unsigned char srgb_code(float linear) {
  static const std::array<float, 255> thresholds = make_thresholds();
  if (!(linear > 0))
    return 0;
  const auto place = std::upper_bound(thresholds.begin(), thresholds.end(), linear);
  return static_cast<unsigned char>(place - thresholds.begin());
}

float srgb_value(unsigned char code) { return static_cast<float>(linear_of(code)); }

std::string png_bytes(const Image& picture, const PngOptions& options) {
  png_image image = description(picture.width, picture.height);
  Image toned = picture;
  tone_map(toned, options);
  std::vector<unsigned char> codes(toned.rgb.size());
  std::transform(toned.rgb.begin(), toned.rgb.end(), codes.begin(), srgb_code);
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string encoded(size, '\0');
  if (png_image_write_to_memory(&image, encoded.data(), &size, 0, codes.data(), 0, nullptr) == 0)
    throw_output_error({}, std::string("cannot be encoded as PNG: ") + image.message);
  encoded.resize(size);
  return encoded;
}

void write_png(const std::string& path, const Image& picture, const PngOptions& options) {
  OutputFile file(path);
  const std::string encoded = png_bytes(picture, options);
  file.write(encoded.data(), encoded.size());
  file.commit();
}

Image read_png(const std::string& path) {
  const InputFile file(path);
  png_image image = description(0, 0);
  const Cleaner cleaner(image);
  if (png_image_begin_read_from_memory(&image, file.bytes().data(), file.bytes().size()) == 0)
    throw_input_error(path, std::string("is no PNG image: ") + image.message);
  check_png_size(file, image);
  image.format = PNG_FORMAT_RGB;
  const png_color black = {0, 0, 0};
  std::vector<unsigned char> codes(PNG_IMAGE_SIZE(image));
  if (png_image_finish_read(&image, &black, codes.data(), 0, nullptr) == 0 ||
      PNG_IMAGE_FAILED(image))
    throw_input_error(path, std::string("cannot be decoded: ") + image.message);
  Image picture(static_cast<int>(image.width), static_cast<int>(image.height));
  std::transform(codes.begin(), codes.end(), picture.rgb.begin(), srgb_value);
  return picture;
}

} // namespace haarlight::image
