// Pictures of foreign formats through OpenImageIO: the only file that includes it.

#include "foreign_image.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>

namespace haarlight::probe {
namespace {

/// Library messages may run over several lines; the first says what matters.
std::string first_line(std::string text) {
  text = text.substr(0, text.find_first_of("\r\n"));
  return text.empty() ? "unknown trouble" : text;
}

/// Where red, green and blue stand among the channels: by name, else the first three, else grey.
std::array<int, 3> colour_channels(const OIIO::ImageSpec& spec) {
  std::array<int, 3> found = {-1, -1, -1};
  for (int c = 0; c < spec.nchannels; ++c)
    for (std::size_t i = 0; i < 3; ++i)
      if (found[i] < 0 && spec.channel_name(c) == std::string(1, "RGB"[i]))
        found[i] = c;
  if (*std::min_element(found.begin(), found.end()) >= 0)
    return found;
  return spec.nchannels >= 3 ? std::array{0, 1, 2} : std::array{0, 0, 0};
}

std::string unsuitable(const OIIO::ImageSpec& spec) {
  if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.deep)
    return "is no flat picture of colours";
  const auto pixels = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  if (pixels > max_pixels || pixels * static_cast<std::size_t>(spec.nchannels) > 4 * max_pixels)
    return "has " + std::to_string(pixels) + " pixels of " + std::to_string(spec.nchannels) +
           " channels, at most " + std::to_string(max_pixels) + " of 4 are read";
  return {};
}

float linear_of_srgb(float v) {
  return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F);
}

bool is_encoded(const OIIO::ImageSpec& spec) {
  const std::string space(spec.get_string_attribute("oiio:ColorSpace"));
  return space == "sRGB" || (spec.format.basetype == OIIO::TypeDesc::UINT8 && space != "Linear");
}

void pick_colours(const OIIO::ImageSpec& spec, const std::vector<float>& samples,
                  ForeignImage& result) {
  const auto channels = colour_channels(spec);
  result.image = Image(spec.width, spec.height);
  const auto stride = static_cast<std::size_t>(spec.nchannels);
  for (std::size_t i = 0; i < result.image.rgb.size(); ++i)
    result.image.rgb[i] = samples[i / 3 * stride + static_cast<std::size_t>(channels[i % 3])];
  if (!is_encoded(spec))
    return;
  for (float& v : result.image.rgb)
    v = linear_of_srgb(v);
  result.note = "values encoded for display (sRGB) were made linear";
}

void read(const std::string& path, ForeignImage& result) {
  const auto input = OIIO::ImageInput::open(path);
  if (!input) {
    result.error = "is no picture that can be read (Radiance RGBE, OpenEXR, PFM, TIFF …): " +
                   first_line(OIIO::geterror());
    return;
  }
  const OIIO::ImageSpec spec = input->spec();
  result.error = unsuitable(spec);
  if (!result.error.empty())
    return;
  std::vector<float> samples(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, samples.data())) {
    result.error = "cannot be read whole: " + first_line(input->geterror());
    return;
  }
  pick_colours(spec, samples, result);
}

} // namespace
} // namespace haarlight::probe

extern "C" __attribute__((visibility("default"))) void
haarlight_read_foreign_image(const std::string& path, haarlight::probe::ForeignImage& result) {
  try {
    haarlight::probe::read(path, result);
  } catch (const std::exception& error) {
    result.error = std::string("cannot be read: ") + error.what();
  }
}
