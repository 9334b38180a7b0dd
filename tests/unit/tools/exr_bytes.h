#pragma once
// EXR files byte by byte ("The OpenEXR File Layout"), so that a test can make each of them wrong.

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace haarlight::testing {

template <class T>
std::string raw(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

inline std::string box(std::int32_t x0, std::int32_t y0, std::int32_t x1, std::int32_t y1) {
  return raw(x0) + raw(y0) + raw(x1) + raw(y1);
}

/// @param type 0 unsigned, 1 half, 2 float
inline std::string channel_list(const std::vector<std::string>& names, std::uint32_t type = 2,
                                std::uint32_t sampling = 1) {
  std::string list;
  for (const std::string& name : names)
    list += name + '\0' + raw(type) + std::string(4, '\0') + raw(sampling) + raw(sampling);
  return list + '\0';
}

struct ExrAttribute {
  std::string name;
  std::string type;
  std::string value;
};

/// An uncompressed image of one chunk for each of `chunks`.
struct ExrBytes {
  std::uint32_t version = 2;
  std::vector<ExrAttribute> attributes;
  std::vector<std::string> chunks; ///< their coordinates, size and pixels

  /// An image of scanlines of float channels in alphabetical order; value(x, y, channel) with x, y
  /// in the coordinates of the windows.
  template <class Value>
  static ExrBytes scanlines(const std::vector<std::string>& channels,
                            const std::string& data_window, const std::string& display_window,
                            const Value& value) {
    ExrBytes exr;
    exr.attributes = {{"channels", "chlist", channel_list(channels)},
                      {"compression", "compression", std::string(1, '\0')},
                      {"dataWindow", "box2i", data_window},
                      {"displayWindow", "box2i", display_window},
                      {"lineOrder", "lineOrder", std::string(1, '\0')},
                      {"pixelAspectRatio", "float", raw(1.0F)},
                      {"screenWindowCenter", "v2f", raw(0.0F) + raw(0.0F)},
                      {"screenWindowWidth", "float", raw(1.0F)}};
    std::int32_t window[4];
    std::memcpy(window, data_window.data(), sizeof window);
    for (std::int32_t y = window[1]; y <= window[3]; ++y) {
      std::string pixels;
      for (std::size_t c = 0; c < channels.size(); ++c)
        for (std::int32_t x = window[0]; x <= window[2]; ++x)
          pixels += raw(static_cast<float>(value(x, y, c)));
      exr.chunks.push_back(raw(y) + raw(static_cast<std::int32_t>(pixels.size())) + pixels);
    }
    return exr;
  }

  std::string& attribute(const std::string& name) {
    for (ExrAttribute& candidate : attributes)
      if (candidate.name == name)
        return candidate.value;
    attributes.push_back({name, "string", {}});
    return attributes.back().value;
  }

  std::string header() const {
    std::string bytes = raw(std::uint32_t{20000630}) + raw(version);
    for (const ExrAttribute& a : attributes)
      bytes +=
          a.name + '\0' + a.type + '\0' + raw(static_cast<std::uint32_t>(a.value.size())) + a.value;
    return bytes + '\0';
  }

  std::string bytes() const {
    std::string table = header();
    std::string pixels;
    const std::uint64_t first = table.size() + 8 * chunks.size();
    for (const std::string& chunk : chunks) {
      table += raw(first + pixels.size());
      pixels += chunk;
    }
    return table + pixels;
  }
};

} // namespace haarlight::testing
