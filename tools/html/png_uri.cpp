#include <html/png_uri.h>

#include <html/base64.h>

namespace haarlight::html {
std::string png_uri(const Image& picture, const image::PngOptions& options) {
  const std::string bytes = image::png_bytes(picture, options);
  return "data:image/png;base64," + base64(std::as_bytes(std::span(bytes)));
}

} // namespace haarlight::html
