#pragma once
// Files as strings, and a map set without any source behind it.

#include "temporary_folder.h"

#include <wavelet/tree/map_set.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>

namespace haarlight::testing {

inline std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

inline void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// Maps whose pixels are all different, from a hash.
class NumberedMaps : public wavelet::MapSource {
public:
  explicit NumberedMaps(int size, int columns, int rows) {
    m_info.size = size;
    m_info.columns = columns;
    m_info.rows = rows;
    m_info.frame = "none";
    m_info.units = "sr^-1";
    m_info.provenance.set("source", "numbers");
  }
  const wavelet::SetInfo& info() const override { return m_info; }
  wavelet::SetInfo& info() { return m_info; }

  wavelet::Map make(int column, int row) const override {
    wavelet::Map map(m_info.size);
    auto state = static_cast<std::uint32_t>(column * 7919 + row * 104729 + 1);
    for (float& value : map.rgb) {
      state = state * 1664525U + 1013904223U;
      value = static_cast<float>(state >> 8U) * 0x1p-24F;
    }
    return map;
  }

private:
  wavelet::SetInfo m_info;
};

} // namespace haarlight::testing
