#include <probe/read_image.h>

#include "file/foreign_image.h"
#include "file/pfm_reader.h"
#include "file/picture_format.h"

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
  const PictureFormat format = detect_format(file.bytes(), path);
  if (format == PictureFormat::Pfm) {
    refuse_choice(choice, path);
    loaded.image = read_pfm(file.bytes(), path, loaded.notes);
    return loaded;
  }
  ForeignImage foreign = read_foreign_image(path, format, choice);
  loaded.image = std::move(foreign.image);
  loaded.notes = std::move(foreign.notes);
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

} // namespace haarlight::probe
