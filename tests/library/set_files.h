#pragma once
// Sets and files of them for the tests of both forms of a .haar file.

#include "random_map.h"

#include <wavelet/file/tree_set.h>
#include <wavelet/transform/compress.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

/// Random maps as a set.
class RandomSource : public haarlight::wavelet::MapSource {
public:
  RandomSource(int size, int columns, int rows) {
    m_info.size = size;
    m_info.columns = columns;
    m_info.rows = rows;
    m_info.units = "none";
    m_info.frame = "plain square";
    m_info.provenance.set("source", "random");
  }
  const haarlight::wavelet::SetInfo& info() const override { return m_info; }
  haarlight::wavelet::Map make(int column, int row) const override {
    return random_map(m_info.size, static_cast<unsigned>(17 * row + column));
  }

private:
  haarlight::wavelet::SetInfo m_info;
};

/// Between a map as a small reader gives it, a colour for each pixel, and another.
template <class Pixels>
float largest_difference(const Pixels& read, const haarlight::wavelet::Map& map) {
  float worst = 0;
  for (std::size_t i = 0; i < read.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      worst = std::max(worst, std::abs(read[i][c] - map.rgb[3 * i + c]));
  return worst;
}

inline haarlight::wavelet::CompressOptions
keep_all(haarlight::wavelet::CoefficientType type = haarlight::wavelet::CoefficientType::Half) {
  haarlight::wavelet::CompressOptions options;
  options.threshold.criterion = haarlight::wavelet::Criterion::L2;
  options.threshold.tolerance = 0;
  options.coefficients = type;
  return options;
}

inline haarlight::wavelet::CompressReport
write_set(const std::string& path, const haarlight::wavelet::MapSource& source,
          const haarlight::wavelet::CompressOptions& options) {
  haarlight::OutputFile file(path);
  const auto report = haarlight::wavelet::compress_set(source, options, file);
  file.commit();
  return report;
}

inline std::string read_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  bytes.replace(at, sizeof value, reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
T get(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

inline std::uint64_t checksum(const std::string& bytes, std::size_t begin, std::size_t size) {
  return haarlight::hash_bytes(std::as_bytes(std::span(bytes)).subspan(begin, size));
}
