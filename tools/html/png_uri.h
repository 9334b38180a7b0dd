#pragma once
// Pictures within a page.

#include <image/png.h>

#include <string>

namespace haarlight::html {

/// The picture's PNG file as a data URI. @throws Error(Output)
std::string png_uri(const Image& picture, const image::PngOptions& options = {});

} // namespace haarlight::html
