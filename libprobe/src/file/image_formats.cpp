#include "file/image_formats.h"

#include <wavelet/base/error.h>

#include <algorithm>
#include <string_view>
#include <utility>

namespace haarlight::probe {
namespace {

using namespace std::literals;

/// Bytes that a format has at some offset.
struct Magic {
  std::size_t offset;
  std::string_view bytes;
};

constexpr std::pair<Magic, ImageFormat> accepted[] = {
    {{0, "\x76\x2f\x31\x01"sv}, ImageFormat::OpenExr},
    {{0, "PF4"sv}, ImageFormat::Pfm},
    {{0, "PF\n"sv}, ImageFormat::Pfm},
    {{0, "PF\r"sv}, ImageFormat::Pfm},
    {{0, "PF "sv}, ImageFormat::Pfm},
    {{0, "PF\t"sv}, ImageFormat::Pfm},
    {{0, "Pf\n"sv}, ImageFormat::Pfm},
    {{0, "Pf\r"sv}, ImageFormat::Pfm},
    {{0, "Pf "sv}, ImageFormat::Pfm},
    {{0, "Pf\t"sv}, ImageFormat::Pfm},
    {{0, "II\x2a\0"sv}, ImageFormat::Tiff},
    {{0, "MM\0\x2a"sv}, ImageFormat::Tiff},
    {{0, "II\x2b\0"sv}, ImageFormat::Tiff},
    {{0, "MM\0\x2b"sv}, ImageFormat::Tiff},
    {{0, "\x89PNG\r\n\x1a\n"sv}, ImageFormat::Png},
    {{0, "\xff\xd8\xff"sv}, ImageFormat::Jpeg},
};

/// Formats that are refused, so that the message can name them.
constexpr std::pair<Magic, const char*> refused[] = {
    {{0, "BM"sv}, "BMP"},
    {{0, "GIF8"sv}, "GIF"},
    {{0, "DDS "sv}, "DirectDraw Surface (DDS)"},
    {{0, "\x01\xda"sv}, "SGI"},
    {{8, "WEBP"sv}, "WebP"},
    {{0, "8BPS"sv}, "Photoshop (PSD)"},
    {{0, "SDPX"sv}, "DPX"},
    {{0, "XPDS"sv}, "DPX"},
    {{0, "\x80\x2a\x5f\xd7"sv}, "Cineon"},
    {{0, "\xd7\x5f\x2a\x80"sv}, "Cineon"},
    {{0, "\0\0\0\x0cjP"sv}, "JPEG 2000"},
    {{0, "\xff\x4f\xff\x51"sv}, "JPEG 2000"},
    {{0, "\0\0\0\x0cJXL"sv}, "JPEG XL"},
    {{0, "\xff\x0a"sv}, "JPEG XL"},
    {{4, "ftypavif"sv}, "AVIF"},
    {{4, "ftyphei"sv}, "HEIF"},
    {{4, "ftypmif"sv}, "HEIF"},
    {{0, "SIMPLE  ="sv}, "FITS"},
    {{0, "FOR4"sv}, "Maya IFF"},
    {{0, "\xabKTX"sv}, "KTX"},
    {{0, "\0\0\1\0"sv}, "ICO"},
    {{0, "P1"sv}, "PBM"},
    {{0, "P2"sv}, "PGM"},
    {{0, "P3"sv}, "PPM"},
    {{0, "P4"sv}, "PBM"},
    {{0, "P5"sv}, "PGM"},
    {{0, "P6"sv}, "PPM"},
    {{0, "P7"sv}, "PAM"},
    {{0, "PIEH"sv}, "Middlebury flow"},
    {{0, "Ptex"sv}, "Ptex"},
    {{0, "\x53\x80\xf6\x34"sv}, "Softimage PIC"},
    {{0, "Ph"sv}, "half-float PHM"},
};

bool matches(std::string_view text, const Magic& magic) {
  return text.size() >= magic.offset && text.substr(magic.offset).starts_with(magic.bytes);
}

} // namespace

ImageFormat detect_format(std::span<const std::byte> bytes, const std::string& path) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                              std::min<std::size_t>(bytes.size(), 32));
  for (const auto& [magic, format] : accepted)
    if (matches(text, magic))
      return format;
  for (const auto& [magic, name] : refused)
    if (matches(text, magic))
      throw_input_error(path, std::string("is a ") + name + " file, which is not read; " +
                                  accepted_formats);
  throw_input_error(path, std::string("is no image of a known format; ") + accepted_formats);
}

const char* format_name(ImageFormat format) {
  switch (format) {
  case ImageFormat::OpenExr:
    return "OpenEXR";
  case ImageFormat::Pfm:
    return "PFM";
  case ImageFormat::Tiff:
    return "TIFF";
  case ImageFormat::Png:
    return "PNG";
  case ImageFormat::Jpeg:
    return "JPEG";
  }
  return "";
}

} // namespace haarlight::probe
