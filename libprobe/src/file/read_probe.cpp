#include <probe/read_probe.h>

#include "file/external_reader.h"
#include "file/image_formats.h"

#include <probe/rgbe.h>

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

#include <algorithm>
#include <cmath>

namespace haarlight::probe {
namespace {

[[noreturn]] void refuse(const Image& image, std::size_t index, const std::string& path) {
  const std::size_t pixel = index / 3;
  const auto width = static_cast<std::size_t>(image.width);
  throw_input_error(path, std::string("pixel (column ") + std::to_string(pixel % width) + ", row " +
                              std::to_string(pixel / width) + ") holds " +
                              (std::isnan(image.rgb[index]) ? "a NaN" : "an infinity") +
                              ", radiance must be finite");
}

void refuse_choice(const ImageChoice& choice, const std::string& path) {
  if (!choice.layer.empty() || !choice.part.empty())
    throw_input_error(path, "has no layers or parts to choose from");
}

LoadedImage load(const std::string& path, const ImageChoice& choice) {
  const InputFile file(path);
  if (file.bytes().empty())
    throw_input_error(path, "is empty, an image is needed");
  LoadedImage loaded;
  loaded.name = base_name(path);
  loaded.hash = hash_text(file.bytes());
  if (is_rgbe(file.bytes())) {
    refuse_choice(choice, path);
    loaded.image = read_rgbe(file.bytes(), path);
    return loaded;
  }
  const ImageFormat format = detect_format(file.bytes(), path);
  if (format == ImageFormat::Pfm) {
    refuse_choice(choice, path);
    loaded.image = read_pfm(file.bytes(), path, loaded.notes);
    return loaded;
  }
  DecodedImage decoded = read_with_reader(path, format, choice);
  loaded.image = std::move(decoded.image);
  loaded.notes = std::move(decoded.notes);
  return loaded;
}

} // namespace

std::size_t clean_pixels(Image& image, const std::string& path) {
  std::size_t negative = 0;
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    float& value = image.rgb[i];
    if (!std::isfinite(value))
      refuse(image, i, path);
    negative += value < 0 ? 1 : 0;
    value = value > 0 ? value : 0.0F; // −0 becomes 0 too
  }
  return negative;
}

LoadedImage read_image(const std::string& path, const ImageChoice& choice) {
  LoadedImage loaded = load(path, choice);
  const std::size_t negative = clean_pixels(loaded.image, path);
  if (negative > 0)
    loaded.notes.push_back(std::to_string(negative) + " negative values were set to 0");
  return loaded;
}

namespace {

/// Pixels darker than this fraction of the image's mean count as empty.
constexpr double dark_fraction = 1e-3;

double mean_luminance(const Image& image) {
  double sum = 0;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3)
    sum += luminance(Eigen::Map<const Rgb>(image.rgb.data() + i));
  return 3 * sum / static_cast<double>(image.rgb.size());
}

/// Fraction of the pixels well outside the inscribed disk that are empty: nearly all in pictures of
/// round mappings, captions being small.
double empty_fraction_of_corners(const Image& image, double dark) {
  std::size_t outside = 0;
  std::size_t empty = 0;
  const Vec2 size(static_cast<float>(image.width), static_cast<float>(image.height));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Vec2 place(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
      if (radius_squared(place.cwiseQuotient(size)) < 1.02F)
        continue;
      ++outside;
      empty += luminance(image.at(x, y)) < dark ? 1 : 0;
    }
  return outside > 0 ? static_cast<double>(empty) / static_cast<double>(outside) : 1;
}

/// Sums of differences in log luminance along the border: of pixels that an octahedral map folds
/// onto each other, and of pixels a quarter of the edge apart.
struct BorderDifferences {
  double folded = 0;
  double apart = 0;

  BorderDifferences(const Image& image, double dark) {
    const int size = image.width;
    const int last = size - 1;
    const auto at = [&](int x, int y) { return std::log(luminance(image.at(x, y)) + dark); };
    for (int i = 0; i < size; ++i) {
      const int quarter = (i + size / 4) % size;
      for (const int edge : {0, last}) {
        folded += std::abs(at(i, edge) - at(last - i, edge));
        folded += std::abs(at(edge, i) - at(edge, last - i));
        apart += std::abs(at(i, edge) - at(quarter, edge));
        apart += std::abs(at(edge, i) - at(edge, quarter));
      }
    }
  }
};

DetectedMapping detect_square(const Image& image) {
  const double dark = dark_fraction * mean_luminance(image) + 1e-30;
  if (empty_fraction_of_corners(image, dark) > 0.6)
    return {Mapping::Angular, "mapping angular: the picture is square and its corners are empty "
                              "(a mirror ball looks the same and must be specified)"};
  const BorderDifferences border(image, dark);
  if (border.folded < 0.5 * border.apart)
    return {Mapping::Octahedral, "mapping octahedral: the picture is square, its corners are not "
                                 "empty and its edges are folded onto themselves"};
  return {Mapping::Angular, "mapping angular: the picture is square and its edges are not folded "
                            "onto themselves as an octahedral map's are"};
}

} // namespace

DetectedMapping detect_mapping(const Image& image, const std::string& path) {
  if (image.width == 2 * image.height)
    return {Mapping::LatLong, "mapping latlong: the picture is twice as wide as high"};
  if (image.width == image.height)
    return detect_square(image);
  throw_input_error(path, "is " + std::to_string(image.width) + " × " +
                              std::to_string(image.height) +
                              " pixels, a probe must be square or twice as wide as high");
}

LoadedProbe read_probe(const std::string& path, std::optional<Mapping> mapping, Lookup lookup,
                       const ImageChoice& choice) {
  LoadedImage loaded = read_image(path, choice);
  const DetectedMapping taken =
      mapping ? DetectedMapping{*mapping, "mapping " + mapping_name(*mapping) + ", as requested"}
              : detect_mapping(loaded.image, path);
  LoadedProbe result{
      Probe(loaded.image, taken.mapping, lookup, path), taken.reason, std::move(loaded.notes), {}};
  result.source.set("source", loaded.name);
  result.source.set("source_hash", loaded.hash);
  result.source.set("mapping", mapping_name(taken.mapping));
  return result;
}

} // namespace haarlight::probe
